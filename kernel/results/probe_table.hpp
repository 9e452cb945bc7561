// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "kernel/results/fields.hpp"

namespace suture {

/// The probes of a scene: their fields and the vertices or elements that they cover. Cells are
/// selected once, at rest; a removed cell is dropped.
class ProbeTable {
 public:
  /// Throws InputError for a field that no model of the scene provides, and for an empty selection.
  ProbeTable(const OutputOptions& options, BuiltScene& built);

  /// One per value of a row: "time [s]", "tip displacement x [m]", ...
  std::vector<std::string> columns() const;
  /// A field of a probe, which takes `components` values of a row.
  struct Quantity {
    std::string probe, field;
    int components;
  };
  /// In the order of the columns behind the time.
  std::vector<Quantity> quantities() const;
  /// The cells of a field of a probe that exist now, and which of their values it gives. Throws
  /// InputError if there is no such probe or field.
  struct Cover {
    std::vector<Index> cells;
    Probe::Of of;
  };
  Cover cover(const std::string& probe, const std::string& field) const;
  /// The values of one row. A field computed by functors is computed once for all probes; other
  /// fields are read only at the probes. NaN if every cell of a probe was removed or no model
  /// provides the field. Throws NumericalError for any other value that is not finite.
  const std::vector<double>& row(double time, const Vec3& gravity);

  /// The fields of all probes, each once.
  const std::vector<FieldChoice>& fields() const { return fields_; }
  /// True if some field has this property: needs(&FieldChoice::needs_force).
  bool needs(bool FieldChoice::*what) const;

 private:
  /// One field of one probe.
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
  std::vector<FrameField> computed_;  ///< by field; empty if it is read cell by cell
  std::vector<Entry> entries_;
  std::vector<double> values_;
};

}  // namespace suture
