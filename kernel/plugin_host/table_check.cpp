// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/table_check.hpp"

#include <cctype>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <string_view>

#include "kernel/base/host_extensions.hpp"
#include "kernel/base/nearest.hpp"

namespace suture {
namespace {

/// More entries than any table has: a count above it is a damaged struct.
constexpr std::uint32_t most_entries = 4096;

std::string number(double value) {
  std::string out = std::to_string(value);
  out.erase(out.find_last_not_of('0') + 1);
  if (!out.empty() && out.back() == '.') out.pop_back();
  return out;
}

/// Collects problems of one entry under its name.
class Entry {
 public:
  Entry(std::vector<std::string>& problems, std::string name)
      : problems_(problems), name_(std::move(name)) {}

  Entry inner(const std::string& kind, const char* name, std::uint32_t index) const {
    const bool named = name != nullptr && *name != '\0';
    return {problems_, (name_.empty() ? "" : name_ + ", ") + kind + " " +
                           (named ? "'" + std::string(name) + "'" : std::to_string(index))};
  }

  bool require(bool holds, const std::string& otherwise) const {
    if (!holds) problems_.push_back((name_.empty() ? "" : name_ + ": ") + otherwise);
    return holds;
  }

  void text(const char* value, const char* member) const {
    require(value != nullptr, std::string(member) + " is NULL");
  }

  /// Array member and its count belong together.
  bool array(const void* pointer, std::uint32_t count, const char* member) const {
    return require(count <= most_entries, std::string("the count of ") + member + " is " +
                                              std::to_string(count) + ", at most " +
                                              std::to_string(most_entries)) &&
           require(count == 0 || pointer != nullptr,
                   std::string(member) + " is NULL, but its count is " + std::to_string(count));
  }

  /// Structs grow at their end, and a plugin's minor never exceeds the host's:
  /// at ABI 1.0 both have the same size. A later minor that appends a member
  /// brings the older layout up to date here, before anything else reads it.
  template <class T>
  bool size(const T& object) const {
    return require(object.size == sizeof(T), "its member size is " + std::to_string(object.size) +
                                                 ", expected " + std::to_string(sizeof(T)) +
                                                 " (first member of every struct: sizeof)");
  }

  void reserved(std::uint32_t value) const { require(value == 0, "reserved is not 0"); }

  void known(std::uint32_t value, std::uint32_t last, const char* member) const {
    require(value <= last, std::string(member) + " is " + std::to_string(value) +
                               ", the last known value is " + std::to_string(last));
  }

  void known_bits(std::uint32_t value, std::uint32_t known, const char* member) const {
    require((value & ~known) == 0, std::string(member) + " has unknown bits");
  }

 private:
  std::vector<std::string>& problems_;
  std::string name_;
};

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

/// Letter or '_', then letters, digits and '_'.
bool is_name(std::string_view text) {
  if (text.empty() || std::isdigit(static_cast<unsigned char>(text.front())) != 0) return false;
  for (const char c : text)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_') return false;
  return true;
}

void check_id(const Entry& entry, const char* id) {
  entry.require(id != nullptr && is_id(id),
                "its id is " + (id == nullptr ? "NULL" : "'" + std::string(id) + "'") +
                    "; expected lower-case letters, digits and '-', a letter first");
}

class Names {
 public:
  void check(const Entry& entry, const char* name) {
    if (!entry.require(name != nullptr && is_name(name),
                       "its name is not a letter followed by letters, digits and '_'"))
      return;
    unique(entry, name, "name");
  }
  void unique(const Entry& entry, const char* name, const char* what) {
    entry.require(seen_.insert(name).second, std::string("the ") + what + " occurs twice");
  }

 private:
  std::set<std::string> seen_;
};

// ---------------------------------------------------------------- parameters --

void check_choices(const Entry& entry, const suture_parameter& p) {
  if (p.type != SUTURE_CHOICE) {
    entry.require(p.choice_count == 0, "has choices, but is not of type SUTURE_CHOICE");
    return;
  }
  if (!entry.require(p.choice_count > 0, "is a choice without choices") ||
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
                  its + " is no index into its choices");
  if (p.type == SUTURE_INTEGER) entry.require(value == std::floor(value), its + " is no integer");
  if (p.type > SUTURE_INTEGER) return;
  const bool above = (p.flags & SUTURE_MINIMUM_EXCLUDED) ? value > p.minimum : value >= p.minimum;
  const bool below = (p.flags & SUTURE_MAXIMUM_EXCLUDED) ? value < p.maximum : value <= p.maximum;
  entry.require(
      above && below && std::isfinite(value),
      its + " is outside its range from " + number(p.minimum) + " to " + number(p.maximum));
}

void check_parameters(const Entry& model, const suture_model& m) {
  if (!model.array(m.parameters, m.parameter_count, "parameters")) return;
  Names names;
  for (std::uint32_t i = 0; i < m.parameter_count; ++i) {
    const suture_parameter& p = m.parameters[i];
    const Entry entry = model.inner("parameter", p.name, i);
    if (!entry.size(p)) return;
    names.check(entry, p.name);
    entry.text(p.unit, "unit");
    entry.text(p.doc, "doc");
    entry.known(p.type, SUTURE_CHOICE, "type");
    entry.known_bits(p.flags, SUTURE_REQUIRED | SUTURE_MINIMUM_EXCLUDED | SUTURE_MAXIMUM_EXCLUDED,
                     "flags");
    check_choices(entry, p);
    if (p.type == SUTURE_NUMBER || p.type == SUTURE_INTEGER) check_range(entry, p);
    check_default(entry, p);
  }
}

// ---------------------------------------------------------------- attributes --

void check_policy(const Entry& entry, const suture_attribute& a) {
  entry.known(a.policy, SUTURE_FROM_VOLUMES, "policy");
  const bool summed = a.policy == SUTURE_FROM_VOLUMES;
  entry.require(!summed || a.contribution != nullptr,
                "has policy SUTURE_FROM_VOLUMES, but its contribution is NULL");
  entry.require(summed || a.contribution == nullptr,
                "has a contribution, but not policy SUTURE_FROM_VOLUMES");
  entry.require(!summed || (a.flags & SUTURE_TRIAL) == 0,
                "has a trial copy, but is summed from volumes: it can have one of both");
  if ((a.flags & SUTURE_SHARED_MASS) != 0)
    entry.require(a.dimension == 0 && a.components == 1 && summed,
                  "has SUTURE_SHARED_MASS: expected dimension 0, 1 component and policy "
                  "SUTURE_FROM_VOLUMES");
}

void check_attributes(const Entry& model, const suture_model& m) {
  if (!model.array(m.attributes, m.attribute_count, "attributes")) return;
  Names names;
  for (std::uint32_t i = 0; i < m.attribute_count; ++i) {
    const suture_attribute& a = m.attributes[i];
    const Entry entry = model.inner("attribute", a.name, i);
    if (!entry.size(a)) return;
    names.check(entry, a.name);
    entry.text(a.unit, "unit");
    entry.text(a.doc, "doc");
    entry.known(a.dimension, 3, "dimension");
    entry.require(a.components >= 1 && a.components <= 9,
                  "has " + std::to_string(a.components) + " components, expected 1 to 9");
    entry.known_bits(a.flags, SUTURE_OUTPUT | SUTURE_CHECKPOINT | SUTURE_TRIAL | SUTURE_SHARED_MASS,
                     "flags");
    entry.reserved(a.reserved);
    entry.require(std::isfinite(a.initial), "its initial value is not finite");
    check_policy(entry, a);
  }
}

// ------------------------------------------------------------------ functors --

void check_column(const Entry& entry, const suture_model& m, std::uint32_t column,
                  std::uint32_t dimension, const char* which) {
  const std::string its = std::string("its ") + which + " column " + std::to_string(column);
  if (!entry.require(column < m.attribute_count,
                     its + " is no attribute: the model has " + std::to_string(m.attribute_count)))
    return;
  const suture_attribute& a = m.attributes[column];
  entry.require(a.dimension == dimension, its + " is an attribute of dimension " +
                                              std::to_string(a.dimension) + ", expected " +
                                              std::to_string(dimension));
  entry.require((a.flags & SUTURE_SHARED_MASS) == 0,
                its +
                    " has SUTURE_SHARED_MASS and so is no column; the vertex mass is the vertex "
                    "column UINT32_MAX");
}

void check_columns(const Entry& entry, const suture_model& m, const suture_functor& f) {
  if (m.attributes == nullptr && m.attribute_count > 0) return;  // reported already
  if (entry.array(f.cell_columns, f.cell_column_count, "cell_columns"))
    for (std::uint32_t i = 0; i < f.cell_column_count; ++i)
      check_column(entry, m, f.cell_columns[i], f.dimension, "cell");
  if (entry.array(f.vertex_columns, f.vertex_column_count, "vertex_columns"))
    for (std::uint32_t i = 0; i < f.vertex_column_count; ++i)
      if (f.vertex_columns[i] != std::numeric_limits<std::uint32_t>::max())
        check_column(entry, m, f.vertex_columns[i], 0, "vertex");
}

void check_cells(const Entry& entry, const suture_functor& f) {
  constexpr std::uint32_t type_of[4] = {0, SUTURE_EDGE, SUTURE_QUADRILATERAL, SUTURE_HEXAHEDRON};
  if (!entry.require(f.dimension >= 1 && f.dimension <= 3,
                     "its dimension is " + std::to_string(f.dimension) + ", expected 1, 2 or 3"))
    return;
  entry.require(f.cell_type == type_of[f.dimension],
                "its cell_type is " + std::to_string(f.cell_type) + ", expected " +
                    std::to_string(type_of[f.dimension]) + " with dimension " +
                    std::to_string(f.dimension));
  entry.known(f.shape, SUTURE_GENERAL, "shape");
  entry.known(f.faces, SUTURE_INTERIOR_FACES, "faces");
  entry.require(f.dimension == 3 || f.shape == SUTURE_ANY_SHAPE,
                "names a shape, which only cells of dimension 3 have");
  entry.require(f.dimension == 2 || f.faces == SUTURE_ALL_FACES,
                "names a set of faces, but its dimension is not 2");
}

void check_functors(const Entry& model, const suture_model& m) {
  if (!model.require(m.functor_count > 0, "has no functor") ||
      !model.array(m.functors, m.functor_count, "functors"))
    return;
  Names names;
  for (std::uint32_t i = 0; i < m.functor_count; ++i) {
    const suture_functor& f = m.functors[i];
    const Entry entry = model.inner("functor", f.name, i);
    if (!entry.size(f)) return;
    entry.text(f.name, "name");
    if (f.name != nullptr) names.unique(entry, f.name, "name");
    entry.text(f.doc, "doc");
    entry.require(f.force != nullptr, "its function force is NULL");
    entry.require(f.lanes == SUTURE_LANES, "is written for " + std::to_string(f.lanes) +
                                               " lanes, this host has " +
                                               std::to_string(SUTURE_LANES));
    entry.known(f.scalar, 0, "scalar");
    entry.known_bits(f.reads, SUTURE_READ_REST | SUTURE_READ_POSITION | SUTURE_READ_VELOCITY,
                     "reads");
    check_cells(entry, f);
    check_columns(entry, m, f);
  }
}

// -------------------------------------------------------------------- plugin --

void check_model(const Entry& entry, const suture_model& m) {
  check_id(entry, m.id);
  entry.text(m.doc, "doc");
  entry.text(m.formula, "formula");
  entry.text(m.citation, "citation");
  entry.known_bits(m.flags, SUTURE_CONTINUUM, "flags");
  entry.reserved(m.reserved);
  entry.require(m.instance_bytes == 0 || m.prepare != nullptr,
                "asks for instance_bytes, but has no function prepare to fill them");
  entry.require(m.instance_bytes < (std::uint64_t{1} << 30),
                "asks for 1 GiB or more of instance_bytes");
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

std::vector<std::string> table_problems(const suture_plugin& plugin) {
  std::vector<std::string> problems;
  const Entry entry(problems, "");
  if (!entry.size(plugin)) return problems;
  entry.require(plugin.magic == SUTURE_MAGIC, "its magic number is wrong");
  entry.require(plugin.abi_major == SUTURE_ABI_MAJOR && plugin.abi_minor <= SUTURE_ABI_MINOR,
                "its table says ABI " + std::to_string(plugin.abi_major) + "." +
                    std::to_string(plugin.abi_minor));
  entry.require(plugin.lanes == SUTURE_LANES,
                "its table says " + std::to_string(plugin.lanes) + " lanes");
  if (!problems.empty()) return problems;
  check_id(entry, plugin.id);
  entry.text(plugin.version, "version");
  entry.text(plugin.license, "license");
  entry.text(plugin.description, "description");
  check_extensions(entry, plugin);
  if (!entry.require(plugin.model_count > 0, "has no model") ||
      !entry.array(plugin.models, plugin.model_count, "models"))
    return problems;
  Names ids;
  for (std::uint32_t i = 0; i < plugin.model_count; ++i) {
    const suture_model& model = plugin.models[i];
    const Entry inner = entry.inner("model", model.id, i);
    if (!inner.size(model)) return problems;
    if (model.id != nullptr) ids.unique(inner, model.id, "id");
    check_model(inner, model);
  }
  return problems;
}

}  // namespace suture
