// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/table_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

#include "kernel/base/nearest.hpp"
#include "kernel/plugin_host/host_extensions.hpp"
#include "kernel/plugin_host/plugin_call.hpp"
#include "kernel/plugin_host/table_entry.hpp"
#include "suture/lips.h"

namespace suture {
namespace {

std::string number(double value) {
  std::string out = std::to_string(value);
  out.erase(out.find_last_not_of('0') + 1);
  if (!out.empty() && out.back() == '.') out.pop_back();
  return out;
}

/// Lower-case letter, then lower-case letters, digits and '-'.
bool is_id(std::string_view text) {
  const auto good = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
  };
  if (text.empty() || text.front() < 'a' || text.front() > 'z') return false;
  for (const char c : text)
    if (!good(c)) return false;
  return true;
}

void check_id(const Entry& entry, const char* id) {
  entry.require(id != nullptr && is_id(id),
                "its id is " + (id == nullptr ? "NULL" : "'" + std::string(id) + "'") +
                    "; expected lower-case letters, digits and '-', a letter first");
}

// ---------------------------------------------------------------- parameters --

void check_choices(const Entry& entry, const suture_parameter& p) {
  if (p.type != SUTURE_CHOICE) {
    entry.require(p.choice_count == 0, "has choices, but its type is not SUTURE_CHOICE");
    return;
  }
  if (!entry.require(p.choice_count > 0, "has type SUTURE_CHOICE but no choices") ||
      !entry.array(p.choices, p.choice_count, "choices"))
    return;
  Names names;
  for (std::uint32_t i = 0; i < p.choice_count; ++i) {
    const char* choice = p.choices[i];
    if (entry.require(choice != nullptr && *choice != '\0',
                      "choice " + std::to_string(i) + " is empty or NULL"))
      names.unique(entry.inner("choice", choice, i), choice, "choice");
  }
}

void check_range(const Entry& entry, const suture_parameter& p) {
  const bool open = (p.flags & (SUTURE_MINIMUM_EXCLUDED | SUTURE_MAXIMUM_EXCLUDED)) != 0;
  entry.require(open ? p.minimum < p.maximum : p.minimum <= p.maximum,
                "its range from " + number(p.minimum) + " to " + number(p.maximum) + " is empty");
}

void check_default(const Entry& entry, const suture_parameter& p) {
  if ((p.flags & SUTURE_REQUIRED) != 0) return;
  const double value = p.default_value;
  const std::string its = "its default " + number(value);
  if (p.type == SUTURE_BOOLEAN)
    entry.require(value == 0.0 || value == 1.0, its + " is neither 0 nor 1");
  if (p.type == SUTURE_CHOICE)
    entry.require(value >= 0.0 && value < p.choice_count && value == std::floor(value),
                  its + " is not an index into its choices");
  if (p.type == SUTURE_INTEGER)
    entry.require(value == std::floor(value), its + " is not an integer");
  if (p.type > SUTURE_INTEGER) return;
  const bool above = (p.flags & SUTURE_MINIMUM_EXCLUDED) ? value > p.minimum : value >= p.minimum;
  const bool below = (p.flags & SUTURE_MAXIMUM_EXCLUDED) ? value < p.maximum : value <= p.maximum;
  entry.require(
      above && below && std::isfinite(value),
      its + " is outside its range from " + number(p.minimum) + " to " + number(p.maximum));
}

bool holds_values_of(const suture_attribute& a, const suture_parameter& p) {
  return (a.flags & SUTURE_PARAMETER) != 0 && a.name != nullptr && p.name != nullptr &&
         std::string_view(a.name) == p.name;
}

void check_per_element(const Entry& entry, const suture_model& m, const suture_parameter& p) {
  const bool is_direction = p.type == SUTURE_DIRECTION;
  const bool varies = (p.flags & SUTURE_PER_ELEMENT) != 0;
  entry.require(!is_direction || (varies && (p.flags & SUTURE_REQUIRED) != 0),
                "has type SUTURE_DIRECTION, but not both flags SUTURE_PER_ELEMENT and "
                "SUTURE_REQUIRED");
  if (!varies) return;
  entry.require(is_direction || p.type == SUTURE_NUMBER,
                "has SUTURE_PER_ELEMENT, which only numbers and directions can have");
  const std::uint32_t components = is_direction ? 3 : 1;
  for (std::uint32_t i = 0; i < m.attribute_count; ++i) {
    const suture_attribute& a = m.attributes[i];
    if (holds_values_of(a, p) && a.dimension == 3 && a.components == components) return;
  }
  entry.require(false,
                "has SUTURE_PER_ELEMENT, but the model has no attribute of this name with "
                "SUTURE_PARAMETER, dimension 3 and components " +
                    std::to_string(components));
}

void check_parameters(const Entry& model, const suture_model& m) {
  Names names;
  for (std::uint32_t i = 0; i < m.parameter_count; ++i) {
    const suture_parameter& p = m.parameters[i];
    const Entry entry = model.inner("parameter", p.name, i);
    names.check(entry, p.name);
    entry.text(p.unit, "unit");
    entry.text(p.doc, "doc");
    entry.known(p.type, SUTURE_DIRECTION, "type");
    entry.known_bits(
        p.flags,
        SUTURE_REQUIRED | SUTURE_MINIMUM_EXCLUDED | SUTURE_MAXIMUM_EXCLUDED | SUTURE_PER_ELEMENT,
        "flags");
    check_per_element(entry, m, p);
    check_choices(entry, p);
    if (p.type == SUTURE_NUMBER || p.type == SUTURE_INTEGER) check_range(entry, p);
    check_default(entry, p);
  }
}

// ---------------------------------------------------------------- attributes --

void check_policy(const Entry& entry, const suture_attribute& a) {
  entry.known(a.policy, SUTURE_FROM_VOLUMES, "policy");
  const bool summed = a.policy == SUTURE_FROM_VOLUMES;
  entry.require(!summed || a.contribution_count > 0,
                "has policy SUTURE_FROM_VOLUMES, but no contribution");
  entry.require(summed || a.contribution_count == 0,
                "has a contribution, but not policy SUTURE_FROM_VOLUMES");
  entry.require(!summed || (a.flags & SUTURE_TRIAL) == 0,
                "has both a trial copy and policy SUTURE_FROM_VOLUMES, which exclude each other");
  if ((a.flags & SUTURE_SHARED_MASS) != 0)
    entry.require(a.dimension == 0 && a.components == 1 && summed,
                  "has SUTURE_SHARED_MASS: expected dimension 0, 1 component and policy "
                  "SUTURE_FROM_VOLUMES");
}

constexpr std::uint32_t other_uses =
    SUTURE_TRIAL | SUTURE_SHARED_MASS | SUTURE_PARAMETER | SUTURE_FROM_PARAMETERS;
constexpr std::uint32_t uses_of_field = SUTURE_CAPACITY | SUTURE_RELAXATION | SUTURE_FIELD_RATE;

/// An attribute of the field that is declared last before it, of which a field has one.
void check_of_field(const Entry& entry, const suture_model& m, std::uint32_t place,
                    std::uint32_t flag, const std::string& name) {
  const suture_attribute& a = m.attributes[place];
  if ((a.flags & flag) == 0) return;
  const bool is_sum = flag != SUTURE_FIELD_RATE;
  std::uint32_t before = place;
  while (before > 0 && (m.attributes[before - 1].flags & (SUTURE_FIELD | flag)) == 0) --before;
  if (!entry.require(
          before > 0 && (m.attributes[before - 1].flags & SUTURE_FIELD) != 0,
          "has " + name + ", but no field (SUTURE_FIELD) stands before it that has none yet"))
    return;
  const std::uint32_t components = is_sum ? 1 : m.attributes[before - 1].components;
  entry.require(a.dimension == 0 && a.components == components &&
                    a.policy == (is_sum ? SUTURE_FROM_VOLUMES : SUTURE_COPY) &&
                    (a.flags & (other_uses | SUTURE_FIELD | uses_of_field) & ~flag) == 0,
                "has " + name + ": expected dimension 0, " + std::to_string(components) +
                    (components == 1 ? " component" : " components") + ", policy " +
                    (is_sum ? "SUTURE_FROM_VOLUMES" : "SUTURE_COPY") +
                    " and neither a trial copy nor another use");
}

/// The values that a scene may give; both 0: any.
void check_range(const Entry& entry, const suture_attribute& a) {
  if (!has_range(a)) return;
  if (!entry.require((a.flags & SUTURE_FIELD) != 0, "has a range without SUTURE_FIELD")) return;
  entry.require(a.minimum < a.maximum, "its minimum is not below its maximum");
  entry.require(!(a.initial < a.minimum || a.initial > a.maximum),
                "its initial value lies outside of its range");
}

/// An unknown on vertices, and what belongs to it.
void check_field(const Entry& entry, const suture_model& m, std::uint32_t place) {
  const suture_attribute& a = m.attributes[place];
  if ((a.flags & SUTURE_FIELD) != 0)
    entry.require(a.dimension == 0 && a.components <= 3 && a.policy == SUTURE_COPY &&
                      (a.flags & (other_uses | uses_of_field)) == 0,
                  "has SUTURE_FIELD: expected dimension 0, 1 to 3 components, policy SUTURE_COPY "
                  "and "
                  "neither a trial copy nor another use");
  else
    entry.require((a.flags & SUTURE_RISING) == 0, "has SUTURE_RISING without SUTURE_FIELD");
  check_range(entry, a);
  check_of_field(entry, m, place, SUTURE_CAPACITY, "SUTURE_CAPACITY");
  check_of_field(entry, m, place, SUTURE_RELAXATION, "SUTURE_RELAXATION");
  check_of_field(entry, m, place, SUTURE_FIELD_RATE, "SUTURE_FIELD_RATE");
}

/// One for each type of 3-cell of this host, which has hexahedra.
void check_contributions(const Entry& entry, const suture_attribute& a) {
  for (std::uint32_t i = 0; i < a.contribution_count; ++i) {
    const suture_contribution& c = a.contributions[i];
    const Entry inner = entry.inner("contribution", nullptr, i);
    inner.require(c.function != nullptr, "its function is NULL");
    inner.require(c.cell_type == SUTURE_HEXAHEDRON,
                  "its cell_type is " + std::to_string(c.cell_type) + ", expected " +
                      std::to_string(SUTURE_HEXAHEDRON) +
                      " (SUTURE_HEXAHEDRON): bodies of this Suture have no other 3-cells");
    inner.require(i == 0 || c.cell_type != a.contributions[0].cell_type,
                  "is a second one for the same cell_type");
  }
}

void check_parameter_flags(const Entry& entry, const suture_model& m, const suture_attribute& a) {
  if ((a.flags & SUTURE_PARAMETER) != 0) {
    const std::span parameters(m.parameters, m.parameter_count);
    entry.require(std::ranges::any_of(parameters,
                                      [&](const suture_parameter& p) {
                                        return holds_values_of(a, p) &&
                                               (p.flags & SUTURE_PER_ELEMENT) != 0;
                                      }),
                  "has SUTURE_PARAMETER, but no parameter of this name has SUTURE_PER_ELEMENT");
    entry.require(a.policy == SUTURE_COPY && (a.flags & SUTURE_TRIAL) == 0,
                  "has SUTURE_PARAMETER: expected policy SUTURE_COPY and no trial copy");
  }
  if ((a.flags & SUTURE_FROM_PARAMETERS) != 0)
    entry.require(a.dimension == 3 && a.policy == SUTURE_FROM_VOLUMES,
                  "has SUTURE_FROM_PARAMETERS: expected dimension 3 and policy "
                  "SUTURE_FROM_VOLUMES");
}

void check_attributes(const Entry& model, const suture_model& m) {
  Names names;
  for (std::uint32_t i = 0; i < m.attribute_count; ++i) {
    const suture_attribute& a = m.attributes[i];
    const Entry entry = model.inner("attribute", a.name, i);
    names.check(entry, a.name);
    entry.text(a.unit, "unit");
    entry.text(a.doc, "doc");
    entry.known(a.dimension, 3, "dimension");
    entry.require(a.components >= 1 && a.components <= 9,
                  "has " + std::to_string(a.components) + " components, expected 1 to 9");
    entry.known_bits(a.flags,
                     SUTURE_OUTPUT | SUTURE_TRIAL | SUTURE_SHARED_MASS | SUTURE_PARAMETER |
                         SUTURE_FROM_PARAMETERS | SUTURE_INTERNAL | SUTURE_FIELD | SUTURE_CAPACITY |
                         SUTURE_RISING | SUTURE_RELAXATION | SUTURE_FIELD_RATE,
                     "flags");
    check_field(entry, m, i);
    check_parameter_flags(entry, m, a);
    entry.require(std::isfinite(a.initial), "its initial value is not finite");
    check_policy(entry, a);
    check_contributions(entry, a);
  }
}

// ------------------------------------------------------------------ functors --

void check_column(const Entry& entry, const suture_model& m, std::uint32_t column,
                  std::uint32_t dimension, const char* which) {
  const std::string its = std::string("its ") + which + " column " + std::to_string(column);
  if (!entry.require(column < m.attribute_count, its + " is not an attribute: the model has " +
                                                     std::to_string(m.attribute_count)))
    return;
  const suture_attribute& a = m.attributes[column];
  entry.require(a.dimension == dimension, its + " is an attribute of dimension " +
                                              std::to_string(a.dimension) + ", expected " +
                                              std::to_string(dimension));
  entry.require((a.flags & SUTURE_SHARED_MASS) == 0,
                its +
                    " has SUTURE_SHARED_MASS and is therefore not a column; use the vertex column "
                    "UINT32_MAX for the vertex mass");
  entry.require((a.flags & SUTURE_CAPACITY) == 0,
                its + " has SUTURE_CAPACITY, which no functor reads");
  entry.require((a.flags & SUTURE_RELAXATION) == 0,
                its + " has SUTURE_RELAXATION, which no functor reads");
}

/// A functor that changes a field.
void check_rate(const Entry& entry, const suture_model& m, const suture_functor& f) {
  if (f.field == 0) return;
  if (!entry.require(
          f.field <= m.attribute_count && (m.attributes[f.field - 1].flags & SUTURE_FIELD) != 0,
          "its field is " + std::to_string(f.field) +
              ", expected 0 or 1 + the index of an attribute with SUTURE_FIELD"))
    return;
  entry.require(extension_of<suture_tangent_1>(f, SUTURE_TANGENT_1) != nullptr,
                "changes a field, but has no suture.tangent/1");
  for (std::uint32_t i = 0; i < f.cell_column_count; ++i)
    entry.require(f.cell_columns[i] >= m.attribute_count ||
                      (m.attributes[f.cell_columns[i]].flags & SUTURE_TRIAL) == 0,
                  "changes a field, and writes a state (SUTURE_TRIAL), which is not supported");
}

void check_columns(const Entry& entry, const suture_model& m, const suture_functor& f,
                   bool on_parts) {
  if (entry.array(f.cell_columns, f.cell_column_count, "cell_columns"))
    for (std::uint32_t i = 0; i < f.cell_column_count; ++i)
      if (!on_parts || f.cell_columns[i] != (f.shape == SUTURE_GENERAL ? SUTURE_GENERAL_PART_COLUMN
                                                                       : SUTURE_PART_COLUMN))
        check_column(entry, m, f.cell_columns[i], f.dimension, "cell");
  if (entry.array(f.vertex_columns, f.vertex_column_count, "vertex_columns"))
    for (std::uint32_t i = 0; i < f.vertex_column_count; ++i)
      if (f.vertex_columns[i] != std::numeric_limits<std::uint32_t>::max())
        check_column(entry, m, f.vertex_columns[i], 0, "vertex");
}

void check_cells(const Entry& entry, const suture_functor& f) {
  constexpr std::uint32_t type_of[4] = {SUTURE_VERTEX, SUTURE_EDGE, SUTURE_QUADRILATERAL,
                                        SUTURE_HEXAHEDRON};
  if (!entry.require(f.dimension <= 3,
                     "its dimension is " + std::to_string(f.dimension) + ", expected 0 to 3"))
    return;
  const bool on_lips = f.cell_type == SUTURE_LIPS && f.dimension == 2;
  entry.require(f.cell_type == type_of[f.dimension] || on_lips,
                "its cell_type is " + std::to_string(f.cell_type) + ", expected " +
                    std::to_string(type_of[f.dimension]) + " with dimension " +
                    std::to_string(f.dimension));
  entry.known(f.shape, SUTURE_GENERAL, "shape");
  entry.known(f.faces, SUTURE_INTERIOR_FACES, "faces");
  entry.require(f.dimension == 3 || f.shape == SUTURE_ANY_SHAPE,
                "names a shape, which only cells of dimension 3 have");
  entry.require((f.dimension == 2 && !on_lips) || f.faces == SUTURE_ALL_FACES,
                "names a set of faces, but its dimension is not 2, or its cells are lips");
}

void check_functors(const Entry& model, const suture_model& m) {
  model.require(m.functor_count > 0, "has no functor");
  Names names;
  for (std::uint32_t i = 0; i < m.functor_count; ++i) {
    const suture_functor& f = m.functors[i];
    const Entry entry = model.inner("functor", f.name, i);
    if (f.name != nullptr) names.unique(entry, f.name, "name");
    check_functor(entry, m, f);
  }
}

// -------------------------------------------------------------------- plugin --

void check_model(const Entry& entry, const suture_model& m) {
  check_id(entry, m.id);
  entry.text(m.doc, "doc");
  entry.text(m.formula, "formula");
  entry.text(m.citation, "citation");
  entry.known_bits(m.flags, SUTURE_CONTINUUM | SUTURE_LINEAR | SUTURE_ACTIVE, "flags");
  entry.reserved(m.reserved);
  entry.require(m.instance_bytes == 0 || m.prepare != nullptr,
                "requests instance_bytes, but has no function prepare to fill them");
  entry.require(m.instance_bytes < (std::uint64_t{1} << 30),
                "requests 1 GiB or more of instance_bytes");
  check_parameters(entry, m);
  check_attributes(entry, m);
  check_functors(entry, m);
}

void check_extensions(const Entry& entry, const suture_plugin& plugin) {
  if (!entry.array(plugin.required_extensions, plugin.required_extension_count,
                   "required_extensions"))
    return;
  const std::vector<std::string> known(host_extensions.begin(), host_extensions.end());
  for (std::uint32_t i = 0; i < plugin.required_extension_count; ++i) {
    const char* id = plugin.required_extensions[i];
    if (!entry.require(id != nullptr, "required extension " + std::to_string(i) + " is NULL"))
      continue;
    entry.require(host_has_extension(id), "requires the host's extension '" + std::string(id) +
                                              "', which this Suture does not have" +
                                              did_you_mean(id, known) + "; use a newer Suture");
  }
}

}  // namespace

void check_functor(const Entry& entry, const suture_model& m, const suture_functor& f,
                   bool on_parts) {
  entry.text(f.name, "name");
  entry.text(f.doc, "doc");
  entry.require(f.force != nullptr, "its function force is NULL");
  entry.require(f.lanes == SUTURE_LANES, "is written for " + std::to_string(f.lanes) +
                                             " lanes, this host has " +
                                             std::to_string(SUTURE_LANES));
  entry.known(f.scalar, 0, "scalar");
  entry.known_bits(f.reads, SUTURE_READ_REST | SUTURE_READ_POSITION | SUTURE_READ_VELOCITY,
                   "reads");
  entry.reserved(f.reserved);
  check_cells(entry, f);
  check_columns(entry, m, f, on_parts);
  entry.reserved(f.reserved_2);
  check_rate(entry, m, f);
}

std::vector<std::string> table_problems(const suture_plugin& plugin) {
  std::vector<std::string> problems;
  const Entry entry(problems, "");
  check_id(entry, plugin.id);
  entry.text(plugin.version, "version");
  entry.text(plugin.license, "license");
  entry.text(plugin.description, "description");
  check_extensions(entry, plugin);
  entry.require(plugin.model_count > 0, "has no model");
  Names ids;
  for (std::uint32_t i = 0; i < plugin.model_count; ++i) {
    const suture_model& model = plugin.models[i];
    const Entry inner = entry.inner("model", model.id, i);
    if (model.id != nullptr) ids.unique(inner, model.id, "id");
    check_model(inner, model);
  }
  return problems;
}

}  // namespace suture
