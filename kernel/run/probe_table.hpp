// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "kernel/run/fields.hpp"

namespace suture {

/// The probes of a scene: which fields they show, over which vertices or elements. Cells
/// are chosen at rest, once; a removed cell drops out.
class ProbeTable {
 public:
  /// Throws InputError for a field that no model of the scene gives, and for a selection
  /// that selects nothing.
  ProbeTable(const OutputOptions& options, BuiltScene& built);

  /// One per value of a row: "time [s]", "tip displacement x [m]", ...
  std::vector<std::string> columns() const;
  /// The values of one row. A field that functors compute is computed once, whatever the
  /// number of probes that show it; the others are read where the probes are.
  /// NaN where every cell of a probe was removed, or no model gives the field.
  const std::vector<double>& row(double time, const Vec3& gravity);

  /// The fields that some probe shows, each once.
  const std::vector<FieldChoice>& fields() const { return fields_; }
  /// Some field has this need: needs(&FieldChoice::needs_force).
  bool needs(bool FieldChoice::*what) const;

 private:
  /// What one probe shows of one field.
  struct Entry {
    std::string probe;
    std::size_t field;  ///< of fields_
    Probe::Of of;
    std::vector<Index> cells;
  };
  std::size_t add_field(const FieldChoice& field);
  void add(const Probe& probe, const std::vector<FieldChoice>& all);
  void append(const Entry& entry, const Vec3& gravity);

  BuiltScene& built_;
  std::vector<FieldChoice> fields_;
  std::vector<FrameField> computed_;  ///< by field; empty where it is read cell by cell
  std::vector<Entry> entries_;
  std::vector<double> values_;
};

}  // namespace suture
