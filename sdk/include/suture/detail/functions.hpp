// SPDX-License-Identifier: MIT
//
// suture/detail/functions.hpp - the C functions of plugin.h, which call an author's functions on
// the packs of a batch. Authors need not read it.
#ifndef SUTURE_DETAIL_FUNCTIONS_HPP
#define SUTURE_DETAIL_FUNCTIONS_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <new>

#include "suture/detail/guarded.hpp"
#include "suture/detail/optional_functions.hpp"
#include "suture/detail/spectral_bound.hpp"

namespace suture::detail {

/// The number of nodes whose forces must be examined to know whether a result is finite: fewer
/// than all for functors of this layer in which a value that is not finite reaches every node.
template <class F>
inline constexpr int nodes_to_check = F::nodes;

/// The force or the rate of a functor.
template <class F, class Cell>
SUTURE_INLINE void set_result(Cell& c) {
  if constexpr (has_rate_of<F>)
    F::rate(c);
  else
    F::force(c);
}

/// x - x is 0 for a finite number and NaN for infinities and NaNs. One sum per coordinate: a
/// single sum would be a chain of additions, each of which waits for the one before.
template <class M, class F>
SUTURE_DETAIL_FLATTENED void force_pack(const suture_context* context, const suture_batch* batch,
                                        int lane) {
  cell<native, M, F, purpose::force> c(context, batch, lane, batch->force);
  set_result<F>(c);
  const auto force = [&](int i) {
    return native::load(batch->force + i * int(SUTURE_LANES) + lane);
  };
  native sum[3] = {force(0), force(1), force(2)};
  for (int n = 1; n < nodes_to_check<F>; ++n)
    for (int i = 0; i < 3; ++i) sum[i] += force(3 * n + i);
  const native all = sum[0] + sum[1] + sum[2];
  if (__builtin_expect(any(all - all != 0.0), 0))
    fail_not_finite<F::nodes>(batch, has_rate_of<F> ? "rate" : "force");
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
  set_result<F>(c);
}

template <class M, class F>
suture_status tangent(const suture_context* context, const suture_batch* batch, const double* dx,
                      const double* dv, double* df) noexcept {
  return for_packs(context, batch,
                   [&](int lane) { tangent_pack<M, F>(context, batch, lane, df, dx, dv); });
}

/// The functor that a functor's tangent in single precision calls: itself, or another that computes
/// the same from what takes less memory.
template <class F>
struct functor_in_single {
  using type = F;
};

template <class M, class F>
[[gnu::noinline]] void single_tangent_pack(const suture_context* context,
                                           const suture_single_batch* batch, int lane, float* df,
                                           const float* dx, const float* dv) {
  cell<dual<native_single>, M, F, purpose::force> c(context, batch, lane, df, dx, dv);
  set_result<F>(c);
}

template <class M, class F>
suture_status single_tangent(const suture_context* context, const suture_single_batch* batch,
                             const float* dx, const float* dv, float* df) noexcept {
  return for_packs<native_single>(context, batch, [&](int lane) {
    single_tangent_pack<M, F>(context, batch, lane, df, dx, dv);
  });
}

template <class M, class F>
suture_status energy(const suture_context* context, const suture_batch* batch,
                     double* out) noexcept {
  return for_packs(context, batch, [&](int lane) {
    const cell<native, M, F> c(context, batch, lane);
    store(out + lane, F::energy(c));
  });
}

template <class M, class F>
suture_status dissipation(const suture_context* context, const suture_batch* batch,
                          double* out) noexcept {
  return for_packs(context, batch, [&](int lane) {
    const cell<native, M, F> c(context, batch, lane);
    store(out + lane, F::dissipation(c));
  });
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
      const auto largest = [&](bool of_damping) {
        const native s =
            largest_eigenvalue<3 * F::nodes>(context, batch, lane, &tangent_pack<M, F>, of_damping);
        return sym3<native>{s, s, s, 0.0, 0.0, 0.0};
      };
      const sym3<native> k = largest(false);
      for (int n = 0; n < F::nodes; ++n) b.stiffness(n, k);
      if constexpr ((F::reads & SUTURE_READ_VELOCITY) == 0) return;
      const sym3<native> d = largest(true);
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
  static constexpr bool contributes = true, element_parameters = true;
};
template <class M, class C>
suture_status contribute(const suture_context* context, const suture_batch* batch,
                         double* out) noexcept {
  return for_packs(context, batch, [&](int lane) {
    const cell<native, M, contributor> c(context, batch, lane);
    C::compute(c, contribution_results<native, C::components>{out, lane});
  });
}

/// What the layer above derives. `material`: what a law without Constants reads.
template <class M, class Material>
void prepare_added(const setup& p, const Material& material, prepared<M>& memory) {
  if constexpr (std::is_same_v<constants_of<M>, no_constants>)
    M::prepare_added(p, material, memory.added);
  else
    M::prepare_added(p, memory.constants, memory.added);
}

template <class M>
suture_status prepare(const suture_context* context, void* instance) noexcept {
  return guarded<suture_batch>(context, nullptr, [&] {
    auto& memory = *new (instance) prepared<M>();
    const setup p(context);
    if constexpr (has_prepare<M>) M::prepare(p, memory.constants);
    if constexpr (adds_constants<M> && !varies<M>)
      prepare_added<M>(p, static_cast<const values&>(p), memory);
  });
}

/// The parameters of one element, as those of an instance. `reports`: whether findings are passed
/// on.
template <class M>
struct element_context {
  suture_context context;
  suture_host host;
  std::array<double, parameter_count<M>() + M::added_parameters().size()> numbers;

  element_context(const suture_context& of_instance, const suture_batch& batch, int lane,
                  bool reports)
      : context(of_instance), host(*of_instance.host) {
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = of_instance.parameters[i];
    for (std::size_t i = 0; i < parameter_count<M>(); ++i)
      if (is_per_element<M>(i) && M::parameters[i].type != SUTURE_DIRECTION)
        numbers[i] = batch.cell_columns[element_places<M>[i]][lane];
    context.parameters = numbers.data();
    if (reports) return;
    host.report = [](const suture_context*, std::int32_t, std::uint32_t, const char*, const char*) {
    };
    context.host = &host;
  }
  element_context(const element_context&) = delete;
};

/// Fills what element `lane` of the batch stores: Constants or, if `Added`, what is derived from
/// them. Findings name the element only where the parameters differ.
template <class M, bool Added>
void derive_of_element(const suture_context* context, const suture_batch* batch, int lane,
                       bool uniform, double* out) {
  const std::uint32_t cell = uniform ? UINT32_MAX : batch->cell_ids[lane];
  const element_context<M> element(*context, *batch, lane, true);
  prepared<M> memory{};
  if constexpr (has_element_constants<M>) {
    const element_context<M> silent(*context, *batch, lane, false);  // said for Constants already
    M::prepare(setup(Added ? &silent.context : &element.context, cell), memory.constants);
  }
  if constexpr (Added)
    prepare_added<M>(
        setup(&element.context, cell),
        element_values<double, M, int(SUTURE_LANES)>(context, batch->cell_columns, lane), memory);
  if constexpr (Added)
    std::memcpy(out, &memory.added, sizeof memory.added);
  else
    std::memcpy(out, &memory.constants, sizeof memory.constants);
}

template <class M, bool Added>
suture_status element_constants(const suture_context* context, const suture_batch* batch,
                                double* out) noexcept {
  return guarded(context, batch, [&] {
    constexpr int lanes = SUTURE_LANES;
    double row[9];
    const std::size_t count =
        (Added ? sizeof(prepared<M>::added) : sizeof(prepared<M>::constants)) / sizeof(double);
    const double* const p = context->parameters;
    const bool uniform =
        std::none_of(p, p + context->parameter_count, [](double x) { return std::isnan(x); });
    for (int lane = 0; lane < lanes; ++lane) {
      if (lane == 0 || (!uniform && lane < int(batch->valid)))
        derive_of_element<M, Added>(context, batch, lane, uniform, row);
      for (std::size_t i = 0; i < count; ++i) out[i * lanes + std::size_t(lane)] = row[i];
    }
  });
}

}  // namespace suture::detail

#endif
