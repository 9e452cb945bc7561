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

/// Local number of a star's cell in the element of the dart, by dimension.
const std::array<hexahedron::Local, hexahedron::darts>& local_cells(std::uint32_t dimension) {
  static constexpr auto faces = [] {
    std::array<hexahedron::Local, hexahedron::darts> result{};
    for (std::size_t d = 0; d < result.size(); ++d)
      result[d] = static_cast<hexahedron::Local>(d / hexahedron::darts_per_face);
    return result;
  }();
  if (dimension == 0) return hexahedron::dart_vertex;
  return dimension == 1 ? hexahedron::dart_edge : faces;
}

}  // namespace

RestBatch::RestBatch(const CellComplex& complex, const Column& rest,
                     std::span<const Index> user_element)
    : complex_(complex), rest_(rest), user_element_(user_element) {
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
    const Hexahedron& nodes = complex_.vertices_of(e);
    double* out = positions_.data() + lane;
    for (const Index node : nodes) {
      const double* row = rest_.rows() + std::size_t{node} * 4;
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

void TouchedSums::sum(Instance& instance, RestBatch& rest, const TouchedElements& touched,
                      const TopologyChange& change, Column& mass) {
  const suture_model& model = instance.model();
  const std::size_t batches = (touched.members().size() + lanes - 1) / lanes;
  std::size_t count = 0;
  for (std::uint32_t a = 0; a < model.attribute_count; ++a) {
    const suture_attribute& attribute = model.attributes[a];
    if (attribute.policy != SUTURE_FROM_VOLUMES || attribute.dimension == 3) continue;
    if (change.stars[attribute.dimension].cells.empty()) continue;
    if (count == pending_.size()) pending_.emplace_back();
    Pending& pending = pending_[count++];
    pending.attribute = &attribute;
    pending.column = instance.column(a) ? instance.column(a) : &mass;
    pending.per_batch = static_cast<std::size_t>(contribution_cells[attribute.dimension]) *
                        attribute.components * lanes;
    pending.values.resize(batches * pending.per_batch);
  }
  pending_.resize(count);
  if (count == 0) return;
  evaluate(instance, rest, touched);
  for (const Pending& pending : pending_) {
    const auto dimension = static_cast<int>(pending.attribute->dimension);
    const bool own = pending.column != &mass;
    sum_at(instance, pending, touched, change.stars[pending.attribute->dimension],
           own ? &instance.table(dimension).cells : nullptr);
  }
}

void TouchedSums::evaluate(Instance& instance, RestBatch& rest, const TouchedElements& touched) {
  std::span<const Index> left = touched.members();
  for (std::size_t b = 0; !left.empty(); ++b) {
    const std::size_t taken = std::min<std::size_t>(left.size(), lanes);
    const suture_batch& batch = rest.gather(left.first(taken));
    for (Pending& p : pending_)
      contribute(instance, *p.attribute, batch, p.values.data() + b * p.per_batch);
    left = left.subspan(taken);
  }
}

/// `cells`: the rows of the column; nullptr for the kernel's mass, which keeps
/// what other instances gave it.
void TouchedSums::sum_at(const Instance& instance, const Pending& pending,
                         const TouchedElements& touched, const Stars& stars,
                         const CellSet* cells) const {
  Column& column = *pending.column;
  column.expand();
  double* values = column.dimension() == 0 ? column.rows() : column.block(0);
  const auto& local = local_cells(pending.attribute->dimension);
  const auto components = static_cast<std::size_t>(column.spec().components);
  for (std::size_t i = 0; i < stars.cells.size(); ++i) {
    const Index row = cells ? cells->row(stars.cells[i]) : stars.cells[i];
    if (row == none) continue;
    for (std::size_t c = 0; c < components; ++c) {
      double& value = values[column.offset(row) + c * column.component_step()];
      double sum = cells ? 0 : value;
      for (Index j = stars.offsets[i]; j < stars.offsets[i + 1]; ++j) {
        const Dart dart = stars.darts[j];
        const Index slot = touched.slot(dart / hexahedron::darts);
        if (slot == none) continue;
        const std::size_t at = local[dart % hexahedron::darts] * components + c;
        sum += pending.values[slot / lanes * pending.per_batch + at * lanes + slot % lanes];
      }
      if (!std::isfinite(sum)) refuse_value(instance, *pending.attribute, stars.cells[i], sum);
      value = sum;
    }
  }
  column.pad();
}

}  // namespace suture
