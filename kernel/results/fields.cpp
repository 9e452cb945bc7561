// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/results/fields.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/base/error.hpp"
#include "kernel/base/escape.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/base/zeroed_vector.hpp"
#include "kernel/dynamics/hourglass.hpp"
#include "kernel/dynamics/motion.hpp"
#include "kernel/forces/contact_law.hpp"
#include "kernel/plugin_host/output_fields.hpp"
#include "kernel/results/tensor_fields.hpp"

namespace suture {
namespace {

using On = FieldChoice::On;

// value(built, gravity, vertex, component): three components of each vertex.
template <class Value>
FieldChoice vertex_vector(std::string name, std::string unit, bool needs_force, Value value) {
  FieldChoice field{std::move(name), On::points, needs_force, {}};
  field.components = 3;
  field.unit = std::move(unit);
  field.value = value;
  field.fill = [value](const FieldRequest& at, FrameField& out) {
    const ShownCells vertices = at.vertices();
    out.components = 3;
    out.values.resize(std::size_t{3} * vertices.size());
    for (Index i = 0; i < vertices.size(); ++i) {
      for (int a = 0; a < 3; ++a)
        out.values[std::size_t{3} * i + static_cast<std::size_t>(a)] =
            value(at.built, at.gravity, vertices[i], a);
    }
  };
  return field;
}

// column(built): one value of each vertex.
template <class ColumnOf>
FieldChoice vertex_column(std::string name, std::string unit, int components, ColumnOf column) {
  FieldChoice field{std::move(name), On::points, false, {}};
  field.unit = std::move(unit);
  field.components = components;
  field.value = [column](BuiltScene& built, const Vec3&, Index v, int c) {
    return column(built).get(v, c);
  };
  field.fill = [column, components](const FieldRequest& at, FrameField& out) {
    const Column& values = column(at.built);
    const ShownCells vertices = at.vertices();
    out.components = components;
    out.values.clear();
    for (Index i = 0; i < vertices.size(); ++i)
      for (int c = 0; c < components; ++c) out.values.push_back(values.get(vertices[i], c));
  };
  return field;
}

// value(built, cell): a whole number of each vertex or element.
template <class Value>
FieldChoice integers(std::string name, On on, Value value) {
  FieldChoice field{std::move(name), on, false, {}};
  field.value = [value](BuiltScene& built, const Vec3&, Index cell, int) {
    return static_cast<double>(value(built, cell));
  };
  field.fill = [value, on](const FieldRequest& at, FrameField& out) {
    const ShownCells cells = on == On::points ? at.vertices() : at.elements();
    out.components = 1;
    out.ids.resize(cells.size());
    for (Index i = 0; i < cells.size(); ++i)
      out.ids[i] = static_cast<std::int64_t>(value(at.built, cells[i]));
  };
  return field;
}

double displacement(BuiltScene& built, const Vec3&, Index v, int a) {
  return built.body().attributes().position().get(v, a) -
         built.body().attributes().rest().get(v, a);
}

double velocity(BuiltScene& built, const Vec3&, Index v, int a) {
  return built.body().attributes().velocity().get(v, a);
}

// f = f_int + loads + m g
double total_force(BuiltScene& built, const Vec3& gravity, Index v, int a) {
  return built.body().attributes().force().get(v, a) +
         built.body().attributes().mass().get(v, 0) * gravity[static_cast<std::size_t>(a)];
}

// What the support gives: the opposite of the force, in constrained directions.
double reaction(BuiltScene& built, const Vec3& gravity, Index v, int a) {
  const bool held = (static_cast<int>(built.body().attributes().fixed().get(v, 0)) >> a & 1) != 0;
  return held ? -total_force(built, gravity, v, a) : 0.0;
}

// x X reaction, about the origin of the scene's coordinates.
double reaction_moment(BuiltScene& built, const Vec3& gravity, Index v, int a) {
  const Column& x = built.body().attributes().position();
  const Vec3& origin = built.frame().origin;
  const int b = (a + 1) % 3, c = (a + 2) % 3;
  const auto arm = [&](int i) { return x.get(v, i) + origin[static_cast<std::size_t>(i)]; };
  return arm(b) * reaction(built, gravity, v, c) - arm(c) * reaction(built, gravity, v, b);
}

FieldChoice element_id() {
  FieldChoice field = integers("element_id", On::cells,
                               [](BuiltScene& built, Index e) { return built.element_name(e); });
  field.fill = [fill = field.fill](const FieldRequest& at, FrameField& out) {
    out.global_ids = true;
    fill(at, out);
  };
  return field;
}

FieldChoice island() {
  return integers("island", On::cells,
                  [](BuiltScene& built, Index e) { return built.body().islands().of(e); });
}

// Alternating part of the deformation over strain.
FieldChoice hourglass() {
  FieldChoice field{"hourglass", On::cells, false, {}};
  field.from = FieldChoice::From::all;
  field.fill = [](const FieldRequest& at, FrameField& out) {
    const Hourglass found = measure_hourglass(at.complex(), at.attributes());
    out.components = 1;
    out.values.resize(at.complex().element_count());
    for (Index e = 0; e < at.complex().element_count(); ++e) out.values[e] = found.content(e);
  };
  return field;
}

// The force of the last step.
void contact_force(const FieldRequest& at, FrameField& field) {
  const ShownCells vertices = at.vertices();
  field.components = 3;
  field.values.assign(std::size_t{3} * vertices.size(), 0);
  for (const ContactLaw::Touch& touch : at.built.body().contact()->touches())
    if (const Index place = vertices.place(touch.vertex); place != none)
      std::ranges::copy(touch.force, field.values.begin() + std::ptrdiff_t{3} * place);
}

void gap(const FieldRequest& at, FrameField& field) {
  const std::vector<double> gaps = at.built.body().contact()->gaps(at.time);
  const ShownCells vertices = at.vertices();
  field.components = 1;
  field.values.resize(vertices.size());
  for (Index i = 0; i < vertices.size(); ++i) field.values[i] = gaps[vertices[i]];
}

void model(const FieldRequest& at, FrameField& field) {
  const ShownCells elements = at.elements();
  field.components = 1;
  field.ids.resize(elements.size());
  std::int64_t number = 0;
  for (const auto& instance : at.attributes().instances()) {
    const CellSet& cells = instance->table(3).cells;
    for (Index row = 0; row < cells.size(); ++row)
      if (const Index place = elements.place(cells.cell(row)); place != none)
        field.ids[place] = number;
    ++number;
  }
}

bool is_by_row(int dimension) { return dimension == 1 || dimension == 2; }

// Springs and faces instance after instance in the order of their rows, elements and vertices by
// number.
std::size_t frame_size(const FieldRequest& at, int dimension) {
  if (!is_by_row(dimension)) return dimension == 0 ? at.vertices().size() : at.elements().size();
  std::size_t rows = 0;
  for (const auto& instance : at.attributes().instances())
    rows += instance->table(dimension).cells.size();
  return rows;
}

/// visit(row, place) for the rows of an instance whose cells are shown, and their places in the
/// field. `before`: rows of the instances before this one.
template <class Visit>
void for_each_place(const FieldRequest& at, const Table& table, std::size_t before, Visit visit) {
  const int dimension = table.dimension;
  if (is_by_row(dimension)) {
    for (Index row = 0; row < table.cells.size(); ++row)
      if (has_cell(at.complex(), table, row)) visit(row, before + row);
    return;
  }
  const ShownCells cells = dimension == 0 ? at.vertices() : at.elements();
  for (Index place = 0; place < cells.size(); ++place)
    if (at.complex().exists(dimension, cells[place]))
      if (const Index row = table.cells.row(cells[place]); row != none) visit(row, place);
}

// values(instance, rows): components per row of the instance's table, those that are shown.
template <class Values>
void gather_instances(const FieldRequest& at, int dimension, int components, FrameField& field,
                      Values values) {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  const auto width = static_cast<std::size_t>(components);
  field.components = components;
  field.values.assign(frame_size(at, dimension) * width, nothing);
  std::size_t rows = 0;  // of the instances before
  for (const auto& instance : at.attributes().instances()) {
    const Table& table = instance->table(dimension);
    ZeroedVector<double> of_rows(table.cells.size() * width);
    for_each_place(at, table, rows, [&](Index row, std::size_t) {
      std::fill_n(of_rows.data() + row * width, width, nothing);
    });
    if (values(*instance, std::span<double>(of_rows)))
      for_each_place(at, table, rows, [&](Index row, std::size_t place) {
        std::copy_n(of_rows.data() + row * width, width, field.values.data() + place * width);
      });
    rows += table.cells.size();
  }
}

On place_of(std::uint32_t dimension) {
  constexpr On places[] = {On::points, On::springs, On::faces, On::cells};
  return places[dimension];
}

std::string unit_of(const char* text) { return text == nullptr ? "1" : text; }

FieldChoice output_field(const suture_functor& functor, const suture_field& field) {
  const int dimension = static_cast<int>(functor.dimension),
            components = static_cast<int>(field.components);
  const std::string name = field.name;
  return {name,
          place_of(functor.dimension),
          false,
          [=](const FieldRequest& at, FrameField& out) {
            gather_instances(at, dimension, components, out,
                             [&](Instance& instance, std::span<double> rows) {
                               return at.built.body().models().compute_field(
                                   instance, dimension, name, at.time, rows, at.wanted(dimension));
                             });
          },
          true,
          components,
          false,
          unit_of(field.unit)};
}

FieldChoice attribute_field(const suture_attribute& attribute) {
  const int dimension = static_cast<int>(attribute.dimension),
            components = static_cast<int>(attribute.components);
  const std::string name = attribute.name;
  return {name,
          place_of(attribute.dimension),
          false,
          [=](const FieldRequest& at, FrameField& out) {
            gather_instances(
                at, dimension, components, out, [&](Instance& instance, std::span<double> rows) {
                  const Column* column = instance.table(dimension).find(name);
                  if (column == nullptr) return false;
                  const auto width = static_cast<std::size_t>(components);
                  const auto copy = [&](Index row, std::size_t) {
                    for (std::size_t c = 0; c < width; ++c)
                      rows[row * width + c] = column->get(row, static_cast<int>(c));
                  };
                  for_each_place(at, instance.table(dimension), 0, copy);
                  if (!std::ranges::all_of(rows, [](double x) { return std::isfinite(x); }))
                    throw NotFinite("attribute " + quote(name) + " of model " +
                                    quote(instance.name()) + " has a value that is not finite");
                  return true;
                });
          },
          false,
          components,
          false,
          unit_of(attribute.unit)};
}

bool contains(const std::vector<FieldChoice>& fields, const FieldChoice& field) {
  return std::any_of(fields.begin(), fields.end(), [&](const FieldChoice& f) {
    return f.name == field.name && f.on == field.on;
  });
}

/// Fields of one name on the same cells are one array. Throws PluginError if they differ in width.
void add_once(std::vector<FieldChoice>& fields, FieldChoice field) {
  const auto same = std::ranges::find_if(
      fields, [&](const FieldChoice& f) { return f.name == field.name && f.on == field.on; });
  if (same == fields.end()) {
    fields.push_back(std::move(field));
  } else if (same->components != field.components) {
    throw PluginError("the models of this scene have fields " + quote(field.name) + " of " +
                      std::to_string(same->components) + " and of " +
                      std::to_string(field.components) +
                      " components; one array cannot hold both, use only one of these models");
  }
}

}  // namespace

std::vector<std::string> component_names(const FieldChoice& field) {
  if (field.principal) return {"1", "2", "3"};
  switch (field.components) {
    case 1:
      return {""};
    case 3:
      return {"x", "y", "z"};
    case 6:
      return {"xx", "yy", "zz", "xy", "yz", "xz"};
    default:
      std::vector<std::string> names;
      for (int c = 0; c < field.components; ++c) names.push_back(std::to_string(c));
      return names;
  }
}

const std::vector<FieldChoice>& kernel_fields() {
  static const std::vector<FieldChoice> fields{
      vertex_vector("displacement", "m", false, displacement),
      vertex_vector("velocity", "m/s", false, velocity),
      vertex_vector("force", "N", true, total_force),
      vertex_vector("reaction", "N", true, reaction),
      vertex_vector("reaction_moment", "N m", true, reaction_moment),
      vertex_column(
          "mass", "kg", 1,
          [](BuiltScene& built) -> const Column& { return built.body().attributes().mass(); }),
      vertex_column(
          "fixed", "1", 1,
          [](BuiltScene& built) -> const Column& { return built.body().attributes().fixed(); }),
      integers("node_id", On::points,
               [](BuiltScene& built, Index v) {
                 return built.names().point_id(built.body().user_vertex()[v]);
               }),
      element_id(),
      island(),
      {"model", On::cells, false, model},
      hourglass()};
  return fields;
}

std::vector<FieldChoice> model_fields(BuiltScene& built) {
  std::vector<FieldChoice> fields;
  for (const auto& instance : built.body().attributes().instances()) {
    const suture_model& table = instance->model();
    for (const suture_functor& functor : std::span(table.functors, table.functor_count)) {
      for (const suture_field& field : output_fields(functor))
        add_once(fields, output_field(functor, field));
    }
    for (const suture_attribute& attribute : std::span(table.attributes, table.attribute_count)) {
      if (is_shown(attribute) && !is_of_kernel(attribute))
        add_once(fields, attribute_field(attribute));
    }
  }
  for (const VertexField& field : built.body().attributes().fields())
    add_once(fields, vertex_column(
                         field.name, field.unit,
                         field.values->spec().components, [&field](BuiltScene&) -> auto& {
                           return *field.values;
                         }));
  return fields;
}

std::vector<FieldChoice> fields_of_contact() {
  return {{"contact_force", On::points, false, contact_force, false, 3, false, "N"},
          {"gap", On::points, false, gap, false, 1, false, "m"}};
}

std::vector<FieldChoice> all_fields(BuiltScene& built) {
  std::vector<FieldChoice> all = kernel_fields();
  if (built.body().contact())
    for (FieldChoice& field : fields_of_contact()) all.push_back(std::move(field));
  const std::vector<FieldChoice> models = model_fields(built);
  all.insert(all.end(), models.begin(), models.end());
  for (const std::vector<FieldChoice>& tensors : {strain_fields(), fields_of_stress(models)}) {
    std::ranges::copy_if(tensors, std::back_inserter(all), [&](const FieldChoice& field) {
      return std::ranges::none_of(
          models, [&](const FieldChoice& f) { return f.name == field.name && is_in_frames(f); });
    });
  }
  return all;
}

bool is_in_frames(const FieldChoice& field) {
  return field.on == On::points || field.on == On::cells;
}

const FieldChoice& field_named(const std::vector<FieldChoice>& fields, const std::string& name,
                               const std::string& path) {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const FieldChoice& f) {
    return f.name == name && is_in_frames(f);
  });
  if (found != fields.end()) return *found;
  std::vector<std::string> names;
  for (const FieldChoice& f : fields) {
    if (is_in_frames(f)) names.push_back(f.name);
  }
  std::string text = path + ": no model of this scene provides the field " + quote(name) +
                     did_you_mean(name, names);
  for (std::size_t i = 0; i < names.size(); ++i) text += (i ? ", " : "; available: ") + names[i];
  throw InputError(text);
}

std::vector<FieldChoice> choose_fields(BuiltScene& built, const OutputOptions& options) {
  const std::vector<FieldChoice> all = all_fields(built);
  std::vector<FieldChoice> chosen;
  for (const std::string& name : options.fields)
    chosen.push_back(field_named(all, name, "/output/fields"));
  std::ranges::copy_if(all, std::back_inserter(chosen), [&](const FieldChoice& f) {
    return (f.on == On::springs && options.springs) || (f.on == On::faces && options.faces);
  });
  return chosen;
}

void fill_fields(const std::vector<FieldChoice>& choices, FieldChoice::On on,
                 const FieldRequest& request, std::vector<FrameField>& fields) {
  std::size_t used = 0;
  for (const FieldChoice& choice : choices) {
    if (choice.on != on) continue;
    if (used == fields.size()) fields.emplace_back();
    FrameField& field = fields[used++];
    field.name = choice.name;
    field.principal = choice.principal;
    choice.fill(request, field);
  }
  fields.resize(used);
}

std::vector<FieldChoice> fields_besides(BuiltScene& built, const std::vector<FieldChoice>& chosen) {
  std::vector<FieldChoice> others;
  for (FieldChoice& field : all_fields(built))
    if (!contains(chosen, field)) others.push_back(std::move(field));
  return others;
}

}  // namespace suture
