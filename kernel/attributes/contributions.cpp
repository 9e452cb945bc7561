// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/contributions.hpp"

#include <algorithm>
#include <boost/range/irange.hpp>
#include <cmath>
#include <limits>

#include "kernel/base/error.hpp"
#include "kernel/base/lanes.hpp"
#include "kernel/base/reset_error.hpp"
#include "kernel/plugin_host/guarded_array.hpp"
#include "kernel/topology/incidence.hpp"

namespace suture {
namespace {

/// Where a contribution functor of this thread writes until the next one does.
double* space_for(const suture_attribute& attribute) {
  static thread_local GuardedArray space("its results",
                                         "a contribution has a row of 8 lanes per component of "
                                         "each vertex, edge or face of the element",
                                         std::size_t{12} * 9 * lanes);
  return space.end() - std::size_t{lanes} * attribute.components *
                           static_cast<std::size_t>(contribution_cells[attribute.dimension]);
}

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

/// visit(elements) for up to 8 elements of the region at a time, in the order of
/// `elements`, until it returns false.
template <class Elements, class Visit>
void for_each_batch(const CellSet& region, const Elements& elements, Visit visit) {
  std::array<Index, lanes> batch;
  Index filled = 0;
  for (const Index e : elements) {
    if (!region.contains(e)) continue;
    batch[filled++] = e;
    if (filled < lanes) continue;
    if (!visit(std::span<const Index>(batch))) return;
    filled = 0;
  }
  if (filled != 0) visit(std::span<const Index>(batch).first(filled));
}

auto all_elements(const CellComplex& complex) {
  return boost::irange(Index{0}, complex.element_count());
}

/// What hexahedra give; the plugin host has checked that it is there.
suture_contribution_fn function_of(const suture_attribute& attribute) {
  const std::span all(attribute.contributions, attribute.contribution_count);
  return std::ranges::find(all, SUTURE_HEXAHEDRON, &suture_contribution::cell_type)->function;
}

/// Throws PluginError, naming the element, unless the values of the valid lanes are finite and
/// those of a mass not negative.
void require_values(const PluginCall& call, const double* out) {
  const suture_attribute& attribute = *call.attribute;
  const bool is_mass =
      (attribute.flags & (SUTURE_SHARED_MASS | SUTURE_CAPACITY | SUTURE_RELAXATION)) != 0;
  constexpr double most = std::numeric_limits<double>::max();
  const double least = is_mass ? 0 : -most;
  const std::size_t count = contribution_cells[attribute.dimension] * attribute.components;
  for (std::size_t i = 0; i < count; ++i)
    for (Index lane = 0; lane < call.batch->valid; ++lane) {
      const double value = out[i * lanes + lane];
      if (value >= least && value <= most) continue;
      throw PluginError(describe(call) + ": element " + std::to_string(call.batch->cell_ids[lane]) +
                        " gives " + std::to_string(value) + " " + attribute.unit +
                        "; a contribution must be " +
                        (is_mass ? "finite and, as a mass or capacity, not negative" : "finite"));
    }
}

}  // namespace

RestBatch::RestBatch(const RestPlaces& rest, std::span<const Index> user_element)
    : rest_(rest), user_element_(user_element) {
  batch_.size = sizeof(suture_batch);
  batch_.lanes = lanes;
  batch_.nodes = 8;
  batch_.rest = positions_.data();
  batch_.position = batch_.velocity = zeros_.data();
  batch_.cell_ids = ids_.data();
}

/// Every component of every column is a row of lanes.
void RestBatch::gather_parameters(const Instance& instance, std::span<const Index> elements) {
  const auto columns = instance.parameter_columns();
  parameters_.clear();
  parameter_columns_.clear();
  for (const Column* column : columns)
    for (int c = 0; c < column->spec().components; ++c)
      for (Index lane = 0; lane < lanes; ++lane) {
        const Index e = elements[lane < elements.size() ? lane : elements.size() - 1];
        parameters_.push_back(column->get(instance.table(3).cells.row(e), c));
      }
  const double* at = parameters_.data();
  for (const Column* column : columns) {
    parameter_columns_.push_back(at);
    at += std::ptrdiff_t{column->spec().components} * lanes;
  }
  batch_.cell_columns = columns.empty() ? nullptr : parameter_columns_.data();
}

void RestBatch::scale(const suture_attribute& attribute, double* out) const {
  if (!has_parts_ || attribute.dimension == 3) return;
  const std::size_t rows = contribution_cells[attribute.dimension] * attribute.components;
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t lane = 0; lane < lanes; ++lane) out[row * lanes + lane] *= fractions_[lane];
}

const suture_batch& RestBatch::gather(const Instance& instance, std::span<const Index> elements) {
  gather_parameters(instance, elements);
  batch_.valid = static_cast<std::uint32_t>(elements.size());
  has_parts_ = instance.has_parts();
  for (Index lane = 0; lane < lanes; ++lane) {
    const Index e = elements[lane < batch_.valid ? lane : batch_.valid - 1];
    if (has_parts_) fractions_[lane] = rest_.parts().fraction(e);
    ids_[lane] = user_element_.empty() ? e : user_element_[e];
    double* out = positions_.data() + lane;
    for (std::size_t node = 0; node < hexahedron::vertices; ++node) {
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
  reset(*context.error);
  PluginCall call = instance.call("contribution");
  call.attribute = &attribute;
  call.batch = &batch;
  const auto ask = [&] { return function_of(attribute)(&context, &batch, out); };
  if (call_plugin(call, *context.error, ask) == SUTURE_OK) return require_values(call, out);
  const Index cell = context.error->cell == none ? batch.cell_ids[0] : context.error->cell;
  throw InputError(instance.title() + ": attribute '" + attribute.name + "' at element " +
                   std::to_string(cell) + ": " + text_of(*context.error));
}

std::vector<double> uniform_contribution(Instance& instance, const suture_attribute& attribute,
                                         const CellComplex& complex, RestBatch& rest,
                                         double relative) {
  std::vector<double> first;
  double bound = 0;
  double* const out = space_for(attribute);
  const std::size_t count = contribution_cells[attribute.dimension] * attribute.components;
  for_each_batch(instance.table(3).cells, all_elements(complex),
                 [&](std::span<const Index> elements) {
                   contribute(instance, attribute, rest.gather(instance, elements), out);
                   if (first.empty())
                     for (std::size_t i = 0; i < count; ++i) {
                       first.push_back(out[i * lanes]);
                       bound = std::max(bound, relative * std::abs(first.back()));
                     }
                   bool uniform = true;
                   for (std::size_t i = 0; i < count; ++i)
                     for (std::size_t lane = 0; lane < elements.size(); ++lane)
                       uniform &= std::abs(out[i * lanes + lane] - first[i]) <= bound;
                   if (!uniform) first.clear();
                   return uniform;
                 });
  return first;
}

void sum_contributions(Instance& instance, const suture_attribute& attribute,
                       const CellComplex& complex, RestBatch& rest, const CellSet& cells,
                       Column& column, std::span<const double> uniform) {
  column.expand();
  double* values = column.dimension() == 0 ? column.rows() : column.block(0);
  const std::size_t step = column.component_step();
  const int per_element = contribution_cells[attribute.dimension];
  const int components = column.spec().components;
  double* const out = space_for(attribute);
  for (std::size_t i = 0; i < uniform.size(); ++i) std::fill_n(&out[i * lanes], lanes, uniform[i]);
  for_each_batch(instance.table(3).cells, all_elements(complex),
                 [&](std::span<const Index> elements) {
                   if (uniform.empty()) {
                     contribute(instance, attribute, rest.gather(instance, elements), out);
                     rest.scale(attribute, out);
                   }
                   for (Index lane = 0; lane < elements.size(); ++lane) {
                     const Index* incident = cells_of(complex, attribute.dimension, elements[lane]);
                     const double* from = out + lane;
                     for (int k = 0; k < per_element; ++k) {
                       double* to = values + column.offset(cells.row(incident[k]));
                       for (int c = 0; c < components; ++c, from += lanes)
                         to[static_cast<std::size_t>(c) * step] += *from;
                     }
                   }
                   return true;
                 });
  column.pad();
}

bool fill_from_parameters(Instance& instance, const suture_attribute& attribute,
                          const CellComplex& complex, RestBatch& rest, Column& column) {
  const auto is_uniform = [](const Column* c) { return c->is_constant(); };
  if ((attribute.flags & SUTURE_FROM_PARAMETERS) == 0 ||
      !std::ranges::all_of(instance.parameter_columns(), is_uniform))
    return false;
  double* const out = space_for(attribute);
  for_each_batch(instance.table(3).cells, all_elements(complex),
                 [&](std::span<const Index> elements) {
                   contribute(instance, attribute, rest.gather(instance, elements.first(1)), out);
                   return false;
                 });
  column.fill({out, std::size_t{attribute.components} * lanes});
  return true;
}

// ------------------------------------------------------------- touched cells --

void TouchedSums::reserve(const CellComplex& complex) {
  for (std::size_t d = 0; d < 3; ++d)
    marks_[d].resize(complex.count(static_cast<int>(d)) / 64 + 1, 0);
}

std::span<const double> TouchedSums::keep_uniform(const Instance& instance,
                                                  const suture_attribute& attribute,
                                                  std::vector<double> values) {
  std::erase_if(uniform_, [&](const Uniform& a) {
    return a.instance == &instance && a.attribute == &attribute;
  });
  if (values.empty()) return {};
  return uniform_.emplace_back(Uniform{&instance, &attribute, std::move(values)}).values;
}

std::span<const double> TouchedSums::uniform(const Instance& instance,
                                             const suture_attribute& attribute) const {
  for (const Uniform& a : uniform_)
    if (a.instance == &instance && a.attribute == &attribute) return a.values;
  return {};
}

void TouchedSums::mark(const CellComplex& complex, const TopologyChange& change) {
  if (marked_) return;
  reserve(complex);
  marked_ = true;
  for (std::size_t d = 0; d < 3; ++d)
    for (const Index cell : change.stars[d].cells)
      marks_[d][cell / 64] |= std::uint64_t{1} << (cell % 64);
}

void TouchedSums::clear(const TopologyChange& change) {
  if (!marked_) return;
  marked_ = false;
  for (std::size_t d = 0; d < 3; ++d)
    for (const Index cell : change.stars[d].cells) marks_[d][cell / 64] = 0;
}

void TouchedSums::sum(Instance& instance, const CellComplex& complex, RestBatch& rest,
                      const TopologyChange& change) {
  find_targets(instance, change);
  sum_uniform<0>(instance, change, rest.parts());
  sum_uniform<1>(instance, change, rest.parts());
  sum_uniform<2>(instance, change, rest.parts());
  if (std::ranges::all_of(targets_, [](const auto& t) { return t.empty(); })) return;
  mark(complex, change);
  for (const auto& targets : targets_)
    for (const Target& target : targets) start(target, change);
  for_each_batch(instance.table(3).cells, change.elements, [&](std::span<const Index> elements) {
    rest.gather(instance, elements);
    add_batch(instance, complex, rest, elements);
    return true;
  });
  for (const auto& targets : targets_)
    for (const Target& target : targets) target.column->pad();
}

void TouchedSums::find_targets(Instance& instance, const TopologyChange& change) {
  const suture_model& model = instance.model();
  for (auto& targets : targets_) targets.clear();
  for (auto& targets : uniform_targets_) targets.clear();
  for (std::uint32_t a = 0; a < model.attribute_count; ++a) {
    const suture_attribute& attribute = model.attributes[a];
    if (attribute.policy != SUTURE_FROM_VOLUMES || attribute.dimension == 3) continue;
    if (!instance.needs(a)) continue;
    if (change.stars[attribute.dimension].cells.empty()) continue;
    Column* own = instance.column(a);
    Column& column = own ? *own : *instance.shared_column(a);
    column.expand();
    const std::span<const double> values = uniform(instance, attribute);
    auto& targets = values.empty() ? targets_ : uniform_targets_;
    targets[attribute.dimension].push_back(
        {&attribute, &column,
         own ? &instance.table(static_cast<int>(attribute.dimension)).cells : nullptr,
         column.dimension() == 0 ? column.rows() : column.block(0), attribute.components,
         values.data()});
  }
}

template <int Dimension>
void TouchedSums::sum_uniform(const Instance& instance, const TopologyChange& change,
                              const ElementParts& parts) {
  for (const Target& target : uniform_targets_[Dimension])
    target.sum_uniform<Dimension>(change.stars[Dimension], instance.table(3).cells,
                                  instance.has_parts() ? &parts : nullptr);
}

/// If all elements give identical values, no contribution is called: the darts of a star show
/// which of the values the cell receives, in the order of the elements.
template <int Dimension>
void TouchedSums::Target::sum_uniform(const Stars& stars, const CellSet& region,
                                      const ElementParts* parts) const {
  using hexahedron::darts;
  const bool everywhere = region.is_all();
  std::array<double, darts> given;
  for (std::size_t c = 0; c < components; ++c) {
    for (int d = 0; d < darts; ++d)
      given[d] = uniform[incidence::local_of<Dimension>(d) * components + c];
    const Dart* dart = stars.darts.data();
    const Dart* end = dart;
    for (std::size_t i = 0; i < stars.size(); ++i, dart = end) {
      end = stars.darts.data() + stars.offsets[i + 1];
      const Index row = cells ? cells->row(stars.cells[i]) : stars.cells[i];
      if (row == none) continue;
      double& value =
          values[(components == 1 ? row : column->offset(row)) + c * column->component_step()];
      double sum = cells ? 0 : value;  // other instances have given to shared columns
      for (; dart < end; ++dart) {
        const Index element = *dart / darts;
        if (!everywhere && !region.contains(element)) continue;
        sum += parts ? parts->fraction(element) * given[*dart % darts] : given[*dart % darts];
      }
      value = sum;
    }
  }
  column->pad();
}

void TouchedSums::start(const Target& target, const TopologyChange& change) {
  if (!target.cells) return;  // other instances have given to shared columns
  const Column& column = *target.column;
  for (const Index cell : change.stars[target.attribute->dimension].cells) {
    const Index row = target.cells->row(cell);
    if (row == none) continue;
    double* value = target.values + column.offset(row);
    for (int c = 0; c < column.spec().components; ++c, value += column.component_step()) *value = 0;
  }
}

void TouchedSums::add_batch(Instance& instance, const CellComplex& complex, const RestBatch& rest,
                            std::span<const Index> elements) {
  for (std::uint32_t d = 0; d < 3; ++d) {
    if (targets_[d].empty()) continue;
    find_hits(complex, d, elements);
    if (hit_count_ == 0) continue;
    for (Target& target : targets_[d]) add_hits(instance, rest, target);
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

void TouchedSums::add_hits(Instance& instance, const RestBatch& rest, Target& target) {
  double* const out = space_for(*target.attribute);
  contribute(instance, *target.attribute, rest.batch(), out);
  rest.scale(*target.attribute, out);
  const Column& column = *target.column;
  const auto components = static_cast<std::size_t>(column.spec().components);
  const std::size_t step = column.component_step();
  for (std::size_t i = 0; i < hit_count_; ++i) {
    const auto [cell, k, lane] = hits_[i];
    const Index row = target.cells ? target.cells->row(cell) : cell;
    double* to = target.values + (components == 1 ? row : column.offset(row));
    const double* from = out + k * components * lanes + lane;
    for (std::size_t c = 0; c < components; ++c, from += lanes, to += step) *to += *from;
  }
}

}  // namespace suture
