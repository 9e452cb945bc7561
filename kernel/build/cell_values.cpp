// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/build/cell_values.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/base/escape.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/scene/object_reader.hpp"
#include "kernel/scene/scene_parts.hpp"

namespace suture {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string counted(std::size_t count, const char* one, const char* several) {
  return std::to_string(count) + " " + (count == 1 ? one : several);
}

std::string kind_of(const MeshArray& array) { return array.of_elements ? "elements" : "points"; }

/// "'modulus' (elements), 'u' (points, 3 components)".
std::string list_of(const std::vector<MeshArray>& arrays) {
  std::string text;
  for (const MeshArray& array : arrays) {
    text += (text.empty() ? "" : ", ") + quote(array.name) + " (" + kind_of(array);
    if (array.components != 1) text += ", " + std::to_string(array.components) + " components";
    text += ")";
  }
  return text;
}

/// The values of one column of one model.
class Resolved {
 public:
  using PlaceOf = std::function<std::string(int, Index)>;

  Resolved(const ModelUse& use, const CellValues& given, const Selector& selector, const Body& body,
           const MeshNames& names, const PlaceOf& place_of)
      : use_(use),
        given_(given),
        attribute_(use.model->attributes[given.attribute]),
        components_(attribute_.components),
        selector_(selector),
        body_(body),
        complex_(body.complex()),
        names_(names),
        place_of_(place_of) {}

  GivenColumn column() {
    if (given_.array.empty() && given_.parts.empty()) {
      values_ = given_.elsewhere;
      if (is_direction()) normalise(0);
      return {given_.attribute, false, std::move(values_)};
    }
    values_.assign(components_ * cell_count(), nan);
    if (given_.array.empty())
      fill_from_table();
    else
      fill_from_array(require_array());
    for (const Index cell : cells()) check(cell);
    complain_of_bad();
    return {given_.attribute, true, std::move(values_)};
  }

 private:
  [[noreturn]] void fail(const std::string& text) const {
    throw InputError(given_.path + ": " + text);
  }
  bool is_direction() const {
    return given_.parameter != nullptr && given_.parameter->type == SUTURE_DIRECTION;
  }
  bool of_elements() const { return attribute_.dimension == 3; }
  std::size_t cell_count() const {
    return of_elements() ? complex_.element_count() : body_.user_vertex().size();
  }
  std::string cell_word(Index cell) const {
    return of_elements() ? "element " + std::to_string(selector_.element_id(cell))
                         : "node " + std::to_string(names_.point_id(body_.user_vertex()[cell]));
  }

  // Those of the model's region, ascending.
  std::vector<Index> cells() const {
    const std::vector<Index> elements = selector_.elements(use_.region);
    if (of_elements()) return elements;
    std::vector<Index> vertices;
    for (const Index e : elements) {
      const Hexahedron& nodes = complex_.vertices_of(e);
      vertices.insert(vertices.end(), nodes.begin(), nodes.end());
    }
    sort_unique(vertices);
    return vertices;
  }

  // ---- tables ----

  void fill_from_table() {
    if (!given_.elsewhere.empty())
      for (Index cell = 0; cell < cell_count(); ++cell) set(cell, given_.elsewhere);
    std::vector<std::vector<Index>> cells_of;
    for (const CellValues::Part& part : given_.parts) {
      cells_of.push_back(of_elements() ? elements_of(part.region)
                                       : selector_.vertices(part.region));
      for (const Index cell : cells_of.back()) set(cell, part.value);
    }
    if (of_elements()) mix(cells_of);
  }
  void set(Index cell, const std::vector<double>& value) {
    std::ranges::copy(value, values_.begin() + std::ptrdiff_t(components_ * cell));
  }
  /// A region that fills most of no element counts in mixtures.
  std::vector<Index> elements_of(const Selection& region) const {
    const std::vector<Index>* materials = materials_of(region);
    if (materials == nullptr) return selector_.elements(region);
    return selector_.listed_elements(region);
  }
  /// Returns the materials of a set that occurs in mixtures of elements; else null.
  const std::vector<Index>* materials_of(const Selection& region) const {
    const auto* named = std::get_if<Selection::Named>(&region.what);
    if (named == nullptr) return nullptr;
    const auto found = names_.mixtures.materials.find(named->set);
    return found == names_.mixtures.materials.end() ? nullptr : &found->second;
  }

  /// Elements of several materials take the mean by volume of the values of those that belong to
  /// the model and have one.
  void mix(const std::vector<std::vector<Index>>& cells_of) {
    const std::vector<Mixtures::Share>& shares = names_.mixtures.shares;
    const std::vector<Index>* own = materials_of(use_.region);
    for (std::size_t i = 0, end = 0; i < shares.size(); i = end) {
      const Index cell = body_.imported().element_of[shares[i].element];
      std::vector<double> sum(components_, 0);
      double volume = 0;
      for (; end < shares.size() && shares[end].element == shares[i].element; ++end) {
        const auto& [element, material, fraction] = shares[end];
        if (own != nullptr && !std::ranges::binary_search(*own, material)) continue;
        const std::vector<double>& value = material_value(material, cell, cells_of);
        for (std::size_t c = 0; c < value.size(); ++c) sum[c] += fraction * value[c];
        if (!value.empty()) volume += fraction;
      }
      if (volume == 0) continue;
      for (double& x : sum) x /= volume;
      set(cell, sum);
    }
  }
  /// The last part of the table that contains a material in an element; may be empty.
  const std::vector<double>& material_value(Index material, Index cell,
                                            const std::vector<std::vector<Index>>& cells_of) const {
    for (std::size_t p = given_.parts.size(); p-- > 0;) {
      const std::vector<Index>* materials = materials_of(given_.parts[p].region);
      const bool contains = materials != nullptr ? std::ranges::binary_search(*materials, material)
                                                 : std::ranges::binary_search(cells_of[p], cell);
      if (contains) return given_.parts[p].value;
    }
    return given_.elsewhere;
  }

  // ---- arrays ----

  const MeshArray& require_array() const {
    const MeshArray* found = find_array(names_.arrays, given_, of_elements());
    if (!found) fail_unknown();
    const std::string name = "array " + quote(found->name);
    if (!found->unreadable.empty()) fail(name + " cannot be read: " + found->unreadable);
    if (found->values.empty()) fail(name + " has no values");
    if (found->components != components_)
      fail(name + " has " + counted(found->components, "component", "components") + ", but " +
           quote(attribute_.name) + " has " + std::to_string(components_) +
           "; save an array with that many");
    if (found->of_elements && !of_elements())
      fail(name + " belongs to elements, but " + quote(attribute_.name) +
           " belongs to nodes; save it as point data");
    return *found;
  }
  [[noreturn]] void fail_unknown() const {
    if (names_.arrays.empty())
      fail("there is no array " + quote(given_.array) +
           ": the mesh has no arrays; use a .vtu, .vtk or .msh file that has them, or a table "
           "{\"regions\": ...}");
    std::vector<std::string> names;
    for (const MeshArray& array : names_.arrays) names.push_back(array.name);
    fail("the mesh has no array " + quote(given_.array) + did_you_mean(given_.array, names) +
         "; it has " + list_of(names_.arrays));
  }

  double value_of(const MeshArray& array, std::size_t position, std::size_t component) const {
    return given_.scale * array.values[components_ * position + component];
  }
  void fill_from_array(const MeshArray& array) {
    for (Index cell = 0; cell < cell_count(); ++cell)
      for (std::size_t c = 0; c < components_; ++c)
        values_[components_ * cell + c] = array_value(array, cell, c);
  }
  double array_value(const MeshArray& array, Index cell, std::size_t component) const {
    if (!of_elements()) return value_of(array, body_.user_vertex()[cell], component);
    if (array.of_elements) return value_of(array, body_.imported().user_element[cell], component);
    double sum = 0;
    for (const Index v : complex_.vertices_of(cell))
      sum += value_of(array, body_.user_vertex()[v], component);
    return sum / 8;
  }

  // ---- checks ----

  std::span<double> of_cell(Index cell) {
    return std::span(values_).subspan(components_ * cell, components_);
  }
  /// False for a vector without a length.
  bool normalise(Index cell) {
    const std::span<double> v = of_cell(cell);
    const double length = std::hypot(v[0], v[1], v[2]);
    if (!(length > 0) || !std::isfinite(length)) return false;
    for (double& x : v) x /= length;
    return true;
  }
  bool is_good(Index cell) {
    const std::span<double> v = of_cell(cell);
    if (!std::ranges::all_of(v, [](double x) { return std::isfinite(x); })) return false;
    if (is_direction()) return normalise(cell);
    return given_.parameter == nullptr || scene_parts::limits_of(*given_.parameter).admits(v[0]);
  }
  void check(Index cell) {
    if (is_good(cell)) return;
    ++bad_;
    if (first_bad_ == none) first_bad_ = cell;
  }

  /// What is wrong with the values of a cell, and what was expected.
  std::string fault_of(Index cell) {
    const std::span<double> v = of_cell(cell);
    std::ostringstream text;
    if (std::ranges::any_of(v, [](double x) { return std::isnan(x); }))
      return given_.array.empty() ? "is in no region; add one, or give the value \"elsewhere\""
                                  : "has no value (nan); a finite number is expected";
    if (std::ranges::any_of(v, [](double x) { return std::isinf(x); }))
      return "has an infinite value; a finite number is expected";
    if (is_direction())
      return "has a direction of length 0; a vector of any other length is expected";
    text << "has the value " << v[0];
    const std::string unit = attribute_.unit;
    if (!unit.empty() && unit != "1") text << ' ' << unit;
    const std::string required =
        given_.parameter ? scene_parts::limits_of(*given_.parameter).requirement() : "";
    return text.str() + "; it " + required;
  }
  void complain_of_bad() {
    if (bad_ == 0) return;
    std::string text = cell_word(first_bad_) + " at " +
                       place_of_(static_cast<int>(attribute_.dimension), first_bad_) + " " +
                       fault_of(first_bad_);
    if (!given_.array.empty()) text = "array " + quote(given_.array) + ": " + text;
    if (bad_ > 1)
      text += " (" + std::to_string(bad_) + (of_elements() ? " elements" : " nodes") + " in all)";
    fail(text);
  }

  const ModelUse& use_;
  const CellValues& given_;
  const suture_attribute& attribute_;
  std::size_t components_;
  const Selector& selector_;
  const Body& body_;
  const CellComplex& complex_;
  const MeshNames& names_;
  const PlaceOf& place_of_;
  std::vector<double> values_;
  std::size_t bad_ = 0;
  Index first_bad_ = none;
};

}  // namespace

const MeshArray* find_array(const std::vector<MeshArray>& arrays, const CellValues& values,
                            bool of_elements) {
  const MeshArray* found = nullptr;
  for (const MeshArray& array : arrays)
    if (array.name == values.array && (!found || array.of_elements == of_elements)) found = &array;
  return found;
}

std::set<std::string> arrays_of(const Scene& scene) {
  std::set<std::string> names;
  for (const ModelUse& use : scene.models)
    for (const CellValues& values : use.values)
      if (!values.array.empty()) names.insert(values.array);
  return names;
}

std::vector<std::vector<GivenColumn>> given_columns(
    const Scene& scene, const Selector& selector, const Body& body, const MeshNames& names,
    const std::function<std::string(int, Index)>& place_of) {
  std::vector<std::vector<GivenColumn>> result;
  std::string mistakes;
  for (const ModelUse& use : scene.models) {
    result.emplace_back();
    for (const CellValues& given : use.values) try {
        Resolved values(use, given, selector, body, names, place_of);
        result.back().push_back(values.column());
      } catch (const InputError& error) {
        mistakes += (mistakes.empty() ? "" : "\n") + std::string(error.what());
      }
  }
  if (!mistakes.empty()) throw InputError(mistakes);
  return result;
}

}  // namespace suture
