// SPDX-License-Identifier: MIT
//
// suture/detail/rest_stiffness.hpp - the stiffness at rest of laws with directions, stored with the
// elements for bending_samples.hpp. Authors need not read it.
#ifndef SUTURE_DETAIL_REST_STIFFNESS_HPP
#define SUTURE_DETAIL_REST_STIFFNESS_HPP

#include "suture/bending_samples.hpp"
#include "suture/detail/law.hpp"

namespace suture::detail {

using rest_stiffness = anisotropic_out_of_plane<double>;

/// The mean over the strains of near_rest().
template <class M, class Material>
rest_stiffness stiffness_at_rest(const Material& p) {
  using T = dual<double>;
  rest_stiffness mean{};
  for (int sample = 0; sample < rest_samples; ++sample) {
    const mat3<double> F0 = near_rest(sample);
    for (int k = 0; k < 3; ++k)
      for (int l = k; l < 3; ++l) {
        mat3<T> F;
        for (int i = 0; i < 9; ++i) F(i / 3, i % 3) = T(F0(i / 3, i % 3));
        F(k, l).derivative += 0.5;
        F(l, k).derivative += 0.5;
        auto at = first_instant<M, T>();
        if constexpr (has_state<M>) M::evolve(F, p, at);
        const sym3<T> P = symmetric(law_stress<M>(F, p, at));
        const int column = sym3<T>::index(k, l);
        for (int i = 0; i <= column; ++i)
          mean.C[rest_stiffness::place(i, column)] += P.c[i].derivative * (1.0 / rest_samples);
      }
  }
  return mean;
}

/// A third of the 21 numbers, as an attribute of at most nine components.
constexpr int rest_stiffness_parts = 3, rest_stiffness_share = 7;
template <class M, int Part>
suture_status rest_stiffness_share_of(const suture_context* context, const suture_batch* batch,
                                      double* out) noexcept {
  return guarded(context, batch, [&] {
    for (int lane = 0; lane < int(SUTURE_LANES); ++lane) {
      const element_context<M> element(*context, *batch, lane, false);
      prepared<M> memory{};
      rest_stiffness all;
      if constexpr (has_element_constants<M>) {
        M::prepare(setup(&element.context), memory.constants);
        all = stiffness_at_rest<M>(memory.constants);
      } else {
        all = stiffness_at_rest<M>(
            element_values<double, M, int(SUTURE_LANES)>(context, batch->cell_columns, lane));
      }
      for (int i = 0; i < rest_stiffness_share; ++i)
        out[i * int(SUTURE_LANES) + lane] = all.C[Part * rest_stiffness_share + i];
    }
  });
}
template <class M, int Part>
struct rest_stiffness_row {
  static constexpr suture_contribution row{sizeof(suture_contribution), SUTURE_HEXAHEDRON,
                                           &rest_stiffness_share_of<M, Part>};
  static constexpr attribute of_elements(const char* name) {
    attribute a = volume_attribute(name, "Pa", "Stiffness at rest", rest_stiffness_share)
                      .flag(SUTURE_FROM_PARAMETERS | SUTURE_INTERNAL);
    a.policy = SUTURE_FROM_VOLUMES;
    a.contribution_count = 1;
    a.contributions = &row;
    return a;
  }
};

/// Whether the elements of a law store its stiffness at rest.
template <class M>
inline constexpr bool stores_stiffness = is_sampled<M>&& has_directions<M>();

/// What the layer adds to the attributes of a law: states, fields, and the stiffness at rest.
template <class M>
constexpr auto added_attributes_of() {
  constexpr auto others = attributes_of_law<M>();
  if constexpr (stores_stiffness<M>) {
    std::array<attribute, others.size() + rest_stiffness_parts> all{};
    for (std::size_t i = 0; i < others.size(); ++i) all[i] = others[i];
    all[others.size()] = rest_stiffness_row<M, 0>::of_elements("stiffness_at_rest_1");
    all[others.size() + 1] = rest_stiffness_row<M, 1>::of_elements("stiffness_at_rest_2");
    all[others.size() + 2] = rest_stiffness_row<M, 2>::of_elements("stiffness_at_rest_3");
    return all;
  } else {
    return others;
  }
}
template <class M>
constexpr auto rest_stiffness_columns() {
  constexpr std::uint32_t first =
      std::uint32_t(first_added_attribute<M> + state_count<M>() * 8 + field_attribute_count<M>());
  if constexpr (stores_stiffness<M>)
    return column_list<first, first + 1, first + 2>();
  else
    return column_list<>();
}

/// The columns of a law on mean-gradient elements.
template <class M>
inline constexpr int mean_points = is_sampled<M> ? bending_samples : 1;
template <class M>
inline constexpr auto mean_columns = joined(state_columns<M, mean_points<M>>,
                                            rest_stiffness_columns<M>());

}  // namespace suture::detail

#endif
