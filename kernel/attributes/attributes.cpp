// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/attributes.hpp"

#include <algorithm>
#include <utility>

#include "kernel/attributes/inspection.hpp"
#include "kernel/base/error.hpp"
#include "kernel/parts/general_part.hpp"
#include "kernel/topology/disjoint_sets.hpp"

namespace suture {
namespace {

/// Bound within which the values of elements count as equal, relative to the largest
/// magnitude: of columns of 3-cells, and of what each element gives to a sum.
/// Congruent elements of a grid differ by rounding of their coordinates, some
/// 1e-16 x cells along an axis; 1e-13 covers 1000 of them and stays below the
/// 1e-12 of the stiffness scale within which rigid motions must give no force.
/// Columns of other dimensions are compressed only if equal to the bit: a cut changes
/// them, and its sums must be those of a fresh start.
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

/// visit(number, attribute) for all that elements contribute to.
template <class Visit>
void for_each_sum(const Instance& instance, Visit visit) {
  const suture_model& model = instance.model();
  for (std::uint32_t a = 0; a < model.attribute_count; ++a)
    if (model.attributes[a].policy == SUTURE_FROM_VOLUMES && instance.needs(a))
      visit(a, model.attributes[a]);
}

}  // namespace

Attributes::Attributes(const CellComplex& complex, std::span<const Vec3> rest) {
  if (rest.size() != complex.count(0))
    throw InputError("attributes: " + std::to_string(rest.size()) + " rest positions for " +
                     std::to_string(complex.count(0)) + " vertices; the numbers must be equal");
  for (int d = 0; d < 4; ++d) kernel(d).dimension = d;
  kernel(0).cells = all_cells(complex, 0);
  kernel(3).cells = all_cells(complex, 3);
  Table& t = kernel(0);
  rest_ = &add_column(t, "rest", "m", "Position without load.", 3, SUTURE_COPY);
  position_ = &add_column(t, "position", "m", "Current position.", 3, SUTURE_COPY);
  velocity_ = &add_column(t, "velocity", "m/s", "Current velocity.", 3, SUTURE_COPY);
  force_ = &add_column(t, "force", "N", "Sum of the forces of a step.", 3, SUTURE_ZERO);
  mass_ = &add_column(t, "mass", "kg", "Sum of the contributions of all models.", 1,
                      SUTURE_FROM_VOLUMES);
  fixed_ =
      &add_column(t, "fixed", "1", "Fixed components, as bits: 1 x, 2 y, 4 z.", 1, SUTURE_COPY);
  for (std::size_t v = 0; v < rest.size(); ++v)
    for (std::size_t c = 0; c < 3; ++c)
      rest_->rows()[4 * v + c] = position_->rows()[4 * v + c] = rest[v][c];
}

void Attributes::set_parts(const CellComplex& complex, ElementParts parts) {
  parts_ = std::move(parts);
  if (parts_.are_general()) return;
  const RestPlaces rest = rest_places(complex);
  for (const Index e : parts_.elements())
    if (!is_parallelepiped(rest.of(e)))
      throw InputError("element " + std::to_string(user_element.empty() ? e : user_element[e]) +
                       ", of which only a part is material, is not a parallelepiped at rest; the "
                       "surface of a body may cross the elements of a regular grid only");
}

void Attributes::let_parts_grow(const CellComplex& complex) {
  parts_.let_grow();
  const RestPlaces rest = rest_places(complex);
  for (Index e = 0; e < complex.element_count() && !parts_.are_general(); ++e)
    if (complex.exists(3, e) && !is_parallelepiped(rest.of(e))) parts_.make_general();
}

void Attributes::begin_copies(const CellComplex& complex, const Parts& copies,
                              std::span<const Index> origins) {
  std::vector<GeneralPart> general;
  const RestPlaces rest = rest_places(complex);
  for (std::size_t i = 0; i < origins.size() && parts_.are_general(); ++i)
    general.push_back(general_part(copies, i, rest.of(origins[i])));
  parts_.begin_copies(copies, general);
}

Instance& Attributes::add(std::unique_ptr<Instance> instance, CellComplex& complex,
                          std::vector<Index> elements) {
  instance->build(complex, rest_places(complex), std::move(elements));
  share_columns(*instance);
  if (complex.has_edges()) kernel(1).cells = all_cells(complex, 1);
  if (complex.has_faces()) kernel(2).cells = all_cells(complex, 2);
  return *instances_.emplace_back(std::move(instance));
}

/// The columns of the kernel that hold attributes of the instance.
void Attributes::share_columns(Instance& instance) {
  const suture_model& model = instance.model();
  VertexField* last = nullptr;
  for (std::uint32_t a = 0; a < model.attribute_count; ++a) {
    const suture_attribute& attribute = model.attributes[a];
    if ((attribute.flags & SUTURE_SHARED_MASS) != 0) instance.share(a, *mass_);
    if ((attribute.flags & SUTURE_FIELD) != 0)
      instance.share(a, *(last = &declare(attribute, instance))->values);
    const auto share = [&](std::uint32_t flag, Column* VertexField::*column) {
      if ((attribute.flags & flag) == 0) return;
      if (!(last->*column)) last->*column = &kernel(0).add(spec_of(attribute));
      instance.share(a, *(last->*column));
    };
    share(SUTURE_CAPACITY, &VertexField::capacity);
    share(SUTURE_RELAXATION, &VertexField::relaxation);
    share(SUTURE_FIELD_RATE, &VertexField::rate);
  }
}

namespace {

/// The first that declares a field of this name; there is one.
const Instance& first_with_field(std::span<const std::unique_ptr<Instance>> instances,
                                 const std::string& name) {
  return **std::ranges::find_if(instances, [&](const auto& instance) {
    const suture_model& model = instance->model();
    return std::ranges::any_of(
        std::span(model.attributes, model.attribute_count),
        [&](const suture_attribute& a) { return (a.flags & SUTURE_FIELD) != 0 && name == a.name; });
  });
}

}  // namespace

VertexField& Attributes::declare(const suture_attribute& attribute, const Instance& instance) {
  const auto known = std::ranges::find(fields_, attribute.name, &VertexField::name);
  const bool is_rising = (attribute.flags & SUTURE_RISING) != 0;
  if (known == fields_.end())
    return fields_.emplace_back(
        VertexField{attribute.name, attribute.unit, &kernel(0).add(spec_of(attribute)), is_rising});
  known->is_rising |= is_rising;
  const ColumnSpec& spec = known->values->spec();
  const std::string in_other = "in " + first_with_field(instances_, known->name).title();
  if (spec.components != static_cast<int>(attribute.components))
    throw InputError(instance.title() + ": field '" + known->name + "' has " +
                     std::to_string(attribute.components) + " components, but " + in_other +
                     " it has " + std::to_string(spec.components));
  if (known->unit != attribute.unit || spec.initial != attribute.initial)
    throw InputError(instance.title() + ": field '" + known->name + "' starts from " +
                     std::to_string(attribute.initial) + ' ' + attribute.unit + ", but " +
                     in_other + " from " + std::to_string(spec.initial) + ' ' + known->unit +
                     "; models that share a field must agree on both");
  return *known;
}

VertexField* Attributes::field_of(const suture_model& model, const suture_functor& functor) {
  if (functor.field == 0) return nullptr;
  return &*std::ranges::find(fields_, model.attributes[functor.field - 1].name, &VertexField::name);
}

/// Clears masses and the sums of fields, to which all instances contribute.
void Attributes::clear_sums() {
  mass_->fill(0);
  for (const VertexField& field : fields_)
    for (Column* sum : field.sums())
      if (sum) sum->fill(0);
}

void Attributes::initialise(const CellComplex& complex, Diagnostics& diagnostics) {
  sums_.reserve(complex);
  RestBatch rest(rest_places(complex), user_element);
  for (Table& table : kernel_) MergePolicies::weigh(table, kernel(3).cells, rest_places(complex));
  clear_sums();
  for (const auto& instance : instances_) {
    for (Table& table : instance->tables())
      MergePolicies::weigh(table, instance->table(3).cells, rest_places(complex));
    for_each_sum(*instance, [&](std::uint32_t a, const suture_attribute& attribute) {
      std::vector<double> uniform;
      if (attribute.dimension < 3 && instance->skips() && !instance->has_parts())
        uniform = uniform_contribution(*instance, attribute, complex, rest, volume_tolerance);
      sum(*instance, a, complex, rest,
          sums_.keep_uniform(*instance, attribute, std::move(uniform)));
    });
  }
  for (const auto& instance : instances_)
    inspect(*instance, rest_places(complex), *mass_, user_element, diagnostics);
}

namespace {

/// What Column::compress() would leave, without memory for all elements. False if there is no
/// value of all.
bool fill_uniform(Column& column, std::span<const double> values) {
  if (values.empty() || column.has_trial()) return false;
  std::vector<double> block;
  for (const double value : values) block.insert(block.end(), Column::lanes, value);
  column.fill(block);
  return true;
}

}  // namespace

/// One attribute over all elements; the share of the mass is added.
void Attributes::sum(Instance& instance, std::uint32_t number, const CellComplex& complex,
                     RestBatch& rest, std::span<const double> uniform) {
  const suture_attribute& attribute = instance.model().attributes[number];
  const auto dimension = static_cast<int>(attribute.dimension);
  Column* own = instance.column(number);
  Column& column = own ? *own : *instance.shared_column(number);
  const CellSet& cells = own ? instance.table(dimension).cells : kernel(0).cells;
  if (own && instance.skips() && fill_from_parameters(instance, attribute, complex, rest, column))
    return;
  const bool of_shape = dimension == 3 && (attribute.flags & SUTURE_FROM_PARAMETERS) == 0;
  if (of_shape && own && instance.skips() && cells.is_all() &&
      complex.existing(3) == complex.element_count() &&
      fill_uniform(column,
                   uniform_contribution(instance, attribute, complex, rest, volume_tolerance)))
    return;
  if (own) column.fill(0);
  sum_contributions(instance, attribute, complex, rest, cells, column, uniform);
  if (own && instance.skips()) column.compress(of_shape ? volume_tolerance : 0);
}

void Attributes::set_parameters(Instance& instance, std::vector<double> parameters,
                                const CellComplex& complex, Diagnostics& diagnostics) {
  instance.set_parameters(std::move(parameters), diagnostics);
  have_changed(instance, complex, diagnostics);
}

void Attributes::set_field(Instance& instance, std::size_t parameter,
                           std::span<const double> values, const CellComplex& complex,
                           Diagnostics& diagnostics) {
  instance.set_field(parameter, values, diagnostics);
  have_changed(instance, complex, diagnostics);
}

/// From now on no contribution of the instance is taken to be the same for all elements: which one
/// would stand for all depends on the elements that there are.
void Attributes::have_changed(Instance& instance, const CellComplex& complex,
                              Diagnostics& diagnostics) {
  for_each_sum(instance, [&](std::uint32_t, const suture_attribute& attribute) {
    sums_.keep_uniform(instance, attribute, {});
  });
  sum_again(instance, complex);
  inspect(instance, rest_places(complex), *mass_, user_element, diagnostics);
}

void Attributes::sum_again(Instance& instance, const CellComplex& complex) {
  RestBatch rest(rest_places(complex), user_element);
  clear_sums();
  for (const auto& other : instances_)
    for_each_sum(*other, [&](std::uint32_t a, const suture_attribute& attribute) {
      if (other.get() == &instance)
        sum(instance, a, complex, rest, {});
      else if (other->column(a) == nullptr)
        sum(*other, a, complex, rest, sums_.uniform(*other, attribute));
    });
}

void Attributes::apply(const CellComplex& complex, const TopologyChange& change) {
  if (change.empty()) return;
  ++operations_;
  complete_rows();
  add_copies(complex, change.copies);
  merge_vertices(complex, change);  // then elements have the right rest places
  follow(kernel_, complex, change, kernel(0).columns.size());  // merged above
  clear_vertices(change);
  RestBatch rest(rest_places(complex), user_element);
  for (const auto& instance : instances_) {
    follow(instance->tables(), complex, change);
    sums_.sum(*instance, complex, rest, change);
  }
  sums_.clear(change);
}

void Attributes::make_room(Index faces, Index largest) {
  const std::array<Index, 3> cells = cells_of_cut(faces);
  const auto make_room_in = [&](std::span<Table, 4> tables) {
    for (std::size_t d = 0; d < cells.size(); ++d)
      for (Column& column : tables[d].columns)
        column.make_room(std::min(cells[d], tables[d].cells.size()));
  };
  make_room_in(kernel_);
  for (const auto& instance : instances_) make_room_in(instance->tables());
  policies_.make_room(cells_of_cut(largest)[1]);
}

void Attributes::add_copies(const CellComplex& complex, std::span<const Split> copies) {
  if (copies.empty()) return;
  kernel(3).cells.append_all(static_cast<Index>(copies.size()));
  for (const auto& instance : instances_) instance->add_copies(copies, parts_);
  for (const auto& [origin, copy] : copies) own_rest_.copy(origin, copy, complex.element_count());
}

void Attributes::follow(std::span<Table, 4> tables, const CellComplex& complex,
                        const TopologyChange& change, std::size_t first_column) {
  const CellSet& region = tables[3].cells;
  if (!region.is_all() || std::ranges::any_of(tables, SplitPolicies::weighs) ||
      change.faces_sewn != 0) {
    touched_.reserve(complex.element_count());
    touched_.select(region, change.elements);
    if (touched_.members().empty() && change.removed[3].empty()) return;
  }
  const RestPlaces rest = rest_places(complex);
  for (Table& table : tables) {
    if (table.cells.size() == 0) continue;
    if (table.dimension < 3) policies_.apply(table, complex, rest, touched_, change);
    merging_.apply(table, rest, touched_, vertex_weights_, policies_.new_rows(), change,
                   table.dimension == 0 ? first_column : 0);
  }
}

void Attributes::merge_vertices(const CellComplex& complex, const TopologyChange& change) {
  vertex_weights_.clear();
  for (const auto& [kept, gone] : change.merges[0])
    vertex_weights_.push_back({mass_->get(kept, 0), mass_->get(gone, 0)});
  for (const VertexField& field : fields_)
    merge_values(*field.values, field.capacity ? *field.capacity : *mass_, change.merges[0]);
  VertexMerge{*rest_, *position_, *velocity_, *fixed_, own_rest_, parts_}.apply(complex, change,
                                                                                vertex_weights_);
}

void Attributes::complete_rows() {
  position();
  velocity();
  force();
}

void Attributes::bring_together(const std::vector<std::pair<Index, Index>>& equal) {
  complete_rows();
  const auto give_mean = [](Column& column, int c, const std::vector<Index>& group, auto weight) {
    double sum = 0, all = 0;
    for (const Index v : group) {
      sum += weight(v) * column.get(v, c);
      all += weight(v);
    }
    for (const Index v : group)
      if (all > 0) column.set(v, c, sum / all);
  };
  for (const std::vector<Index>& group : groups_of_equal(equal)) {
    for (int c = 0; c < 3; ++c) {
      const auto is_fixed = [&](Index v) { return (int(fixed_->get(v, 0)) >> c & 1) != 0; };
      const bool has_fixed = std::ranges::any_of(group, is_fixed);
      const auto weight = [&](Index v) {
        return has_fixed ? double(is_fixed(v)) : mass_->get(v, 0);
      };
      for (Column* column : {position_, velocity_}) give_mean(*column, c, group, weight);
    }
    for (const VertexField& field : fields_) {
      const Column& by = field.capacity ? *field.capacity : *mass_;
      for (int c = 0; c < field.values->spec().components; ++c)
        give_mean(*field.values, c, group, [&](Index v) { return by.get(v, 0); });
    }
  }
}

/// What is gone is zero, so that integrators and sums may pass over it; masses that are
/// to be summed again begin at zero.
void Attributes::clear_vertices(const TopologyChange& change) {
  for (const Merge& merge : change.merges[0]) clear_vertex(merge.gone);
  for (const Index vertex : change.removed[0]) clear_vertex(vertex);
  for (const Index element : change.removed[3]) own_rest_.remove(element);
  for (const Index vertex : change.stars[0].cells) mass_->rows()[vertex] = 0;
  for (const VertexField& field : fields_)
    for (Column* sum : field.sums())
      for (const Index vertex : change.stars[0].cells)
        if (sum) sum->rows()[vertex] = 0;
}

void Attributes::clear_vertex(Index vertex) {
  for (Column* column : {velocity_, force_, mass_, fixed_})
    for (int c = 0; c < column->spec().components; ++c) column->set(vertex, c, 0);
  for (const VertexField& field : fields_)
    for (Column* sum : field.sums())
      if (sum) sum->set(vertex, 0, 0);
}

namespace {

template <class Instances, class Visit>
void for_each_state(const Instances& instances, Visit visit) {
  for (const auto& instance : instances)
    for (int d = 0; d < 4; ++d)
      for (Column& column : instance->table(d).columns)
        if (column.has_trial()) visit(column);
}

}  // namespace

void Attributes::accept_trials() {
  for_each_state(instances_, [](Column& column) { column.accept(); });
}

}  // namespace suture
