// SPDX-License-Identifier: GPL-3.0-or-later
//
// A plugin through the C contract alone, which nothing checks on its side: for some time it gives a
// number that is not finite, at one node of one element.
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>

#include "suture/declarations.hpp"
#include "suture/note.h"

namespace {

constexpr std::size_t lanes = SUTURE_LANES;

enum { what, element, node, component, from, lasts, value };
enum { in_force, in_energy, in_field, in_state };
constexpr const char* places[] = {"force", "energy", "field", "state"};
constexpr const char* values[] = {"nan", "inf", "-inf"};
constexpr suture_parameter parameters[] = {
    suture::choice("what", "Where the number is", places),
    suture::integer("element", "The element").at_least(0),
    suture::integer("node", "A node of a force").at_least(0).at_most(7),
    suture::integer("component", "Of a force").at_least(0).at_most(2),
    suture::number("from", "s", "When it begins").at_least(0),
    suture::number("lasts", "s", "For how long").at_least(0),
    suture::choice("value", "The number", values)};

double number(const suture_context* context) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const int which = static_cast<int>(context->parameters[value]);
  return which == 0 ? std::numeric_limits<double>::quiet_NaN() : which == 1 ? infinity : -infinity;
}

/// The place in out[place * lanes + lane] that is to be spoiled, or null.
double* spoiled(const suture_context* context, const suture_batch* batch, int kind, double* out,
                std::size_t place) {
  const double* p = context->parameters;
  const double since = batch->time - p[from];
  if (static_cast<int>(p[what]) != kind || since < 0 || since > p[lasts]) return nullptr;
  for (std::size_t lane = 0; lane < batch->valid; ++lane)
    if (batch->cell_ids[lane] == static_cast<std::uint32_t>(p[element]))
      return out + place * lanes + lane;
  return nullptr;
}

/// Sets all to `usual`, and one to the number that is not finite.
suture_status give(const suture_context* context, const suture_batch* batch, int kind, double* out,
                   std::size_t count, std::size_t place, double usual) {
  for (std::size_t i = 0; i < count * lanes; ++i) out[i] = usual;
  if (double* x = spoiled(context, batch, kind, out, place)) *x = number(context);
  return SUTURE_OK;
}

suture_status force(const suture_context* context, const suture_batch* batch) {
  const auto n = static_cast<std::size_t>(context->parameters[node]),
             c = static_cast<std::size_t>(context->parameters[component]);
  give(context, batch, in_state, batch->trial_columns[0], 1, 0, batch->time);
  return give(context, batch, in_force, batch->force, 24, 3 * n + c, 0);
}
suture_status energy(const suture_context* context, const suture_batch* batch, double* out) {
  return give(context, batch, in_energy, out, 1, 0, 0);
}
suture_status output(const suture_context* context, const suture_batch* batch,
                     double* const* fields) {
  return fields[0] ? give(context, batch, in_field, fields[0], 1, 0, 1) : SUTURE_OK;
}
suture_status tangent(const suture_context*, const suture_batch*, const double*, const double*,
                      double* df) {
  std::memset(df, 0, sizeof(double) * 24 * lanes);
  return SUTURE_OK;
}
suture_status bounds(const suture_context*, const suture_batch*, double* stiffness,
                     double* damping) {
  std::memset(stiffness, 0, sizeof(double) * 48 * lanes);
  std::memset(damping, 0, sizeof(double) * 48 * lanes);
  return SUTURE_OK;
}

constexpr suture_field fields[] = {suture::field("mark", "1", "1, if it is finite")};

const void* extension(const char* id) {
  static constexpr suture_energy_1 energies{sizeof(suture_energy_1), 0, energy};
  static constexpr suture_tangent_1 tangents{sizeof(suture_tangent_1), 0, tangent};
  static constexpr suture_stable_dt_1 stable{sizeof(suture_stable_dt_1), 0, bounds};
  static constexpr suture_output_1 outputs{sizeof(suture_output_1), 1, fields, output};
  if (id == std::string_view(SUTURE_ENERGY_1)) return &energies;
  if (id == std::string_view(SUTURE_TANGENT_1)) return &tangents;
  if (id == std::string_view(SUTURE_STABLE_DT_1)) return &stable;
  if (id == std::string_view(SUTURE_OUTPUT_1)) return &outputs;
  return nullptr;
}

constexpr suture_attribute attributes[] = {
    suture::volume_attribute("age", "s", "The time, as a state").copy().trial().output()};
constexpr std::uint32_t columns[] = {0};

constexpr suture_functor functor() {
  suture_functor f{};
  f.size = sizeof(suture_functor);
  f.dimension = 3;
  f.cell_type = SUTURE_HEXAHEDRON;
  f.shape = SUTURE_ANY_SHAPE;
  f.lanes = lanes;
  f.reads = SUTURE_READ_POSITION;
  f.name = "nothing";
  f.doc = "no force, but for one";
  f.force = force;
  f.extension = extension;
  f.cell_column_count = 1;
  f.cell_columns = columns;
  return f;
}
constexpr suture_functor functors[] = {functor()};

constexpr suture_model model() {
  suture_model m{};
  m.size = sizeof(suture_model);
  m.id = "not-finite";
  m.doc = "A number that is not finite";
  m.formula = "f = 0";
  m.citation = "none";
  m.parameter_count = 7;
  m.attribute_count = 1;
  m.functor_count = 1;
  m.parameters = parameters;
  m.attributes = attributes;
  m.functors = functors;
  return m;
}
constexpr suture_model models[] = {model()};

const suture_plugin plugin = {sizeof(suture_plugin),
                              SUTURE_MAGIC,
                              SUTURE_ABI_MAJOR,
                              SUTURE_ABI_MINOR,
                              lanes,
                              1,
                              "not-finite",
                              "1.0",
                              "GPL-3.0-or-later",
                              "Numbers not finite",
                              models,
                              0,
                              0,
                              nullptr};

}  // namespace

SUTURE_NOTE("not-finite", "not-finite")
extern "C" __attribute__((visibility("default"))) const suture_plugin* suture_plugin_v1(void) {
  return &plugin;
}
