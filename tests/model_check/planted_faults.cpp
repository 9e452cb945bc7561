// SPDX-License-Identifier: GPL-3.0-or-later
//
// Springs on edges and on the diagonals of elements, with viscosity and creep, once as they should
// be and once for each mistake of authors that `suture check-model` must find. Written on the C
// tables, as the C++ layer prevents some of them. The last parameter tells which one it is.
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>
#include <thread>
#include <vector>

#include "suture/model.hpp"
#include "suture/single.h"

namespace {

constexpr std::size_t lanes = SUTURE_LANES;

constexpr const char* faults[] = {
    "none",           "wrong-sign",    "twice",         "half-energy",
    "unset-node",     "same-force",    "out-of-range",  "writes-input",
    "adds",           "mixed-lanes",   "padding",       "undeclared",
    "reads-ids",      "memory",        "race",          "nan-accepted",
    "no-geometric",   "no-damping",    "single-zero",   "small-bounds",
    "absolute",       "linear-strain", "axis",          "shape",
    "prestress",      "negative",      "mass-constant", "mass-negative",
    "copied",         "global",        "ignored",       "step-counter",
    "state-in-place", "state-unset",   "energy-unset",  "bounds-outside",
    "field-unset",    "isa",           "one-node-off",  "velocity-drag",
    "allocates",      "part-per-step", "rounded"};
constexpr std::size_t fault_count = std::size(faults);

enum { p_young, p_rho, p_viscosity, p_rate, p_fault };
enum { a_mass, a_stiffness, a_creep };

bool has(const suture_context* context, std::string_view fault) {
  return faults[static_cast<std::size_t>(context->parameters[p_fault])] == fault;
}

using Vec = std::array<double, 3>;
double dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec at(const double* vectors, std::size_t node, std::size_t lane) {
  return {vectors[(3 * node + 0) * lanes + lane], vectors[(3 * node + 1) * lanes + lane],
          vectors[(3 * node + 2) * lanes + lane]};
}
Vec between(const double* vectors, std::size_t a, std::size_t b, std::size_t lane) {
  const Vec x = at(vectors, a, lane), y = at(vectors, b, lane);
  return {y[0] - x[0], y[1] - x[1], y[2] - x[2]};
}
Vec scaled(double s, const Vec& v) { return {s * v[0], s * v[1], s * v[2]}; }
Vec sum(const Vec& a, const Vec& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

/// A spring between two nodes of a cell: f = k (l/L - 1 - q) u + c (w.d) d / L^2 on its first node.
struct Spring {
  Vec d, w, rest;
  double k, c, q, length, rest_length;

  double strain() const { return length / rest_length - 1 - q; }
  double pull() const { return k * strain() / length; }
  double drag() const { return c / (rest_length * rest_length); }
  double energy() const { return 0.5 * k * rest_length * strain() * strain(); }
  Vec force() const { return scaled(pull() + drag() * dot(w, d), d); }
  Vec tangent(const Vec& dd, const Vec& dw, bool geometric, bool damping) const {
    const double along = k * (1 + q) / (length * length * length) * dot(d, dd);
    Vec df = scaled(along, d);
    if (geometric) df = sum(df, scaled(pull(), dd));
    df = sum(df, sum(scaled(drag() * dot(w, dd), d), scaled(drag() * dot(w, d), dd)));
    return damping ? sum(df, scaled(drag() * dot(dw, d), d)) : df;
  }
  double stiffness_bound() const {
    const double viscous = 2 * drag() * std::sqrt(dot(w, w)) * length;
    return 2 * (std::max(k / rest_length, std::abs(pull())) + viscous);
  }
  double damping_bound() const { return 2 * drag() * length * length; }
};

double global_young = 0;
double global_lanes[2 * lanes];

double young_of(const suture_context* context) {
  if (has(context, "global")) return global_young;
  if (has(context, "rounded")) return static_cast<float>(context->parameters[p_young]);
  return has(context, "ignored") ? 1e4 : context->parameters[p_young];
}

Spring spring_between(const suture_context* context, const suture_batch* batch, std::size_t a,
                      std::size_t b, std::size_t lane) {
  Spring s{};
  s.d = between(batch->position, a, b, lane);
  s.w = between(batch->velocity, a, b, lane);
  s.rest = between(batch->rest, a, b, lane);
  s.length = std::sqrt(dot(s.d, s.d));
  s.rest_length = std::sqrt(dot(s.rest, s.rest)) * (has(context, "prestress") ? 1.01 : 1);
  return s;
}

/// 12 springs of an edge that several elements share, through the column of their stiffness.
struct Edges {
  static constexpr std::size_t nodes = 2, springs = 1;
  static Spring spring(const suture_context* context, const suture_batch* batch, std::size_t,
                       std::size_t lane, std::size_t* ends) {
    ends[0] = 0;
    ends[1] = 1;
    Spring s = spring_between(context, batch, 0, 1, lane);
    s.k = batch->cell_columns[0][lane];
    s.q = batch->cell_columns[1][lane];
    s.c = context->parameters[p_viscosity] * s.k;
    if (has(context, "axis")) s.k *= 1 + 0.1 * std::abs(s.rest[0]) / s.rest_length;
    return s;
  }
};

/// The diagonals of an element.
template <bool General>
struct Diagonals {
  static constexpr std::size_t nodes = 8, springs = 4;
  static Spring spring(const suture_context* context, const suture_batch* batch, std::size_t number,
                       std::size_t lane, std::size_t* ends) {
    ends[0] = number;
    ends[1] = 7 - number;
    Spring s = spring_between(context, batch, ends[0], ends[1], lane);
    const double length = std::sqrt(dot(s.rest, s.rest));
    s.k = 0.1 * young_of(context) * length * length;
    if (General && has(context, "shape")) s.k *= 0.9;
    if (has(context, "negative")) s.k *= -20;
    return s;
  }
};

template <class Cells, class Work>
void for_each_spring(const suture_context* context, const suture_batch* batch, Work work) {
  for (std::size_t lane = 0; lane < lanes; ++lane)
    for (std::size_t i = 0; i < Cells::springs; ++i) {
      std::size_t ends[2];
      const Spring spring = Cells::spring(context, batch, i, lane, ends);
      work(spring, ends, lane);
    }
}

void add(double* vectors, std::size_t node, std::size_t lane, double factor, const Vec& v) {
  for (std::size_t c = 0; c < 3; ++c) vectors[(3 * node + c) * lanes + lane] += factor * v[c];
}

/// Mistakes that change forces which are right.
template <class Cells>
void spoil_forces(const suture_context* context, const suture_batch* batch) {
  double* f = batch->force;
  const std::size_t size = 3 * Cells::nodes * lanes;
  const auto multiply = [&](double factor) {
    for (std::size_t i = 0; i < size; ++i) f[i] *= factor;
  };
  if (has(context, "wrong-sign")) multiply(-1);
  if (has(context, "twice")) multiply(2);
  if (has(context, "padding")) multiply(8.0 / batch->valid);
  if (has(context, "reads-ids")) multiply(1 + 1e-3 * batch->cell_ids[0]);
  if (has(context, "isa")) {
#ifdef __AVX2__
    multiply(1.001);
#endif
  }
  if (has(context, "mixed-lanes")) f[0] = f[1];
  if (has(context, "same-force")) std::memcpy(f + size / 2, f, sizeof(double) * size / 2);
  if (has(context, "out-of-range") && Cells::nodes == 2) f[size] = 0;
  if (has(context, "writes-input")) const_cast<double*>(batch->position)[0] += 1;
  for (std::size_t i = 0; i < size; ++i) {
    if (has(context, "absolute")) f[i] *= 1 + 0.1 * batch->position[i % lanes];
    if (has(context, "undeclared")) f[i] += 1e-3 * batch->velocity[i];
    if (has(context, "velocity-drag")) f[i] -= 1e-3 * batch->velocity[i];
  }
  if (has(context, "one-node-off")) multiply(1 + 1e-4 * (f[0] > 0));
}

/// Mistakes with the memory of calls.
void remember(const suture_context* context, const suture_batch* batch) {
  if (has(context, "allocates")) {
    std::vector<double> copy(batch->force, batch->force + lanes);
    std::memcpy(batch->force, copy.data(), sizeof(double) * lanes);
  }
  static double calls = 0;
  if (has(context, "memory")) batch->force[0] += 1e-9 * calls++;
  if (!has(context, "race")) return;
  std::memcpy(global_lanes, batch->force, sizeof(double) * lanes);
  std::this_thread::yield();
  std::memcpy(batch->force, global_lanes, sizeof(double) * lanes);
}

/// The creep: q' = r (l/L - 1 - q), implicit.
template <class Cells>
void advance(const suture_context* context, const suture_batch* batch) {
  if (Cells::nodes != 2 || has(context, "state-unset")) return;
  for_each_spring<Cells>(context, batch,
                         [&](const Spring& s, const std::size_t*, std::size_t lane) {
                           const double step = batch->dt * context->parameters[p_rate];
                           double change = step / (1 + step) * s.strain();
                           if (has(context, "step-counter")) change = 0.01;
                           if (has(context, "part-per-step")) change = 0.1 * s.strain();
                           batch->trial_columns[1][lane] = s.q + change;
                           if (has(context, "state-in-place"))
                             const_cast<double*>(batch->cell_columns[1])[lane] += change;
                         });
}

/// f = k (d - D) / L: no objectivity.
Vec linear_force(const Spring& s) {
  return scaled(s.k / s.rest_length, sum(s.d, scaled(-1, s.rest)));
}

bool is_finite(const suture_batch* batch) {
  for (std::size_t i = 0; i < 3 * batch->nodes * lanes; ++i)
    if (!std::isfinite(batch->force[i])) return false;
  return true;
}

template <class Cells>
suture_status force(const suture_context* context, const suture_batch* batch) {
  const std::size_t set = has(context, "unset-node") ? Cells::nodes - 1 : Cells::nodes;
  if (!has(context, "adds")) std::memset(batch->force, 0, sizeof(double) * 3 * set * lanes);
  for_each_spring<Cells>(
      context, batch, [&](const Spring& s, const std::size_t* ends, std::size_t lane) {
        const Vec f = has(context, "linear-strain") ? linear_force(s) : s.force();
        add(batch->force, ends[0], lane, 1, f);
        if (ends[1] < set) add(batch->force, ends[1], lane, -1, f);
      });
  spoil_forces<Cells>(context, batch);
  remember(context, batch);
  advance<Cells>(context, batch);
  return has(context, "nan-accepted") || is_finite(batch) ? SUTURE_OK : SUTURE_RETRY;
}

template <class Cells>
suture_status energy(const suture_context* context, const suture_batch* batch, double* out) {
  if (has(context, "energy-unset")) return SUTURE_OK;
  std::memset(out, 0, sizeof(double) * lanes);
  for_each_spring<Cells>(context, batch,
                         [&](const Spring& s, const std::size_t*, std::size_t lane) {
                           const Vec u = sum(s.d, scaled(-1, s.rest));
                           double e = s.energy();
                           if (has(context, "linear-strain"))
                             e = 0.5 * s.k / s.rest_length * dot(u, u);
                           out[lane] += has(context, "half-energy") ? 0.5 * e : e;
                         });
  return SUTURE_OK;
}

template <class Cells>
suture_status tangent(const suture_context* context, const suture_batch* batch, const double* dx,
                      const double* dv, double* df) {
  std::memset(df, 0, sizeof(double) * 3 * Cells::nodes * lanes);
  const bool geometric = !has(context, "no-geometric"), damping = !has(context, "no-damping");
  for_each_spring<Cells>(context, batch,
                         [&](const Spring& s, const std::size_t* ends, std::size_t lane) {
                           const Vec dd = between(dx, ends[0], ends[1], lane),
                                     dw = between(dv, ends[0], ends[1], lane);
                           Vec f = s.tangent(dd, dw, geometric, damping);
                           if (has(context, "linear-strain")) f = scaled(s.k / s.rest_length, dd);
                           add(df, ends[0], lane, 1, f);
                           add(df, ends[1], lane, -1, f);
                         });
  return SUTURE_OK;
}

suture_status single_tangent(const suture_context*, const suture_single_batch* batch, const float*,
                             const float*, float* df) {
  std::memset(df, 0, sizeof(float) * 3 * batch->nodes * SUTURE_SINGLE_LANES);
  return SUTURE_OK;
}

template <class Cells>
suture_status bounds(const suture_context* context, const suture_batch* batch, double* stiffness,
                     double* damping) {
  std::memset(stiffness, 0, sizeof(double) * 6 * Cells::nodes * lanes);
  std::memset(damping, 0, sizeof(double) * 6 * Cells::nodes * lanes);
  const double factor = has(context, "small-bounds") ? 0.25 : 1;
  if (has(context, "bounds-outside")) damping[6 * Cells::nodes * lanes] = 0;
  for_each_spring<Cells>(
      context, batch, [&](const Spring& s, const std::size_t* ends, std::size_t lane) {
        for (int end = 0; end < 2; ++end)
          for (std::size_t c = 0; c < 3; ++c) {
            stiffness[(6 * ends[end] + c) * lanes + lane] += factor * s.stiffness_bound();
            damping[(6 * ends[end] + c) * lanes + lane] += factor * s.damping_bound();
          }
      });
  return SUTURE_OK;
}

template <class Cells>
suture_status output(const suture_context* context, const suture_batch* batch, double* const* out) {
  if (out[0] == nullptr || has(context, "field-unset")) return SUTURE_OK;
  std::memset(out[0], 0, sizeof(double) * lanes);
  for_each_spring<Cells>(
      context, batch,
      [&](const Spring& s, const std::size_t*, std::size_t lane) { out[0][lane] += s.strain(); });
  return SUTURE_OK;
}

constexpr suture_field fields[] = {suture::field("strain", "1", "sum of the strains")};

// The extension of a functor does not know the instance: models with the fault have tables of
// their own.
template <class Cells, bool Single>
const void* extension(const char* id) {
  static constexpr suture_energy_1 energies{sizeof(suture_energy_1), 0, energy<Cells>};
  static constexpr suture_tangent_1 tangents{sizeof(suture_tangent_1), 0, tangent<Cells>};
  static constexpr suture_stable_dt_1 stable{sizeof(suture_stable_dt_1), 0, bounds<Cells>};
  static constexpr suture_output_1 outputs{sizeof(suture_output_1), 1, fields, output<Cells>};
  static constexpr suture_tangent_single_1 single{sizeof(suture_tangent_single_1),
                                                  SUTURE_SINGLE_LANES, SUTURE_READ_POSITION, 0,
                                                  single_tangent};
  if (id == std::string_view(SUTURE_ENERGY_1)) return &energies;
  if (id == std::string_view(SUTURE_TANGENT_1)) return &tangents;
  if (id == std::string_view(SUTURE_STABLE_DT_1)) return &stable;
  if (id == std::string_view(SUTURE_OUTPUT_1)) return &outputs;
  if (Single && id == std::string_view(SUTURE_TANGENT_SINGLE_1)) return &single;
  return nullptr;
}

// ---------------------------------------------------------------- contributions --

double volume(const suture_batch* batch, std::size_t lane) {
  const Vec a = between(batch->rest, 0, 1, lane), b = between(batch->rest, 0, 2, lane),
            c = between(batch->rest, 0, 4, lane);
  return std::abs(a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                  a[2] * (b[0] * c[1] - b[1] * c[0]));
}

suture_status give_mass(const suture_context* context, const suture_batch* batch, double* out) {
  for (std::size_t lane = 0; lane < lanes; ++lane)
    for (std::size_t n = 0; n < 8; ++n) {
      double mass = context->parameters[p_rho] * volume(batch, lane) / 8;
      if (has(context, "mass-constant")) mass = context->parameters[p_rho] * 1e-6;
      if (has(context, "mass-negative") && n == 3) mass = -mass;
      out[n * lanes + lane] = mass;
    }
  return SUTURE_OK;
}

/// N, of the edges: E times a share of the section.
suture_status give_stiffness(const suture_context* context, const suture_batch* batch,
                             double* out) {
  for (std::size_t lane = 0; lane < lanes; ++lane)
    for (std::size_t e = 0; e < 12; ++e) {
      const auto* ends = suture_hexahedron_edges[e];
      const Vec d = between(batch->rest, ends[0], ends[1], lane);
      out[e * lanes + lane] = 0.25 * young_of(context) * volume(batch, lane) / std::sqrt(dot(d, d));
    }
  return SUTURE_OK;
}

suture_status prepare(const suture_context* context, void*) {
  global_young = context->parameters[p_young];
  return SUTURE_OK;
}

constexpr suture_contribution mass_contribution[] = {
    {sizeof(suture_contribution), SUTURE_HEXAHEDRON, give_mass}};
constexpr suture_contribution stiffness_contribution[] = {
    {sizeof(suture_contribution), SUTURE_HEXAHEDRON, give_stiffness}};

// ----------------------------------------------------------------------- tables --

constexpr std::uint32_t edge_columns[] = {a_stiffness, a_creep};

/// The tables of the model with one fault.
struct Tables {
  suture_parameter parameters[5];
  suture_attribute attributes[3];
  suture_functor functors[3];
};

template <class Cells, bool Single>
constexpr suture_functor functor(const char* name, std::uint32_t dimension, std::uint32_t cell_type,
                                 std::uint32_t shape) {
  suture_functor f{};
  f.size = sizeof(suture_functor);
  f.dimension = dimension;
  f.cell_type = cell_type;
  f.shape = shape;
  f.lanes = lanes;
  f.reads = SUTURE_READ_REST | SUTURE_READ_POSITION | SUTURE_READ_VELOCITY;
  f.name = name;
  f.doc = "springs";
  f.force = force<Cells>;
  f.extension = extension<Cells, Single>;
  if (dimension == 1) {
    f.cell_column_count = 2;
    f.cell_columns = edge_columns;
  }
  return f;
}

template <bool Single>
constexpr void set_functors(suture_functor (&out)[3]) {
  out[0] = functor<Edges, Single>("edges", 1, SUTURE_EDGE, SUTURE_ANY_SHAPE);
  out[1] = functor<Diagonals<false>, Single>("diagonals of parallelepipeds", 3, SUTURE_HEXAHEDRON,
                                             SUTURE_PARALLELEPIPED);
  out[2] = functor<Diagonals<true>, Single>("diagonals of other hexahedra", 3, SUTURE_HEXAHEDRON,
                                            SUTURE_GENERAL);
}

constexpr Tables tables_of(std::size_t fault) {
  const std::string_view name = faults[fault];
  Tables t{};
  t.parameters[p_young] = suture::number("E", "Pa", "stiffness").above(0);
  t.parameters[p_rho] = suture::number("rho", "kg/m^3", "density").above(0);
  t.parameters[p_viscosity] = suture::number("c", "s", "viscosity").at_least(0).or_else(0);
  t.parameters[p_rate] = suture::number("rate", "1/s", "of the creep").at_least(0);
  const auto number = static_cast<double>(fault);
  t.parameters[p_fault] =
      suture::integer("fault", "which").at_least(number).at_most(number).or_else(number);
  t.attributes[a_mass] = suture::vertex_attribute("mass", "kg", "share").flag(SUTURE_SHARED_MASS);
  t.attributes[a_stiffness] = suture::edge_attribute("stiffness", "N", "of the edge").starts_at(5);
  t.attributes[a_creep] = suture::edge_attribute("creep", "1", "state").copy().trial();
  t.attributes[a_mass].policy = SUTURE_FROM_VOLUMES;
  t.attributes[a_mass].contribution_count = 1;
  t.attributes[a_mass].contributions = mass_contribution;
  if (name != "copied") {
    t.attributes[a_stiffness].policy = SUTURE_FROM_VOLUMES;
    t.attributes[a_stiffness].contribution_count = 1;
    t.attributes[a_stiffness].contributions = stiffness_contribution;
  }
  if (name == "single-zero")
    set_functors<true>(t.functors);
  else
    set_functors<false>(t.functors);
  if (name == "undeclared")
    for (auto& f : t.functors) f.reads = SUTURE_READ_REST | SUTURE_READ_POSITION;
  return t;
}

template <std::size_t... I>
constexpr std::array<Tables, sizeof...(I)> all_tables(std::index_sequence<I...>) {
  return {tables_of(I)...};
}
constexpr auto tables = all_tables(std::make_index_sequence<fault_count>());

constexpr suture_model model_of(std::size_t fault) {
  suture_model m{};
  m.size = sizeof(suture_model);
  m.id = faults[fault];
  m.doc = "springs with a planted fault";
  m.formula = "f = k (l/L - 1 - q) u";
  m.citation = "none";
  m.parameter_count = 5;
  m.attribute_count = 3;
  m.functor_count = 3;
  m.parameters = tables[fault].parameters;
  m.attributes = tables[fault].attributes;
  m.functors = tables[fault].functors;
  m.prepare = prepare;
  return m;
}

template <std::size_t... I>
constexpr std::array<suture_model, sizeof...(I)> all_models(std::index_sequence<I...>) {
  return {model_of(I)...};
}
constexpr auto models = all_models(std::make_index_sequence<fault_count>());

const suture_plugin plugin = {sizeof(suture_plugin),
                              SUTURE_MAGIC,
                              SUTURE_ABI_MAJOR,
                              SUTURE_ABI_MINOR,
                              lanes,
                              fault_count,
                              "planted-faults",
                              "1.0",
                              "GPL-3.0-or-later",
                              "Models with planted faults",
                              models.data(),
                              0,
                              0,
                              nullptr};

}  // namespace

namespace {
template <std::size_t... I>
constexpr suture_note note_of(std::index_sequence<I...>) {
  return suture::make_note("planted-faults", faults[I]...);
}
}  // namespace

SUTURE_NOTE_STORAGE constexpr suture_note note_of_this_plugin =
    note_of(std::make_index_sequence<fault_count>());

extern "C" [[gnu::visibility("default")]] const suture_plugin* suture_plugin_v1() {
  return &plugin;
}
