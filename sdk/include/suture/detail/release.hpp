// SPDX-License-Identifier: MIT
//
// suture/detail/release.hpp - the functor of a law that changes the field it reads: its release().
// Authors need not read it.
#ifndef SUTURE_DETAIL_RELEASE_HPP
#define SUTURE_DETAIL_RELEASE_HPP

#include "suture/detail/law_functor.hpp"
#include "suture/diffusion.hpp"

namespace suture::detail {

/// The places of the field and, if the law declares it, of its rate.
template <class M>
inline constexpr std::uint32_t field_place = field_columns<M>.places[0];
template <class M>
constexpr std::uint32_t rate_place() {
  if constexpr (has_vertex_fields<M>)
    for (std::size_t i = 0; i < field_attribute_count<M>(); ++i)
      if ((M::vertex_fields[i].flags & SUTURE_FIELD_RATE) != 0)
        return field_place<M> + std::uint32_t(i);
  return UINT32_MAX;
}
template <class M>
inline constexpr bool follows_rates = rate_place<M>() != UINT32_MAX;
template <class M>
constexpr auto release_columns() {
  if constexpr (follows_rates<M>)
    return column_list<field_place<M>, rate_place<M>()>();
  else
    return column_list<field_place<M>>();
}

/// Values at the nodes of the eight points with two per axis, x fastest, and the transpose.
template <class T>
SUTURE_INLINE void values_at_points(const T (&u)[8], T (&at)[8]) {
  T x[8], y[8];
  for (int m = 0; m < 4; ++m) to_points<2>(u[2 * m], u[2 * m + 1], &x[2 * m], 1);
  for (int m = 0; m < 4; ++m) {
    const int low = m % 2 + m / 2 * 4;
    to_points<2>(x[low], x[low + 2], &y[low], 2);
  }
  for (int m = 0; m < 4; ++m) to_points<2>(y[m], y[m + 4], &at[m], 4);
}
template <class T>
SUTURE_INLINE void add_to_nodes(const T (&at)[8], T (&r)[8]) {
  T x[8], y[8];
  for (int m = 0; m < 4; ++m) to_ends<2>(&at[m], 4, y[m], y[m + 4]);
  for (int m = 0; m < 4; ++m) {
    const int low = m % 2 + m / 2 * 4;
    to_ends<2>(&y[low], 2, x[low], x[low + 2]);
  }
  for (int m = 0; m < 4; ++m) {
    T low, high;
    to_ends<2>(&x[2 * m], 1, low, high);
    r[2 * m] += low;
    r[2 * m + 1] += high;
  }
}

/// `Shape` provides inverse_at(cell), a function of the point (i, j, k) with J^-1 there.
///   r_n = integral of N_n source + grad N_n . flow        2 x 2 x 2 points
template <class M, class Shape>
struct release_functor : on_volumes {
  static_assert(field_count<M>() == 1 && field_components<M>() == 1,
                "release() changes the one field of `vertex_fields`, of one component");
  static constexpr const char* doc = "What the law releases into its field";
  static constexpr std::uint32_t reads =
      SUTURE_READ_POSITION | (follows_rates<M> ? SUTURE_READ_VELOCITY : 0);
  static constexpr bool element_parameters = varies<M>;
  static constexpr column<field_place<M>> rate_of{};
  static constexpr auto vertex_columns = release_columns<M>();

  static bool enabled(const values& p, std::uint32_t&) { return is_trilinear<M>(p); }

  template <class Cell>
  [[gnu::noinline]] static void rate(const Cell& c) {
    using T = typename Cell::scalar;
    T r[8], source[8];
    auto flows = scalar_gradients<T>::zero();
    for_points(c, [&](int i, int j, int k, const auto& weight, const auto& inverse, const auto& F,
                      const auto& at) SUTURE_DETAIL_INLINED {
      const released<T> out = M::release(F, material<M>(c), at);
      source[point_number<2>(i, j, k)] = weight * out.source;
      flows.subtract(i, j, k, inverse * weight, out.flow);
    });
    flows.scatter(r);
    add_to_nodes(source, r);
    for (int n = 0; n < 8; ++n) c.rate(n, r[n]);
  }

 protected:
  /// Calls visit(measure, F, field_point) at every Gauss point.
  template <class Cell, class Visit>
  static void for_measures(const Cell& c, const Visit& visit) {
    for_points(c, [&](int, int, int, const auto& weight, const auto&, const auto& F,
                      const auto& at) { visit(weight, F, at); });
  }
  template <class Cell>
  static typename Cell::scalar hourglass_energy(const Cell&) {
    return typename Cell::scalar(0.0);
  }
  template <class Cell>
  static typename Cell::scalar power(const Cell& c) {
    typename Cell::scalar sum(0.0);
    for_measures(c, [&](const auto& measure, const auto&, const auto& at) {
      sum += measure * M::dissipation(material<M>(c), at);
    });
    return sum;
  }
  /// Calls visit(i, j, k, weight, J^-1, F, field_point) at every Gauss point.
  template <class Cell, class Visit>
  static SUTURE_INLINE void for_points(const Cell& c, const Visit& visit) {
    using T = typename Cell::scalar;
    using R = typename Cell::real;
    vec3<R> x[8], v[8];
    T u[8], du[8], value[8], field_rate[8];
    for (int n = 0; n < 8; ++n) {
      x[n] = c.position(n);
      u[n] = c.field(n);
      if constexpr (follows_rates<M>) {
        v[n] = c.velocity(n);
        du[n] = c.field_rate(n);
      }
    }
    const axis_values<R, 2> gradients = suture::gradients<2>(x);
    scalar_gradients<T> field_gradients(u);
    values_at_points(u, value);
    field_point<T> at{};
    at.time = c.time();
    at.dt = c.dt();
    const auto inverse_at = Shape::inverse_at(c);
    axis_values<R, 2> velocity_gradients;
    if constexpr (follows_rates<M>) {
      velocity_gradients = suture::gradients<2>(v);
      values_at_points(du, field_rate);
      at.mean_rate = mean_of(field_rate, inverse_at);
    }
    for_each_point<2, false>([&](int i, int j, int k) SUTURE_DETAIL_INLINED {
      const int point = point_number<2>(i, j, k);
      const mat3<R> inverse = inverse_at(i, j, k);
      at.field = value[point];
      at.gradient = field_gradients.in_space(i, j, k, inverse);
      if constexpr (follows_rates<M>) {
        at.rate = field_rate[point];
        at.dF = velocity_gradients.at(i, j, k) * inverse;
      }
      const R weight = common_weight<2> / det(inverse);
      visit(i, j, k, weight, inverse, gradients.at(i, j, k) * inverse, std::as_const(at));
    });
  }

 private:
  template <class T, class Inverse>
  static SUTURE_INLINE T mean_of(const T (&values)[8], const Inverse& inverse_at) {
    T sum(0.0);
    real_of<T> volume(0.0);
    for (int p = 0; p < 8; ++p) {
      const auto measure = 1.0 / det(inverse_at(p & 1, (p >> 1) & 1, p >> 2));
      sum += measure * values[p];
      volume += measure;
    }
    return sum / volume;
  }
};

/// `Release` with the energy of the law and of its field; with dissipation(), energy() without the
/// field.
template <class M, class Release, bool = has_field_energy<M> || has_field_dissipation<M>>
struct release_with_energy : Release {};
template <class M, class Release>
struct release_with_energy<M, Release, true> : Release {
  template <class Cell>
  static typename Cell::scalar energy(const Cell& c) {
    using T = typename Cell::scalar;
    T sum = Release::hourglass_energy(c);
    Release::for_measures(c, [&](const auto& measure, const auto& F, const auto& at) {
      instant_of<M, T> of_law{};
      of_law.time = at.time;
      of_law.dt = at.dt;
      of_law.field[0] = has_field_dissipation<M> ? T(0.0) : at.field;
      sum += measure * called_energy<M>(F, material<M>(c), of_law);
      if constexpr (has_field_energy<M>) sum += measure * M::field_energy(material<M>(c), at);
    });
    return sum;
  }
};
/// The same with the power that the law dissipates.
template <class M, class Release, bool = has_field_dissipation<M>>
struct release_with_sums : release_with_energy<M, Release> {};
template <class M, class Release>
struct release_with_sums<M, Release, true> : release_with_energy<M, Release> {
  template <class Cell>
  static typename Cell::scalar dissipation(const Cell& c) {
    return Release::power(c);
  }
};

template <class M>
struct release_in_parallelepipeds
    : release_with_sums<M, release_functor<M, release_in_parallelepipeds<M>>> {
  static constexpr const char* name = "release in parallelepipeds";
  static constexpr std::uint32_t shape = SUTURE_PARALLELEPIPED, alternative = 4;
  static constexpr column<0> jacobian{};
  static constexpr auto cell_columns = columns(jacobian);

  template <class Cell>
  static SUTURE_INLINE auto inverse_at(const Cell& c) {
    mat3<typename Cell::real> inverse;
    read_inverse(c, jacobian, inverse);
    return [inverse](int, int, int) SUTURE_DETAIL_INLINED { return inverse; };
  }
};

template <class M>
struct release_in_general_hexahedra
    : release_with_sums<M, release_functor<M, release_in_general_hexahedra<M>>> {
  static constexpr const char* name = "release in general hexahedra";
  static constexpr std::uint32_t shape = SUTURE_GENERAL, alternative = 3;
  static constexpr std::uint32_t reads =
      SUTURE_READ_REST | release_in_general_hexahedra::release_functor::reads;

  template <class Cell>
  static SUTURE_INLINE auto inverse_at(const Cell& c) {
    vec3<typename Cell::real> X[8];
    for (int n = 0; n < 8; ++n) X[n] = c.rest(n);
    return [rest = gradients<2>(X)](int i, int j, int k)
               SUTURE_DETAIL_INLINED { return inverse(rest.at(i, j, k)); };
  }
};

}  // namespace suture::detail

#endif
