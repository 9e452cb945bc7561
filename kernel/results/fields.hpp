// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "kernel/build/built_scene.hpp"
#include "kernel/output/frame.hpp"
#include "kernel/results/piece_cells.hpp"

namespace suture {

/// What a field is computed of: the body as it is now.
struct FieldRequest {
  BuiltScene& built;
  Vec3 gravity;  ///< m/s^2
  double time;   ///< s
  /// Whose vertices or elements alone are wanted, in their order; null: all. Springs and faces are
  /// always all.
  const PieceCells* piece = nullptr;

  Attributes& attributes() const { return built.body().attributes(); }
  const CellComplex& complex() const { return built.body().complex(); }
  ShownCells vertices() const {
    return piece ? ShownCells(piece->vertices) : ShownCells(complex().count(0));
  }
  ShownCells elements() const {
    return piece ? ShownCells(piece->elements) : ShownCells(complex().count(3));
  }
  /// The cells of a dimension that are wanted; null: all.
  const std::vector<Index>* wanted(int dimension) const {
    if (!piece || dimension == 1 || dimension == 2) return nullptr;
    return dimension == 0 ? &piece->vertices : &piece->elements;
  }
};

/// One field that a scene can request.
struct FieldChoice {
  enum class On { points, cells, springs, faces };
  /// What of the body it is computed from, for a piece: its elements, those near it
  /// (PieceCells::elements_near) or all.
  enum class From { piece, near, all };
  std::string name;
  On on = On::points;
  bool needs_force = false;  ///< forces must match the positions of the frame
  std::function<void(const FieldRequest&, FrameField&)> fill;
  bool runs_functors = false;  ///< an output of a model, not a column
  int components = 1;
  bool principal = false;  ///< components 1, 2, 3 in descending order, not x, y, z
  std::string unit = "1";  ///< "1": none
  /// One component at one vertex or element, without computing the others; empty if only fill() can
  /// compute it.
  std::function<double(BuiltScene&, const Vec3& gravity, Index cell, int component)> value{};
  From from = From::piece;
};

/// The names of the components of a field: "x y z", "1 2 3" (principal values), "xx yy zz xy yz
/// xz", 0, 1, ...; a single "" for a scalar.
std::vector<std::string> component_names(const FieldChoice& field);

/// False for a row whose cell was removed, or left the instance.
inline bool has_cell(const CellComplex& complex, const Table& table, Index row) {
  const Index cell = table.cells.cell(row);
  return cell != none && complex.exists(table.dimension, cell) && table.cells.row(cell) == row;
}

/// Fields that every simulation has: displacement, velocity, force, reaction, reaction_moment,
/// mass, fixed, node_id (points), element_id, island, model, hourglass (elements).
const std::vector<FieldChoice>& kernel_fields();

/// Fields of the models in a run: output extensions and attributes flagged for output. A field of
/// several instances is one array, NaN where no model provides it.
std::vector<FieldChoice> model_fields(BuiltScene& built);

/// With obstacles: contact_force, gap (points).
std::vector<FieldChoice> fields_of_contact();

/// The fields of every run, followed by those of contact, those of its models and the strains and
/// stresses of tensor_fields.hpp; where a model has a field of the same name as one of these, only
/// the model's.
std::vector<FieldChoice> all_fields(BuiltScene& built);

/// Whether frames and probes can show it: it lies on points or elements.
bool is_in_frames(const FieldChoice& field);

/// The field of points or elements with this name among `fields`. Throws InputError that begins
/// with `path` and names the nearest field and all others.
const FieldChoice& field_named(const std::vector<FieldChoice>& fields, const std::string& name,
                               const std::string& path);

/// The chosen fields; for springs and faces, all fields of the run. Throws InputError for a field
/// that no model of this scene provides, naming the nearest.
std::vector<FieldChoice> choose_fields(BuiltScene& built, const OutputOptions& options);

/// Computes the chosen fields that lie on `on`; the memory of `fields` is used again.
void fill_fields(const std::vector<FieldChoice>& choices, FieldChoice::On on,
                 const FieldRequest& request, std::vector<FrameField>& fields);

/// The fields of this scene that are not among `chosen`.
std::vector<FieldChoice> fields_besides(BuiltScene& built, const std::vector<FieldChoice>& chosen);

}  // namespace suture
