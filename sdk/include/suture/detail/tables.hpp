// SPDX-License-Identifier: MIT
//
// suture/detail/tables.hpp - the machinery behind model.hpp: which optional
// members a struct has, the C functions that call them on packs, and the tables.
// Authors need not read it.
#ifndef SUTURE_DETAIL_TABLES_HPP
#define SUTURE_DETAIL_TABLES_HPP

#include <cstdio>

#include "suture/model.hpp"

namespace suture::detail {

// ------------------------------------------------------------ what is there --

template <class F, class Cell, class = void>
inline constexpr bool has_energy = false;
template <class F, class Cell>
inline constexpr bool
    has_energy<F, Cell, std::void_t<decltype(F::energy(std::declval<const Cell&>()))>> = true;

template <class F, class Cell, class = void>
inline constexpr bool has_bounds = false;
template <class F, class Cell>
inline constexpr bool has_bounds<
    F, Cell,
    std::void_t<decltype(F::bounds(std::declval<const Cell&>(),
                                   std::declval<bound_matrices<typename Cell::real>&>()))>> = true;

template <class F, class Cell, class = void>
inline constexpr bool has_inspect = false;
template <class F, class Cell>
inline constexpr bool
    has_inspect<F, Cell, std::void_t<decltype(F::inspect(std::declval<const Cell&>()))>> = true;

template <class F, class Cell, class = void>
inline constexpr bool has_force = false;
template <class F, class Cell>
inline constexpr bool has_force<F, Cell, std::void_t<decltype(F::force(std::declval<Cell&>()))>> =
    true;

template <class F, class Cell, class = void>
inline constexpr bool has_output = false;
template <class F, class Cell>
inline constexpr bool
    has_output<F, Cell,
               std::void_t<decltype(F::output(std::declval<const Cell&>(),
                                              std::declval<results<typename Cell::real>&>()))>> =
        true;

template <class M, class = void>
struct functors_of_model {
  using type = list<M>;  // the model is its only functor
};
template <class M>
struct functors_of_model<M, std::void_t<typename M::functors>> {
  using type = typename M::functors;
};

// ----------------------------------------------------------------- failures --

inline void describe(const suture_context* context, const suture_batch* batch, const failure& f) {
  suture_error* const e = context->error;
  if (!e) return;
  e->code = f.code;
  e->cell = UINT32_MAX;
  if (f.lane >= 0 && batch) {
    const int last = int(batch->valid) - 1;  // later lanes repeat the last valid one
    e->cell = batch->cell_ids[f.lane < last ? f.lane : last];
  }
  e->step_factor = f.step_factor;
  std::snprintf(e->text, sizeof e->text, "%s", f.what());
}

/// Reports an exception other than a failure. Allocates nothing: memory may have run out.
inline suture_status fault(const suture_context* context, const char* thrown) {
  suture_error* const e = context->error;
  if (!e) return SUTURE_FAULT;
  e->code = 0;
  e->cell = UINT32_MAX;
  e->step_factor = 0;
  std::snprintf(e->text, sizeof e->text,
                "the plugin threw an exception (%.256s); catch it, and call suture::stop() or "
                "suture::retry() where the law is not defined",
                thrown);
  return SUTURE_FAULT;
}

/// Runs `work`; an exception becomes a status and a suture_error.
template <class Work>
SUTURE_INLINE suture_status guarded(const suture_context* context, const suture_batch* batch,
                                    Work&& work) noexcept {
  try {
    work();
    return SUTURE_OK;
  } catch (const failure& f) {
    describe(context, batch, f);
    return f.status;
  } catch (const std::exception& e) {
    return fault(context, e.what());
  } catch (...) {
    return fault(context, "of a type that does not derive from std::exception");
  }
}

/// Calls work(lane) for the first lane of every pack of a batch.
template <class Work>
SUTURE_INLINE suture_status for_packs(const suture_context* context, const suture_batch* batch,
                                      Work&& work) noexcept {
  return guarded(context, batch, [&] {
    for (int lane = 0; lane < int(SUTURE_LANES); lane += native_lanes) work(lane);
  });
}

/// Reports the lane and cause of a force that is not finite; zeroes the forces of the batch.
template <int Nodes>
[[noreturn, gnu::cold, gnu::noinline]] void fail_not_finite(const suture_batch* batch) {
  int bad = -1;
  for (int lane = 0; lane < int(SUTURE_LANES) && bad < 0; ++lane)
    for (int i = 0; i < Nodes * 3; ++i)
      if (!std::isfinite(batch->force[i * int(SUTURE_LANES) + lane])) bad = lane;
  bool input = true;
  for (int i = 0; i < Nodes * 3; ++i) {
    if (batch->position) input &= std::isfinite(batch->position[i * int(SUTURE_LANES) + bad]) != 0;
    if (batch->velocity) input &= std::isfinite(batch->velocity[i * int(SUTURE_LANES) + bad]) != 0;
  }
  std::memset(batch->force, 0, sizeof(double) * Nodes * 3 * SUTURE_LANES);
  failure f(input ? SUTURE_RETRY : SUTURE_STOP,
            input ? "the force is not finite although positions and velocities are: the cell is "
                    "outside the range in which its law is valid"
                  : "positions or velocities are not finite");
  f.lane = bad;
  throw f;
}

// ---------------------------------------------------------------- functions --

/// The number of nodes whose forces must be examined to know whether a result is finite: fewer
/// than all for functors of this layer in which a value that is not finite reaches every node.
template <class F>
inline constexpr int nodes_to_check = F::nodes;

/// x - x is 0 for a finite number and NaN for infinities and NaNs. One sum per coordinate: a
/// single sum would be a chain of additions, each of which waits for the one before.
template <class M, class F>
[[gnu::flatten]] void force_pack(const suture_context* context, const suture_batch* batch,
                                 int lane) {
  cell<native, M, F, purpose::force> c(context, batch, lane, batch->force);
  F::force(c);
  const auto force = [&](int i) {
    return native::load(batch->force + i * int(SUTURE_LANES) + lane);
  };
  native sum[3] = {force(0), force(1), force(2)};
  for (int n = 1; n < nodes_to_check<F>; ++n)
    for (int i = 0; i < 3; ++i) sum[i] += force(3 * n + i);
  const native all = sum[0] + sum[1] + sum[2];
  if (__builtin_expect(any(all - all != 0.0), 0)) fail_not_finite<F::nodes>(batch);
}
template <class M, class F>
suture_status force(const suture_context* context, const suture_batch* batch) noexcept {
  return for_packs(context, batch, [&](int lane) { force_pack<M, F>(context, batch, lane); });
}

/// df of the direction (dx, dv) for the cells of one pack.
template <class M, class F>
[[gnu::noinline]] void tangent_pack(const suture_context* context, const suture_batch* batch,
                                    int lane, double* df, const double* dx, const double* dv) {
  cell<dual<native>, M, F, purpose::force> c(context, batch, lane, df, dx, dv);
  F::force(c);
}

template <class M, class F>
suture_status tangent(const suture_context* context, const suture_batch* batch, const double* dx,
                      const double* dv, double* df) noexcept {
  return for_packs(context, batch,
                   [&](int lane) { tangent_pack<M, F>(context, batch, lane, df, dx, dv); });
}

template <class M, class F>
suture_status energy(const suture_context* context, const suture_batch* batch,
                     double* out) noexcept {
  return for_packs(context, batch, [&](int lane) {
    const cell<native, M, F> c(context, batch, lane);
    store(out + lane, F::energy(c));
  });
}

/// Upper bound of the spectral radius of K = -df/dx (or -df/dv) of each cell, by
/// power iteration on the exact tangent. With the Rayleigh quotient q of the unit
/// vector x and the residual r = |Kx - q x|, the eigenvalue to which x has converged
/// lies in [q - r, q + r]; the iteration ends when r is below 3 % of q, and q + r is
/// returned, which shortens the step by at most 1.5 %.
template <class M, class F>
native spectral_bound(const suture_context* context, const suture_batch* batch, int lane,
                      bool of_velocity) {
  constexpr int count = 3 * F::nodes, stride = SUTURE_LANES;
  alignas(SUTURE_ALIGNMENT) double x[count * stride], y[count * stride], zero[count * stride] = {};
  const auto at = [lane](double* v, int i) { return v + i * stride + lane; };
  // Fractional parts of multiples of the golden ratio: no mode is orthogonal to them.
  for (int i = 0; i < count; ++i) {
    const double golden = 0.6180339887498949 * (i + 1);
    store(at(x, i), native((golden - std::floor(golden) - 0.5) * std::sqrt(12.0 / count)));
  }
  native bound(0.0);
  for (int iteration = 0; iteration < 100; ++iteration) {
    tangent_pack<M, F>(context, batch, lane, y, of_velocity ? zero : x, of_velocity ? x : zero);
    native xx(0.0), xy(0.0), yy(0.0);
    for (int i = 0; i < count; ++i) {
      const native a = native::load(at(x, i)), b = native::load(at(y, i));
      xx += a * a;
      xy += a * b;
      yy += b * b;
    }
    const auto moves = yy > 0.0;
    const native quotient = abs(xy) / xx;
    const native residual = sqrt(max(yy / xx - quotient * quotient, native(0.0)));
    bound = quotient + residual;
    if (!any(moves & (residual > 0.03 * quotient))) break;
    const native scale = select(moves, 1.0 / sqrt(select(moves, yy, native(1.0))), native(1.0));
    for (int i = 0; i < count; ++i) store(at(x, i), native::load(at(y, i)) * scale);
  }
  return bound;
}

template <class M, class F>
suture_status bounds(const suture_context* context, const suture_batch* batch, double* stiffness,
                     double* damping) noexcept {
  std::memset(stiffness, 0, sizeof(double) * F::nodes * 6 * SUTURE_LANES);
  std::memset(damping, 0, sizeof(double) * F::nodes * 6 * SUTURE_LANES);
  return for_packs(context, batch, [&](int lane) {
    bound_matrices<native> b{stiffness, damping, lane};
    if constexpr (has_bounds<F, cell<native, M, F>>) {
      const cell<native, M, F> c(context, batch, lane);
      F::bounds(c, b);
    } else {
      const auto isotropic = [](native s) { return sym3<native>{s, s, s, 0.0, 0.0, 0.0}; };
      const sym3<native> k = isotropic(spectral_bound<M, F>(context, batch, lane, false));
      for (int n = 0; n < F::nodes; ++n) b.stiffness(n, k);
      if constexpr ((F::reads & SUTURE_READ_VELOCITY) == 0) return;
      const sym3<native> d = isotropic(spectral_bound<M, F>(context, batch, lane, true));
      for (int n = 0; n < F::nodes; ++n) b.damping(n, d);
    }
  });
}

template <class M, class F>
suture_status output(const suture_context* context, const suture_batch* batch,
                     double* const* out) noexcept {
  return for_packs(context, batch, [&](int lane) {
    const cell<native, M, F> c(context, batch, lane);
    results<native> r{out, lane};
    F::output(c, r);
  });
}

template <class M, class F>
suture_status inspect(const suture_context* context, const suture_batch* batch) noexcept {
  return for_packs(context, batch, [&](int lane) {
    const cell<native, M, F, purpose::inspection> c(context, batch, lane);
    F::inspect(c);
  });
}

template <class M, class F>
std::int32_t enabled(const suture_context* context, std::uint32_t* reads) noexcept {
  return F::enabled(values(context), *reads) ? 1 : 0;
}

/// A hexahedron as a contribution receives it.
struct contributor : on_volumes {
  static constexpr std::uint32_t reads = SUTURE_READ_REST;
};
template <class M, class C>
suture_status contribute(const suture_context* context, const suture_batch* batch,
                         double* out) noexcept {
  return for_packs(context, batch, [&](int lane) {
    const cell<native, M, contributor> c(context, batch, lane);
    C::compute(c, contribution_results<native, C::components>{out, lane});
  });
}

template <class M>
suture_status prepare(const suture_context* context, void* instance) noexcept {
  return guarded(context, nullptr, [&] {
    using Constants = constants_of<M>;
    M::prepare(setup(context), *new (instance) Constants());
  });
}

template <class M, class C>
struct contribution_table {
  static constexpr suture_contribution row{sizeof(suture_contribution), SUTURE_HEXAHEDRON,
                                           &contribute<M, C>};
};

/// The extension `id` of functor F, or NULL.
template <class M, class F>
const void* extension(const char* id) noexcept {
  using Cell = cell<native, M, F>;
  const auto is = [id](const char* name) { return std::strcmp(id, name) == 0; };
  if (is(SUTURE_TANGENT_1)) {
    static constexpr suture_tangent_1 table{sizeof(suture_tangent_1), 0, &tangent<M, F>};
    return &table;
  }
  if constexpr (has_energy<F, Cell>) {
    static constexpr suture_energy_1 table{sizeof(suture_energy_1), 0, &energy<M, F>};
    if (is(SUTURE_ENERGY_1)) return &table;
  }
  if (is(SUTURE_STABLE_DT_1)) {
    static constexpr suture_stable_dt_1 table{sizeof(suture_stable_dt_1), 0, &bounds<M, F>};
    return &table;
  }
  if constexpr (has_inspect<F, cell<native, M, F, purpose::inspection>>) {
    static constexpr suture_inspect_1 table{sizeof(suture_inspect_1), 0, &inspect<M, F>};
    if (is(SUTURE_INSPECT_1)) return &table;
  }
  if constexpr (has_fields<F>) {
    static constexpr suture_output_1 table{sizeof(suture_output_1),
                                           std::uint32_t(std::size(F::fields)),
                                           std::data(F::fields), &output<M, F>};
    if (is(SUTURE_OUTPUT_1)) return &table;
  }
  return nullptr;
}

// ------------------------------------------------------------------- tables --

template <class M, class F>
constexpr void check_columns() {
  static_assert(
      are_places_of<M>(F::cell_columns.places) && are_places_of<M>(F::vertex_columns.places),
      "cell_columns or vertex_columns name a column beyond the end of the model's list of "
      "attributes; column<0> is the first attribute");
  static_assert(
      have_dimension<M>(F::cell_columns.places, F::dimension),
      "cell_columns name an attribute of a dimension other than that of the functor's cells; "
      "list attributes of vertices in vertex_columns");
  static_assert(F::cell_columns.index_of(vertex_mass.place) < 0,
                "list vertex_mass in vertex_columns, not in cell_columns");
  static_assert(
      have_dimension<M>(F::vertex_columns.places, 0),
      "vertex_columns name an attribute that does not belong to vertices; list those of the "
      "functor's own cells in cell_columns");
  static_assert(
      !share_mass<M>(F::cell_columns.places) && !share_mass<M>(F::vertex_columns.places),
      "an attribute with SUTURE_SHARED_MASS is not a column; read suture::vertex_mass instead");
}

/// A function that is present but would never be called is an error.
template <class M, class F>
constexpr void check_optional_functions() {
  using Cell = cell<native, M, F>;
  static_assert(!names_energy<F> || has_energy<F, Cell>,
                "energy() of this functor is never called: declare it as `template <class Cell> "
                "static auto energy(const Cell& cell)`");
  static_assert(!names_bounds<F> || has_bounds<F, Cell>,
                "bounds() of this functor is never called: declare it as `template <class Cell, "
                "class Bounds> static void bounds(const Cell& cell, Bounds& bounds)`");
  static_assert(!names_inspect<F> || has_inspect<F, cell<native, M, F, purpose::inspection>>,
                "inspect() of this functor is never called: declare it as `template <class Cell> "
                "static void inspect(const Cell& cell)`");
  static_assert(!names_enabled<F> || has_enabled<F>,
                "enabled() of this functor is never called: declare it as a single function, not a "
                "template: `static bool enabled(const suture::values& p, std::uint32_t& reads)`");
  static_assert(!names_output<F> || has_fields<F>,
                "output() of this functor is never called: list the fields that it sets in `static "
                "constexpr suture_field fields[]`");
  static_assert(!has_fields<F> || has_output<F, Cell>,
                "a functor with `fields` needs `template <class Cell, class Results> static void "
                "output(const Cell& cell, Results& results)`, which sets their values");
}

template <class M, class F>
constexpr void check_functor() {
  static_assert(has_nodes<F>,
                "a functor, or a model without `functors`, must derive from suture::on_vertices, "
                "on_edges, on_faces or on_volumes");
  static_assert(has_name<F> || has_id<F>, "a functor needs `static constexpr const char* name`");
  static_assert(has_doc<F>, "a functor needs `static constexpr const char* doc`");
  if constexpr (has_nodes<F>) {
    static_assert(has_force<F, cell<native, M, F, purpose::force>>,
                  "a functor needs `template <class Cell> static void force(Cell& cell)`, which "
                  "sets the force on every node");
    check_optional_functions<M, F>();
    check_columns<M, F>();
  }
}

template <class M, class F>
constexpr suture_functor functor_of() {
  check_functor<M, F>();
  suture_functor f{};
  f.size = sizeof(suture_functor);
  f.dimension = F::dimension;
  f.cell_type = F::cell_type;
  f.shape = F::shape;
  f.faces = F::faces;
  f.lanes = SUTURE_LANES;
  f.scalar = 0;
  f.reads = F::reads;
  f.alternative = F::alternative;
  f.cell_column_count = std::uint32_t(F::cell_columns.places.size());
  f.vertex_column_count = std::uint32_t(F::vertex_columns.places.size());
  f.cell_columns = F::cell_columns.places.data();
  f.vertex_columns = F::vertex_columns.places.data();
  if constexpr (has_name<F>)
    f.name = F::name;
  else
    f.name = F::id;
  f.doc = F::doc;
  f.force = &force<M, F>;
  f.extension = &extension<M, F>;
  if constexpr (has_enabled<F>) f.enabled = &enabled<M, F>;
  return f;
}

template <class M, class Functors>
struct functor_table;
template <class M, class... F>
struct functor_table<M, list<F...>> {
  static constexpr suture_functor rows[] = {functor_of<M, F>()...};
};

/// The author's array as one of the C structs.
template <class C, class Author, std::size_t N>
constexpr std::array<C, N> rows_of(const Author (&list)[N]) {
  std::array<C, N> rows{};
  for (std::size_t i = 0; i < N; ++i) rows[i] = list[i];
  return rows;
}
template <class M>
struct parameter_table {
  static constexpr auto rows = rows_of<suture_parameter>(M::parameters);
};
template <class M>
struct attribute_table {
  static constexpr auto rows = rows_of<suture_attribute>(M::attributes);
};

template <class M>
constexpr suture_model model_of() {
  static_assert(has_id<M> && has_doc<M> && has_formula<M> && has_citation<M>,
                "a model needs `static constexpr const char*` id, doc, formula and citation");
  static_assert(!names_prepare<M> || has_prepare<M>,
                "prepare() of this model is never called: declare it as a single function, not a "
                "template: `static void prepare(const suture::setup&, Constants&)`");
  using functors = functor_table<M, typename functors_of_model<M>::type>;
  suture_model m{};
  m.size = sizeof(suture_model);
  m.flags = M::flags;
  m.id = M::id;
  m.doc = M::doc;
  m.formula = M::formula;
  m.citation = M::citation;
  m.functor_count = std::uint32_t(std::size(functors::rows));
  m.functors = functors::rows;
  if constexpr (has_parameters<M>) {
    m.parameter_count = std::uint32_t(parameter_table<M>::rows.size());
    m.parameters = parameter_table<M>::rows.data();
  }
  if constexpr (has_attributes<M>) {
    m.attribute_count = std::uint32_t(attribute_table<M>::rows.size());
    m.attributes = attribute_table<M>::rows.data();
  }
  if constexpr (has_prepare<M>) {
    m.prepare = &prepare<M>;
    m.instance_bytes = sizeof(constants_of<M>);
    static_assert(
        std::is_trivially_destructible_v<constants_of<M>>,
        "Constants must be trivially destructible: the host releases them without calling a "
        "destructor");
    static_assert(alignof(constants_of<M>) <= SUTURE_ALIGNMENT,
                  "Constants must not require a larger alignment than SUTURE_ALIGNMENT");
  }
  return m;
}

template <class... M>
struct model_table {
  static constexpr suture_model rows[] = {model_of<M>()...};
};

template <class... M>
constexpr suture_plugin plugin_of(const char* id, const char* version, const char* license,
                                  const char* description) {
  suture_plugin p{};
  p.size = sizeof(suture_plugin);
  p.magic = SUTURE_MAGIC;
  p.abi_major = SUTURE_ABI_MAJOR;
  p.abi_minor = SUTURE_ABI_MINOR;
  p.lanes = SUTURE_LANES;
  p.model_count = sizeof...(M);
  p.id = id;
  p.version = version;
  p.license = license;
  p.description = description;
  p.models = model_table<M...>::rows;
  return p;
}

template <class... M>
constexpr suture_note note_of(const char* plugin_id) {
  return make_note(plugin_id, M::id...);
}

}  // namespace suture::detail

#endif
