// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/fields.hpp"

#include <algorithm>
#include <limits>

#include "kernel/base/error.hpp"
#include "kernel/base/nearest.hpp"

namespace suture {
namespace {

using On = FieldChoice::On;

// Three components of each vertex, tightly packed.
template <class Value>
void fill_vectors(World& world, FrameField& field, Value value) {
  const Index count = world.complex().count(0);
  field.components = 3;
  field.values.resize(std::size_t{3} * count);
  for (Index v = 0; v < count; ++v) {
    for (int a = 0; a < 3; ++a)
      field.values[std::size_t{3} * v + static_cast<std::size_t>(a)] = value(v, a);
  }
}

void fill_column(const Column& column, FrameField& field) {
  field.components = 1;
  field.values.resize(column.size());
  for (Index i = 0; i < column.size(); ++i) field.values[i] = column.get(i, 0);
}

template <class Value>
void fill_ids(Index count, FrameField& field, Value value) {
  field.components = 1;
  field.ids.resize(count);
  for (Index i = 0; i < count; ++i) field.ids[i] = static_cast<std::int64_t>(value(i));
}

void displacement(World& world, const Vec3&, double, FrameField& field) {
  const Column &x = world.attributes.position(), &rest = world.attributes.rest();
  fill_vectors(world, field, [&](Index v, int a) { return x.get(v, a) - rest.get(v, a); });
}

void velocity(World& world, const Vec3&, double, FrameField& field) {
  const Column& column = world.attributes.velocity();
  fill_vectors(world, field, [&](Index v, int a) { return column.get(v, a); });
}

// f = f_int + loads + m g
double total_force(World& world, const Vec3& gravity, Index v, int a) {
  return world.attributes.force().get(v, a) +
         world.attributes.mass().get(v, 0) * gravity[static_cast<std::size_t>(a)];
}

void force(World& world, const Vec3& gravity, double, FrameField& field) {
  fill_vectors(world, field, [&](Index v, int a) { return total_force(world, gravity, v, a); });
}

// What the support gives: the opposite of the force, in constrained directions.
void reaction(World& world, const Vec3& gravity, double, FrameField& field) {
  fill_vectors(world, field, [&](Index v, int a) {
    const bool held = (static_cast<int>(world.attributes.fixed().get(v, 0)) >> a & 1) != 0;
    return held ? -total_force(world, gravity, v, a) : 0.0;
  });
}

void mass(World& world, const Vec3&, double, FrameField& field) {
  fill_column(world.attributes.mass(), field);
}

void fixed(World& world, const Vec3&, double, FrameField& field) {
  fill_column(world.attributes.fixed(), field);
}

void node_id(World& world, const Vec3&, double, FrameField& field) {
  fill_ids(world.complex().count(0), field,
           [&](Index v) { return world.names.point_id(world.user_vertex[v]); });
}

void element_id(World& world, const Vec3&, double, FrameField& field) {
  field.global_ids = true;
  fill_ids(world.complex().element_count(), field,
           [&](Index e) { return world.names.element_id(world.imported.user_element[e]); });
}

void island(World& world, const Vec3&, double, FrameField& field) {
  const Islands& islands = world.islands();
  fill_ids(world.complex().element_count(), field, [&](Index e) { return islands.of(e); });
}

void model(World& world, const Vec3&, double, FrameField& field) {
  field.components = 1;
  field.ids.resize(world.complex().element_count());
  std::int64_t number = 0;
  for (const auto& instance : world.attributes.instances()) {
    const CellSet& cells = instance->table(3).cells;
    for (Index row = 0; row < cells.size(); ++row) field.ids[cells.cell(row)] = number;
    ++number;
  }
}

// Where a cell of an instance's table stands in the frame: springs instance after
// instance in the order of their rows, elements and vertices by number.
std::size_t frame_size(World& world, int dimension) {
  if (dimension != 1) return world.complex().count(dimension);
  std::size_t springs = 0;
  for (const auto& instance : world.attributes.instances())
    springs += instance->table(1).cells.size();
  return springs;
}

// values(instance, out): components per row of the instance's table.
template <class Values>
void gather_instances(World& world, int dimension, int components, FrameField& field,
                      Values values) {
  const auto width = static_cast<std::size_t>(components);
  field.components = components;
  field.values.assign(frame_size(world, dimension) * width,
                      std::numeric_limits<double>::quiet_NaN());
  std::size_t springs = 0;
  for (const auto& instance : world.attributes.instances()) {
    const CellSet& cells = instance->table(dimension).cells;
    std::vector<double> of_rows(cells.size() * width, std::numeric_limits<double>::quiet_NaN());
    if (values(*instance, of_rows)) {
      for (Index row = 0; row < cells.size(); ++row) {
        if (!has_cell(world.complex(), instance->table(dimension), row)) continue;
        const std::size_t place = dimension == 1 ? springs + row : cells.cell(row);
        std::copy_n(of_rows.data() + row * width, width, field.values.data() + place * width);
      }
    }
    springs += cells.size();
  }
}

On place_of(std::uint32_t dimension) {
  return dimension == 0 ? On::points : dimension == 1 ? On::springs : On::cells;
}

FieldChoice output_field(const suture_functor& functor, const suture_field& field) {
  const int dimension = static_cast<int>(functor.dimension),
            components = static_cast<int>(field.components);
  const std::string name = field.name;
  return {name, place_of(functor.dimension), false,
          [=](World& world, const Vec3&, double time, FrameField& out) {
            gather_instances(world, dimension, components, out,
                             [&](Instance& instance, std::span<double> rows) {
                               return world.dynamics->forces().compute_field(instance, dimension,
                                                                             name, time, rows);
                             });
          },
          true};
}

FieldChoice attribute_field(const suture_attribute& attribute) {
  const int dimension = static_cast<int>(attribute.dimension),
            components = static_cast<int>(attribute.components);
  const std::string name = attribute.name;
  return {name, place_of(attribute.dimension), false,
          [=](World& world, const Vec3&, double, FrameField& out) {
            gather_instances(
                world, dimension, components, out, [&](Instance& instance, std::span<double> rows) {
                  const Column* column = instance.table(dimension).find(name);
                  if (column == nullptr) return false;
                  for (std::size_t i = 0; i < rows.size(); ++i) {
                    const auto width = static_cast<std::size_t>(components);
                    rows[i] =
                        column->get(static_cast<Index>(i / width), static_cast<int>(i % width));
                  }
                  return true;
                });
          }};
}

bool contains(const std::vector<FieldChoice>& fields, const FieldChoice& field) {
  return std::any_of(fields.begin(), fields.end(), [&](const FieldChoice& f) {
    return f.name == field.name && f.on == field.on;
  });
}

void add_once(std::vector<FieldChoice>& fields, FieldChoice field) {
  if (!contains(fields, field)) fields.push_back(std::move(field));
}

std::vector<FieldChoice> all_fields(World& world) {
  std::vector<FieldChoice> all = kernel_fields();
  for (FieldChoice& field : model_fields(world)) all.push_back(std::move(field));
  return all;
}

}  // namespace

const std::vector<FieldChoice>& kernel_fields() {
  static const std::vector<FieldChoice> fields{{"displacement", On::points, false, displacement},
                                               {"velocity", On::points, false, velocity},
                                               {"force", On::points, true, force},
                                               {"reaction", On::points, true, reaction},
                                               {"mass", On::points, false, mass},
                                               {"fixed", On::points, false, fixed},
                                               {"node_id", On::points, false, node_id},
                                               {"element_id", On::cells, false, element_id},
                                               {"island", On::cells, false, island, false, true},
                                               {"model", On::cells, false, model}};
  return fields;
}

std::vector<FieldChoice> model_fields(World& world) {
  std::vector<FieldChoice> fields;
  for (const auto& instance : world.attributes.instances()) {
    const suture_model& table = instance->model();
    for (const suture_functor& functor : std::span(table.functors, table.functor_count)) {
      const void* extension = functor.extension ? functor.extension(SUTURE_OUTPUT_1) : nullptr;
      const auto* output = static_cast<const suture_output_1*>(extension);
      if (output == nullptr || functor.dimension == 2) continue;
      for (std::uint32_t f = 0; f < output->field_count; ++f)
        add_once(fields, output_field(functor, output->fields[f]));
    }
    for (const suture_attribute& attribute : std::span(table.attributes, table.attribute_count)) {
      const bool shown =
          (attribute.flags & SUTURE_OUTPUT) != 0 && (attribute.flags & SUTURE_SHARED_MASS) == 0;
      if (shown && attribute.dimension != 2) add_once(fields, attribute_field(attribute));
    }
  }
  return fields;
}

std::vector<FieldChoice> choose_fields(World& world, const OutputOptions& options) {
  const std::vector<FieldChoice> all = all_fields(world);
  std::vector<FieldChoice> chosen;
  for (const std::string& name : options.fields) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const FieldChoice& f) {
      return f.name == name && f.on != On::springs;
    });
    if (found == all.end()) {
      std::vector<std::string> names;
      for (const FieldChoice& f : all) {
        if (f.on != On::springs) names.push_back(f.name);
      }
      std::string text = "/output/fields: no model of this scene gives '" + name + "'" +
                         did_you_mean(name, names) + "; there are";
      for (std::size_t i = 0; i < names.size(); ++i) text += (i ? ", " : " ") + names[i];
      throw InputError(text);
    }
    chosen.push_back(*found);
  }
  if (options.springs) {
    std::copy_if(all.begin(), all.end(), std::back_inserter(chosen),
                 [](const FieldChoice& f) { return f.on == On::springs; });
  }
  return chosen;
}

std::vector<FieldChoice> fields_besides(World& world, const std::vector<FieldChoice>& chosen) {
  std::vector<FieldChoice> others;
  for (FieldChoice& field : all_fields(world))
    if (!contains(chosen, field)) others.push_back(std::move(field));
  return others;
}

}  // namespace suture
