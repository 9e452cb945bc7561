// SPDX-License-Identifier: GPL-3.0-or-later
//
// A correct model, and common mistakes of authors: one per macro. CTest compiles the file once
// per macro and looks for the message that the compiler must print (CMakeLists.txt).
#if defined(MISTAKE_ENERGY_OF_LAW) || defined(MISTAKE_ELEMENT_PARAMETER) || \
    defined(MISTAKE_NO_EVOLVE) || defined(MISTAKE_COMPONENTS_OF_STATE) ||   \
    defined(MISTAKE_BRANCH) || defined(MISTAKE_LAW_STATED_TWICE) || defined(MISTAKE_ISOTROPIC)
#define MISTAKE_IN_LAW
#endif

#include "suture/continuum.hpp"

namespace {

struct Share {
#ifdef MISTAKE_COMPONENTS_OF_CONTRIBUTION
  static constexpr int components = 2;
#else
  static constexpr int components = 1;
#endif
  template <class Cell, class Out>
  static void compute(const Cell& c, const Out& out) {
#ifdef MISTAKE_POSITION_IN_CONTRIBUTION
    for (int n = 0; n < 8; ++n) out.set(n, 0, c.position(n)[0]);
#else
    for (int n = 0; n < 8; ++n) out.set(n, 0, c.rest(n)[0]);
#endif
  }
};

#ifdef MISTAKE_NO_CELLS
struct Springs : suture::model, suture::functor_defaults {
#else
struct Springs : suture::model, suture::on_edges {
#endif
  static constexpr const char *id = "springs", *doc = "Springs", *formula = "f = k u";
#ifndef MISTAKE_NO_CITATION
  static constexpr const char* citation = "textbook";
#endif
  enum { stiffness, damping };
  static constexpr suture::parameter parameters[] = {
      suture::number("k", "N/m", "stiffness"), suture::number("c", "N s/m", "damping")
#ifdef MISTAKE_PARAMETER_PER_ELEMENT
                                                   .per_element()
#endif
  };
  static constexpr suture::attribute attributes[] = {
      suture::vertex_attribute("mass", "kg", "share")
          .from_volumes(suture::contribution<Springs, Share>)
          .flag(SUTURE_SHARED_MASS),
      suture::edge_attribute("factors", "1", "two of them", 2).copy(),
      suture::edge_attribute("memory", "1", "state").copy().trial(),
      suture::vertex_attribute("load", "N", "a load").share()};
  static constexpr suture::column<0> mass{};
  static constexpr suture::column<1> factors{};
  static constexpr suture::column<2> memory{};
  static constexpr suture::column<3> load{};
  static constexpr suture::column<4> nobody{};

#if defined(MISTAKE_CELL_COLUMN)
  static constexpr auto cell_columns = suture::columns(memory);
#elif defined(MISTAKE_DIMENSION_OF_COLUMN)
  static constexpr auto cell_columns = suture::columns(factors, memory, load);
#elif defined(MISTAKE_NO_SUCH_ATTRIBUTE)
static constexpr auto cell_columns = suture::columns(factors, memory, nobody);
#else
static constexpr auto cell_columns = suture::columns(factors, memory);
#endif
#if defined(MISTAKE_VERTEX_COLUMN)
  static constexpr auto vertex_columns = suture::columns(load);
#elif defined(MISTAKE_EDGE_AS_VERTEX_COLUMN)
  static constexpr auto vertex_columns = suture::columns(suture::vertex_mass, load, factors);
#elif defined(MISTAKE_SHARE_OF_MASS)
static constexpr auto vertex_columns = suture::columns(suture::vertex_mass, load, mass);
#else
static constexpr auto vertex_columns = suture::columns(suture::vertex_mass, load);
#endif
#if defined(MISTAKE_VELOCITY)
  static constexpr std::uint32_t reads = SUTURE_READ_POSITION | SUTURE_READ_REST;
#elif defined(MISTAKE_REST)
  static constexpr std::uint32_t reads = SUTURE_READ_POSITION | SUTURE_READ_VELOCITY;
#elif defined(MISTAKE_POSITION)
static constexpr std::uint32_t reads = SUTURE_READ_REST | SUTURE_READ_VELOCITY;
#else
static constexpr std::uint32_t reads =
    SUTURE_READ_POSITION | SUTURE_READ_VELOCITY | SUTURE_READ_REST;
#endif

#ifndef MISTAKE_NO_FORCE
  template <class Cell>
  static void force(Cell& c) {
    const auto k = c.parameter(stiffness) * c.column(factors, 0) * c.column(factors, 1);
    const auto u = c.position(1) - c.rest(1) + c.rest(0) - c.position(0);
    const auto m = c.vertex_column(suture::vertex_mass, 0) + c.vertex_column(load, 1);
    const auto f = k * u + (m * c.parameter(damping)) * (c.velocity(1) - c.velocity(0));
    c.force(0, f);
    c.force(1, -f);
    c.trial(memory, 0, c.column(memory) + dot(u, u));
#if defined(MISTAKE_NODE)
    c.force(2, f);
#elif defined(MISTAKE_NODE_OF_POSITION)
    c.force(0, c.position(2));
#elif defined(MISTAKE_COMPONENT)
    c.force(0, f * c.column(factors, 2));
#elif defined(MISTAKE_PARAMETER)
    c.force(0, f * c.parameter(2));
#elif defined(MISTAKE_TRIAL)
    c.trial(factors, 0, dot(u, u));
#elif defined(MISTAKE_CONSTANTS)
    (void)c.constants();
#elif defined(MISTAKE_REPORT)
    c.report(SUTURE_WARNING, dot(u, u) > 1.0, "long", "the edge is long");
#endif
  }
#endif

#ifdef MISTAKE_FORCE_IN_ENERGY
  template <class Cell>
  static auto energy(const Cell& c) {
    c.force(0, c.position(0));
    return dot(c.position(0), c.position(0));
  }
#endif
#if defined(MISTAKE_BOUNDS)
  template <class Cell, class Bounds>
  static void bounds(const Cell&, Bounds&, int) {}
#elif defined(MISTAKE_BOUNDS_NOT_STATIC)
  template <class Cell, class Bounds>
  void bounds(const Cell&, Bounds&) {}
#elif defined(MISTAKE_ENERGY)
static double energy(double stretch) { return stretch; }
#elif defined(MISTAKE_INSPECT)
static void inspect() {}
#elif defined(MISTAKE_ENABLED)
template <class Values>
static bool enabled(const Values&, std::uint32_t&) {
  return true;
}
#elif defined(MISTAKE_PREPARE)
template <class Values>
static void prepare(const Values&, suture::no_constants&) {}
#elif defined(MISTAKE_OUTPUT_WITHOUT_FIELDS)
template <class Cell, class Results>
static void output(const Cell&, Results&) {}
#endif
#ifdef MISTAKE_FIELDS_WITHOUT_OUTPUT
  static constexpr suture_field fields[] = {suture::field("strain", "1", "elongation")};
#endif
};

#ifdef MISTAKE_IN_LAW
struct Solid : suture::continuum<Solid> {
  static constexpr const char *id = "solid", *doc = "Solid", *formula = "P = k F",
                              *citation = "textbook";
  static double density(const suture::values&) { return 1000; }
  template <class T, class P>
  static suture::mat3<T> stress(const suture::mat3<T>& F, const P&) {
    return F;
  }
#ifdef MISTAKE_ENERGY_OF_LAW
  template <class T>
  static T energy(const suture::mat3<T>& F) {
    return 0.5 * dot(F, F);
  }
#elif defined(MISTAKE_BRANCH)
  template <class T, class P>
  static T energy(const suture::mat3<T>& F, const P&) {
    if (det(F) < 1.0) return 0.5 * dot(F, F);
    return dot(F, F);
  }
#elif defined(MISTAKE_LAW_STATED_TWICE)
  template <class P>
  static suture::lame saint_venant_kirchhoff(const P&) {
    return {1, 1};
  }
#elif defined(MISTAKE_ISOTROPIC)
  template <class P>
  static suture::lame isotropic(const P&) {
    return {1, 1};
  }
#elif defined(MISTAKE_ELEMENT_PARAMETER)
  static constexpr suture::parameter parameters[] = {suture::integer("element", "which one")};
#else
  template <class T>
  struct State {
    T strain, another;
  };
  static constexpr suture::attribute states[] = {suture::state("strain", "1", "largest")};
#ifdef MISTAKE_COMPONENTS_OF_STATE
  template <class T, class P, class At>
  static void evolve(const suture::mat3<T>&, const P&, At&) {}
#endif
#endif
};
#endif

}  // namespace

#ifdef MISTAKE_IN_LAW
SUTURE_PLUGIN("solid", "1.0", "MIT", "Solid", Solid)
#elif defined(MISTAKE_NO_PLUGIN)
const suture_model* springs();
const suture_model* springs() { return suture::detail::model_table<Springs>::rows; }
#else
SUTURE_PLUGIN("springs", "1.0", "MIT", "Springs", Springs)
#endif
