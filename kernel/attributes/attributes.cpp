// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/attributes.hpp"

#include <algorithm>
#include <utility>

#include "kernel/attributes/inspection.hpp"
#include "kernel/base/error.hpp"

namespace suture {
namespace {

/// Bound of compress() for columns of 3-cells, relative to the largest magnitude.
/// Congruent elements of a grid differ by rounding of their coordinates, some
/// 1e-16 x cells along an axis; 1e-13 covers 1000 of them and stays below the
/// 1e-12 of the stiffness scale within which rigid motions must give no force.
/// Columns of other dimensions are compressed only if equal to the bit: a cut
/// changes them, and its sums must be those of a fresh start.
constexpr double volume_tolerance = 1e-13;

Column& add_column(Table& table, const char* name, const char* unit, const char* doc,
                   int components, suture_policy policy) {
  ColumnSpec spec;
  spec.name = name;
  spec.unit = unit;
  spec.doc = doc;
  spec.components = components;
  spec.policy = policy;
  return table.add(std::move(spec));
}

}  // namespace

Attributes::Attributes(const CellComplex& complex, std::span<const Vec3> rest) {
  if (rest.size() != complex.count(0))
    throw InputError("attributes: " + std::to_string(rest.size()) + " rest positions for " +
                     std::to_string(complex.count(0)) + " vertices; one each is needed");
  for (int d = 0; d < 4; ++d) kernel(d).dimension = d;
  kernel(0).cells = CellSet::all(complex.count(0));
  kernel(3).cells = CellSet::all(complex.element_count());
  Table& t = kernel(0);
  rest_ = &add_column(t, "rest", "m", "Position without load.", 3, SUTURE_COPY);
  position_ = &add_column(t, "position", "m", "Present position.", 3, SUTURE_COPY);
  velocity_ = &add_column(t, "velocity", "m/s", "Present velocity.", 3, SUTURE_COPY);
  force_ = &add_column(t, "force", "N", "Sum of the forces of a step.", 3, SUTURE_ZERO);
  mass_ = &add_column(t, "mass", "kg", "Sum of the models' shares.", 1, SUTURE_FROM_VOLUMES);
  fixed_ = &add_column(t, "fixed", "1", "Bits: 1 x, 2 y, 4 z held.", 1, SUTURE_COPY);
  for (std::size_t v = 0; v < rest.size(); ++v)
    for (std::size_t c = 0; c < 3; ++c)
      rest_->rows()[4 * v + c] = position_->rows()[4 * v + c] = rest[v][c];
}

Instance& Attributes::add(std::unique_ptr<Instance> instance, CellComplex& complex,
                          std::vector<Index> elements) {
  instance->build(complex, *rest_, std::move(elements));
  if (complex.has_edges()) kernel(1).cells = CellSet::all(complex.count(1));
  if (complex.has_faces()) kernel(2).cells = CellSet::all(complex.count(2));
  return *instances_.emplace_back(std::move(instance));
}

void Attributes::initialise(const CellComplex& complex, Diagnostics& diagnostics) {
  sums_.reserve(complex);
  RestBatch rest(complex, *rest_, user_element);
  mass_->fill(0);
  for (const auto& instance : instances_) {
    const suture_model& model = instance->model();
    for (std::uint32_t a = 0; a < model.attribute_count; ++a) {
      const suture_attribute& attribute = model.attributes[a];
      if (attribute.policy != SUTURE_FROM_VOLUMES || !instance->needs(a)) continue;
      const auto dimension = static_cast<int>(attribute.dimension);
      Column* own = instance->column(a);
      Column& column = own ? *own : *mass_;
      const CellSet& cells = own ? instance->table(dimension).cells : kernel(0).cells;
      if (own) column.fill(0);
      sum_contributions(*instance, attribute, complex, rest, cells, column);
      require_finite(*instance, attribute, cells, column);
      if (own && instance->skips()) column.compress(dimension == 3 ? volume_tolerance : 0);
    }
  }
  for (const auto& instance : instances_)
    inspect(*instance, complex, *rest_, *mass_, user_element, diagnostics);
}

void Attributes::apply(const CellComplex& complex, const TopologyChange& change) {
  if (change.empty()) return;
  follow(kernel_, kernel(3).cells, complex, change);
  for (const Index vertex : change.stars[0].cells) mass_->rows()[vertex] = 0;
  sums_.mark(complex, change);
  RestBatch rest(complex, *rest_, user_element);
  for (const auto& instance : instances_) {
    follow(instance->tables(), instance->table(3).cells, complex, change);
    sums_.sum(*instance, complex, rest, change, *mass_);
  }
  sums_.clear(change);
}

void Attributes::follow(std::span<Table, 4> tables, const CellSet& region,
                        const CellComplex& complex, const TopologyChange& change) {
  if (!region.is_all() || std::ranges::any_of(tables, SplitPolicies::weighs)) {
    touched_.reserve(complex.element_count());
    touched_.select(region, change.elements);
    if (touched_.members().empty()) return;
  }
  for (Table& table : tables.first<3>())
    if (table.cells.size() > 0) policies_.apply(table, complex, *rest_, touched_, change);
}

void Attributes::accept_trials() {
  for (const auto& instance : instances_)
    for (int d = 0; d < 4; ++d)
      for (Column& column : instance->table(d).columns)
        if (column.has_trial()) column.accept();
}

}  // namespace suture
