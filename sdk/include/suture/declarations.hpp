// SPDX-License-Identifier: MIT
//
// suture/declarations.hpp - what the declarations of a model are written with: parameters,
// attributes, the bases of models and functors, and the objects that receive results.
// Included by model.hpp, which describes the members of a model.
#ifndef SUTURE_DECLARATIONS_HPP
#define SUTURE_DECLARATIONS_HPP

#include <array>
#include <limits>

#include "suture/cell.hpp"

namespace suture {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

// ------------------------------------------------------------- parameters --

/// A parameter under construction: number("E", "Pa", "Young's modulus").above(0).
/// Required unless or_else() gives it a default.
struct parameter : suture_parameter {
  constexpr parameter above(double x) const {
    return with_range(x, maximum, SUTURE_MINIMUM_EXCLUDED);
  }
  constexpr parameter at_least(double x) const { return with_range(x, maximum, 0); }
  constexpr parameter below(double x) const {
    return with_range(minimum, x, SUTURE_MAXIMUM_EXCLUDED);
  }
  constexpr parameter at_most(double x) const { return with_range(minimum, x, 0); }
  /// The scene may give every element its own value.
  constexpr parameter per_element() const {
    parameter p = *this;
    p.flags |= SUTURE_PER_ELEMENT;
    return p;
  }
  constexpr parameter or_else(double x) const {
    parameter p = *this;
    p.default_value = x;
    p.flags &= ~std::uint32_t(SUTURE_REQUIRED);
    return p;
  }

 private:
  constexpr parameter with_range(double low, double high, std::uint32_t flag) const {
    parameter p = *this;
    p.minimum = low;
    p.maximum = high;
    p.flags |= flag;
    return p;
  }
};

constexpr parameter make_parameter(suture_parameter_type type, const char* name, const char* unit,
                                   const char* doc) {
  parameter p{};
  p.size = sizeof(suture_parameter);
  p.type = type;
  p.flags = SUTURE_REQUIRED;
  p.name = name;
  p.unit = unit;
  p.doc = doc;
  p.minimum = -infinity;
  p.maximum = infinity;
  return p;
}
constexpr parameter number(const char* name, const char* unit, const char* doc) {
  return make_parameter(SUTURE_NUMBER, name, unit, doc);
}
/// A unit vector, such as the direction of fibres in an element; the scene may give any length but
/// zero.
constexpr parameter direction(const char* name, const char* doc) {
  return make_parameter(SUTURE_DIRECTION, name, "1", doc).per_element();
}
constexpr parameter integer(const char* name, const char* doc) {
  return make_parameter(SUTURE_INTEGER, name, "1", doc);
}
constexpr parameter boolean(const char* name, const char* doc, bool default_value) {
  parameter p = make_parameter(SUTURE_BOOLEAN, name, "1", doc).or_else(default_value ? 1 : 0);
  p.minimum = 0;
  p.maximum = 1;
  return p;
}
/// One of `words` (an array with static storage duration); the first is the default.
/// The value is the index.
template <std::size_t N>
constexpr parameter choice(const char* name, const char* doc, const char* const (&words)[N]) {
  parameter p = make_parameter(SUTURE_CHOICE, name, "1", doc).or_else(0);
  p.choice_count = N;
  p.choices = words;
  p.minimum = 0;
  p.maximum = N - 1;
  return p;
}

// ------------------------------------------------------------- attributes --

/// What elements contribute to an attribute of model M, computed by C; for from_volumes():
///   struct RestLength {                              // on edges of a hexahedron
///     static constexpr int components = 1;
///     template <class Cell, class Out> static void compute(const Cell& c, Out out) {
///       for (int k = 0; k < 12; ++k) out.set(k, 0, ...);
///     }
///   };
template <class M, class C>
struct contribution_of {};
template <class M, class C>
inline constexpr contribution_of<M, C> contribution{};

namespace detail {
template <class M, class C>
struct contribution_table;
/// Called in constant expressions only, where it causes an error that shows this name.
inline void attribute_and_contribution_have_different_numbers_of_components() {}
}  // namespace detail

/// An attribute under construction: volume_attribute("memory", "Pa", "...").copy().trial().
struct attribute : suture_attribute {
  constexpr attribute copy() const { return with(SUTURE_COPY); }
  constexpr attribute zero() const { return with(SUTURE_ZERO); }
  constexpr attribute share() const { return with(SUTURE_SHARE); }
  template <class M, class C>
  constexpr attribute from_volumes(contribution_of<M, C>) const {
    if (components != std::uint32_t(C::components))
      detail::attribute_and_contribution_have_different_numbers_of_components();
    attribute a = with(SUTURE_FROM_VOLUMES);
    a.contribution_count = 1;
    a.contributions = &detail::contribution_table<M, C>::row;
    return a;
  }
  constexpr attribute starts_at(double x) const {
    attribute a = *this;
    a.initial = x;
    return a;
  }
  constexpr attribute output() const { return flag(SUTURE_OUTPUT); }
  constexpr attribute trial() const { return flag(SUTURE_TRIAL); }
  /// Users need not know it: `suture describe` does not list it.
  constexpr attribute internal() const { return flag(SUTURE_INTERNAL); }
  /// The values that a scene may give to a field.
  constexpr attribute within(double low, double high) const {
    attribute a = *this;
    a.minimum = low;
    a.maximum = high;
    return a;
  }
  constexpr attribute at_least(double low) const { return within(low, infinity); }
  /// The field never falls in a step, such as a damage that does not heal.
  constexpr attribute rising() const { return flag(SUTURE_RISING); }
  constexpr attribute flag(std::uint32_t bits) const {
    attribute a = *this;
    a.flags |= bits;
    return a;
  }

 private:
  constexpr attribute with(suture_policy p) const {
    attribute a = *this;
    a.policy = p;
    return a;
  }
};

constexpr attribute make_attribute(int dimension, const char* name, const char* unit,
                                   const char* doc, int components) {
  attribute a{};
  a.size = sizeof(suture_attribute);
  a.dimension = std::uint32_t(dimension);
  a.components = std::uint32_t(components);
  a.name = name;
  a.unit = unit;
  a.doc = doc;
  return a;
}
constexpr attribute vertex_attribute(const char* name, const char* unit, const char* doc,
                                     int n = 1) {
  return make_attribute(0, name, unit, doc, n);
}
constexpr attribute edge_attribute(const char* name, const char* unit, const char* doc, int n = 1) {
  return make_attribute(1, name, unit, doc, n);
}
constexpr attribute face_attribute(const char* name, const char* unit, const char* doc, int n = 1) {
  return make_attribute(2, name, unit, doc, n);
}
constexpr attribute volume_attribute(const char* name, const char* unit, const char* doc,
                                     int n = 1) {
  return make_attribute(3, name, unit, doc, n);
}

/// An unknown on vertices that the host integrates (SUTURE_FIELD), of one to three components: all
/// models of a body that declare a field of this name share it. A cut leaves both parts of a vertex
/// its value. Laws read it where they declare it, a functor changes it by its rate().
constexpr attribute vertex_field(const char* name, const char* unit, const char* doc, int n = 1) {
  return vertex_attribute(name, unit, doc, n).copy().flag(SUTURE_FIELD);
}

/// The change of the field declared last before it over an implicit step, per second: for rates
/// that depend on it. It has as many components.
constexpr attribute rate_of_field(const char* name, const char* unit, const char* doc, int n = 1) {
  return vertex_attribute(name, unit, doc, n).copy().internal().flag(SUTURE_FIELD_RATE);
}

/// Receives the results of a contribution: `set(k, component, value)`, k as in plugin.h.
template <class R, int components>
struct contribution_results {
  double* out;
  int lane;
  SUTURE_INLINE void set(int k, int component, const R& value) const {
    SUTURE_DETAIL_CHECK_INDEX(component, component, components);
    store(out + (k * components + component) * int(SUTURE_LANES) + lane, value);
  }
};

// --------------------------------------------------------------- functors --

struct no_column {};

/// The defaults of a functor; it overrides them with members of the same name.
struct functor_defaults {
  static constexpr std::uint32_t shape = SUTURE_ANY_SHAPE;
  static constexpr std::uint32_t faces = SUTURE_ALL_FACES;
  static constexpr std::uint32_t reads = SUTURE_READ_POSITION;
  static constexpr std::uint32_t alternative = 0;
  /// Whether the force depends on differences of positions and of rest positions only, so that a
  /// tangent in single precision can be offered (suture/single.h).
  static constexpr bool single_tangent = false;
  /// Whether the functor may run on bodies with elements of which only a part is material. On
  /// volumes: forces, energy and bounds of such an element are those of the whole one times the
  /// fraction. On vertices, edges and faces: the columns that it reads are sums over elements,
  /// whose contributions the host multiplies by the fraction. Continua need no declaration.
  static constexpr bool allows_parts = false;
  static constexpr bool contributes = false;  ///< true for contributions, set by the layer
  /// On volumes: whether parameters that differ from element to element are read.
  static constexpr bool element_parameters = false;
  /// The same for what the layer above derives from them (model::added_constants).
  static constexpr bool added_element_constants = false;
  static constexpr column_list<> cell_columns{};
  static constexpr column_list<> vertex_columns{};
  /// The field that the functor changes: it has rate() instead of force().
  static constexpr no_column rate_of{};
};
struct on_vertices : functor_defaults {
  static constexpr std::uint32_t dimension = 0, cell_type = SUTURE_VERTEX;
  static constexpr int nodes = 1;
};
struct on_edges : functor_defaults {
  static constexpr std::uint32_t dimension = 1, cell_type = SUTURE_EDGE;
  static constexpr int nodes = 2;
};
struct on_faces : functor_defaults {
  static constexpr std::uint32_t dimension = 2, cell_type = SUTURE_QUADRILATERAL;
  static constexpr int nodes = 4;
};
struct on_volumes : functor_defaults {
  static constexpr std::uint32_t dimension = 3, cell_type = SUTURE_HEXAHEDRON;
  static constexpr int nodes = 8;
};

/// Receives the results of bounds(): per node the stiffness and damping matrices of plugin.h.
template <class R>
struct bound_matrices {
  double* stiffness_out;
  double* damping_out;
  int lane;
  SUTURE_INLINE void stiffness(int node, const sym3<R>& k) const { put(stiffness_out, node, k); }
  SUTURE_INLINE void damping(int node, const sym3<R>& c) const { put(damping_out, node, c); }

 private:
  SUTURE_INLINE void put(double* out, int node, const sym3<R>& m) const {
    for (int c = 0; c < 6; ++c) store(out + (node * 6 + c) * int(SUTURE_LANES) + lane, m.c[c]);
  }
};

/// An output field: static constexpr suture_field fields[] = {field("stress", ...)}.
constexpr suture_field field(const char* name, const char* unit, const char* doc, int n = 1) {
  return {sizeof(suture_field), std::uint32_t(n), name, unit, doc};
}
/// Receives the results of output(); call wanted() before computing an expensive field.
template <class R>
struct results {
  double* const* out;
  int lane;
  bool wanted(int f) const { return out[f] != nullptr; }
  SUTURE_INLINE void set(int f, int component, const R& value) const {
    if (out[f]) store(out[f] + component * int(SUTURE_LANES) + lane, value);
  }
  SUTURE_INLINE void set(int f, const R& value) const { set(f, 0, value); }
  SUTURE_INLINE void set(int f, const sym3<R>& value) const {
    for (int c = 0; c < 6; ++c) set(f, c, value.c[c]);
  }
};

template <class... Functors>
struct list {};
template <class... A, class... B>
constexpr list<A..., B...> joined(list<A...>, list<B...>) {
  return {};
}

namespace detail {
template <class A, class B>
SUTURE_INLINE auto larger(const A& a, const B& b) {
  return max(a, b);
}
template <class A, class B>
SUTURE_INLINE auto smaller(const A& a, const B& b) {
  return min(a, b);
}
template <class Mask, class A, class B>
SUTURE_INLINE auto selected(const Mask& m, const A& a, const B& b) {
  return select(m, a, b);
}
}  // namespace detail

/// Base of a model: the defaults of its optional members, and what a layer above this one
/// (continuum.hpp) adds to an author's model: parameters and attributes, which follow the
/// author's, and constants derived from all of them by prepare_added(setup, parameters or
/// Constants, added_constants&); where these may differ from element to element, they are an
/// aggregate of at most nine numbers, added_constants_of<R>.
struct model {
  static constexpr std::uint32_t flags = 0;
  using added_constants = no_constants;
  static constexpr std::array<parameter, 0> added_parameters() { return {}; }
  static constexpr std::array<attribute, 0> added_attributes() { return {}; }

  // A model lies outside of this namespace. Those of packs and duals would be found by their
  // arguments, but not those of two doubles.
  template <class A, class B>
  static SUTURE_INLINE auto max(const A& a, const B& b) {
    return detail::larger(a, b);
  }
  template <class A, class B>
  static SUTURE_INLINE auto min(const A& a, const B& b) {
    return detail::smaller(a, b);
  }
  template <class Mask, class A, class B>
  static SUTURE_INLINE auto select(const Mask& m, const A& a, const B& b) {
    return detail::selected(m, a, b);
  }
};

}  // namespace suture

#endif
