// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/contributions.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

constexpr Index lanes = SUTURE_LANES;

const Index* cells_of(const CellComplex& complex, std::uint32_t dimension, const Index& element) {
  switch (dimension) {
    case 0:
      return complex.vertices_of(element).data();
    case 1:
      return complex.edges_of(element).data();
    case 2:
      return complex.faces_of(element).data();
    default:
      return &element;
  }
}

[[noreturn]] void refuse_value(const Instance& instance, const suture_attribute& attribute,
                               Index cell, double value) {
  throw PluginError(instance.title() + ": attribute '" + attribute.name + "' is " +
                    std::to_string(value) + " at cell " + std::to_string(cell) + " of dimension " +
                    std::to_string(attribute.dimension) +
                    "; its contribution functor must give finite numbers");
}

}  // namespace

RestBatch::RestBatch(const RestPlaces& rest, std::span<const Index> user_element)
    : rest_(rest), user_element_(user_element) {
  batch_.size = sizeof(suture_batch);
  batch_.lanes = lanes;
  batch_.nodes = 8;
  batch_.rest = positions_.data();
  batch_.cell_ids = ids_.data();
}

const suture_batch& RestBatch::gather(std::span<const Index> elements) {
  batch_.valid = static_cast<std::uint32_t>(elements.size());
  for (Index lane = 0; lane < lanes; ++lane) {
    const Index e = elements[lane < batch_.valid ? lane : batch_.valid - 1];
    ids_[lane] = user_element_.empty() ? e : user_element_[e];
    double* out = positions_.data() + lane;
    for (std::size_t node = 0; node < 8; ++node) {
      const double* row = rest_.corner(e, node);
      out[0] = row[0];
      out[lanes] = row[1];
      out[2 * lanes] = row[2];
      out += 3 * lanes;
    }
  }
  return batch_;
}

void contribute(Instance& instance, const suture_attribute& attribute, const suture_batch& batch,
                double* out) {
  const suture_context& context = instance.context(0);
  Instance::reset(*context.error);
  if (attribute.contribution(&context, &batch, out) == SUTURE_OK) return;
  const Index cell = context.error->cell == none ? batch.cell_ids[0] : context.error->cell;
  throw InputError(instance.title() + ": attribute '" + attribute.name + "' at element " +
                   std::to_string(cell) + ": " + context.error->text);
}

void require_finite(const Instance& instance, const suture_attribute& attribute,
                    const CellSet& cells, const Column& column) {
  if (column.is_constant() && column.size() > 0 && std::isfinite(column.get(0, 0))) return;
  for (Index row = 0; row < column.size(); ++row)
    for (int c = 0; c < column.spec().components; ++c)
      if (!std::isfinite(column.get(row, c)))
        refuse_value(instance, attribute, cells.cell(row), column.get(row, c));
}

void sum_contributions(Instance& instance, const suture_attribute& attribute,
                       const CellComplex& complex, RestBatch& rest, const CellSet& cells,
                       Column& column) {
  column.expand();
  double* values = column.dimension() == 0 ? column.rows() : column.block(0);
  const std::size_t step = column.component_step();
  const int per_element = contribution_cells[attribute.dimension];
  const int components = column.spec().components;
  alignas(SUTURE_ALIGNMENT) std::array<double, std::size_t{12} * 9 * lanes> out;

  const CellSet& region = instance.table(3).cells;
  const Index count = complex.element_count();
  std::array<Index, lanes> batch;
  Index filled = 0;
  for (Index e = 0; e < count; ++e) {
    if (region.contains(e)) batch[filled++] = e;
    if (filled == 0 || (filled < lanes && e + 1 < count)) continue;
    contribute(instance, attribute, rest.gather({batch.data(), filled}), out.data());
    for (Index lane = 0; lane < filled; ++lane) {
      const Index* incident = cells_of(complex, attribute.dimension, batch[lane]);
      const double* from = out.data() + lane;
      for (int k = 0; k < per_element; ++k) {
        double* to = values + column.offset(cells.row(incident[k]));
        for (int c = 0; c < components; ++c, from += lanes)
          to[static_cast<std::size_t>(c) * step] += *from;
      }
    }
    filled = 0;
  }
  column.pad();
}

void TouchedSums::reserve(const CellComplex& complex) {
  for (std::size_t d = 0; d < 3; ++d)
    marks_[d].resize(complex.count(static_cast<int>(d)) / 64 + 1, 0);
}

void TouchedSums::mark(const CellComplex& complex, const TopologyChange& change) {
  reserve(complex);
  for (std::size_t d = 0; d < 3; ++d)
    for (const Index cell : change.stars[d].cells)
      marks_[d][cell / 64] |= std::uint64_t{1} << (cell % 64);
}

void TouchedSums::clear(const TopologyChange& change) {
  for (std::size_t d = 0; d < 3; ++d)
    for (const Index cell : change.stars[d].cells) marks_[d][cell / 64] = 0;
}

void TouchedSums::sum(Instance& instance, const CellComplex& complex, RestBatch& rest,
                      const TopologyChange& change, Column& mass) {
  find_targets(instance, change, mass);
  if (std::ranges::all_of(targets_, [](const auto& t) { return t.empty(); })) return;
  for (const auto& targets : targets_)
    for (const Target& target : targets) start(target, change);

  const CellSet& region = instance.table(3).cells;
  std::array<Index, lanes> elements;
  Index filled = 0;
  for (std::size_t i = 0; i < change.elements.size(); ++i) {
    const Index e = change.elements[i];
    if (region.contains(e)) elements[filled++] = e;
    if (filled == 0 || (filled < lanes && i + 1 < change.elements.size())) continue;
    add_batch(instance, complex, rest.gather({elements.data(), filled}), {elements.data(), filled});
    filled = 0;
  }
  for (const auto& targets : targets_)
    for (const Target& target : targets) finish(instance, target, change);
}

void TouchedSums::find_targets(Instance& instance, const TopologyChange& change, Column& mass) {
  const suture_model& model = instance.model();
  for (auto& targets : targets_) targets.clear();
  for (std::uint32_t a = 0; a < model.attribute_count; ++a) {
    const suture_attribute& attribute = model.attributes[a];
    if (attribute.policy != SUTURE_FROM_VOLUMES || attribute.dimension == 3) continue;
    if (!instance.needs(a)) continue;
    if (change.stars[attribute.dimension].cells.empty()) continue;
    Column* own = instance.column(a);
    Column& column = own ? *own : mass;
    column.expand();
    targets_[attribute.dimension].push_back(
        {&attribute, &column,
         own ? &instance.table(static_cast<int>(attribute.dimension)).cells : nullptr,
         column.dimension() == 0 ? column.rows() : column.block(0)});
  }
}

void TouchedSums::start(const Target& target, const TopologyChange& change) {
  if (!target.cells) return;  // other instances have given to the mass
  const Column& column = *target.column;
  for (const Index cell : change.stars[target.attribute->dimension].cells) {
    const Index row = target.cells->row(cell);
    if (row == none) continue;
    double* value = target.values + column.offset(row);
    for (int c = 0; c < column.spec().components; ++c, value += column.component_step()) *value = 0;
  }
}

void TouchedSums::add_batch(Instance& instance, const CellComplex& complex,
                            const suture_batch& batch, std::span<const Index> elements) {
  for (std::uint32_t d = 0; d < 3; ++d) {
    if (targets_[d].empty()) continue;
    find_hits(complex, d, elements);
    if (hit_count_ == 0) continue;
    for (Target& target : targets_[d]) add_hits(instance, batch, target);
  }
}

void TouchedSums::find_hits(const CellComplex& complex, std::uint32_t dimension,
                            std::span<const Index> elements) {
  const int per_element = contribution_cells[dimension];
  const std::uint64_t* marks = marks_[dimension].data();
  hit_count_ = 0;
  for (std::uint32_t lane = 0; lane < elements.size(); ++lane) {
    const Index* cells = cells_of(complex, dimension, elements[lane]);
    for (int k = 0; k < per_element; ++k) {
      hits_[hit_count_] = {cells[k], static_cast<std::uint16_t>(k),
                           static_cast<std::uint16_t>(lane)};
      hit_count_ += marks[cells[k] / 64] >> (cells[k] % 64) & 1;  // no branch to predict
    }
  }
}

void TouchedSums::add_hits(Instance& instance, const suture_batch& batch, Target& target) {
  alignas(SUTURE_ALIGNMENT) std::array<double, std::size_t{12} * 9 * lanes> out;
  contribute(instance, *target.attribute, batch, out.data());
  const Column& column = *target.column;
  const auto components = static_cast<std::size_t>(column.spec().components);
  const std::size_t step = column.component_step();
  double all = 0;
  for (std::size_t i = 0; i < hit_count_; ++i) {
    const auto [cell, k, lane] = hits_[i];
    const Index row = target.cells ? target.cells->row(cell) : cell;
    double* to = target.values + (components == 1 ? row : column.offset(row));
    const double* from = out.data() + k * components * lanes + lane;
    for (std::size_t c = 0; c < components; ++c, from += lanes, to += step) {
      *to += *from;
      all += *from;
    }
  }
  target.all += all;
}

void TouchedSums::finish(const Instance& instance, const Target& target,
                         const TopologyChange& change) {
  target.column->pad();
  if (std::isfinite(target.all)) return;  // then so is every sum of some of them
  const Column& column = *target.column;
  for (const Index cell : change.stars[target.attribute->dimension].cells) {
    const Index row = target.cells ? target.cells->row(cell) : cell;
    if (row == none) continue;
    const double* value = target.values + column.offset(row);
    for (int c = 0; c < column.spec().components; ++c, value += column.component_step())
      if (!std::isfinite(*value)) refuse_value(instance, *target.attribute, cell, *value);
  }
}

}  // namespace suture
