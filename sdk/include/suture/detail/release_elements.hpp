// SPDX-License-Identifier: MIT
//
// suture/detail/release_elements.hpp - release() of a law on mean-gradient elements, and on
// elements of which only a part is material. Authors need not read it.
//
// A deformation gradient and a weight come from the functor of the forces, so that both halves
// belong to one energy. The field is interpolated in the trilinear element, whose geometry gives
// its gradient: that of the deformation x = (u, 0, 0).
//   r_n = sum_p w_p N_n(p) source_p + v_p grad N_n(p) . flow_p     2 x 2 x 2 points
// v_p: weights of the geometry. Elements with 8 deformation gradients have w_p = v_p and the field
// at the points. A mean gradient meets the mean of the nodes, and w_p is an eighth of the volume.
#ifndef SUTURE_DETAIL_RELEASE_ELEMENTS_HPP
#define SUTURE_DETAIL_RELEASE_ELEMENTS_HPP

#include "suture/detail/release.hpp"

namespace suture::detail {

/// A cell without derivatives; `of_velocity`: with velocities in place of positions.
template <class Cell, bool of_velocity = false>
struct plain_cell {
  using scalar = typename Cell::real;
  using real = scalar;
  static constexpr bool sets_forces = false;
  const Cell& c;

  SUTURE_INLINE vec3<real> rest(int node) const { return c.rest(node); }
  SUTURE_INLINE vec3<real> position(int node) const {
    if constexpr (of_velocity)
      return c.velocity(node);
    else
      return c.position(node);
  }
  template <class... Places>
  SUTURE_INLINE real column(Places... places) const {
    return c.column(places...);
  }
  decltype(auto) added_constants() const { return c.added_constants(); }
  auto parameters() const { return c.parameters(); }
  auto uniform_parameters() const { return c.uniform_parameters(); }
};

/// `Force`: the functor of the forces; `Whole`: that of trilinear elements, or parts of them, of
/// the same shape.
template <class M, class Force, class Whole>
struct release_beside : on_volumes {
  static constexpr const char* doc = "What the law releases into its field";
  static constexpr std::uint32_t shape = Force::shape;
  static constexpr std::uint32_t reads =
      Force::reads | (follows_rates<M> ? SUTURE_READ_VELOCITY : 0);
  static constexpr bool element_parameters = varies<M>;
  static constexpr bool added_element_constants = Force::added_element_constants;
  static constexpr auto cell_columns = Force::cell_columns;
  static constexpr column<field_place<M>> rate_of{};
  static constexpr auto vertex_columns = release_columns<M>();

  template <class Cell>
  [[gnu::noinline]] static void rate(const Cell& c) {
    using T = typename Cell::scalar;
    const element_of_law<Cell> e(c);
    T source[8], r[8];
    vec3<T> f[8];
    Whole::template with_geometry<2>(plain_cell<Cell>{c}, [&](const auto& g) {
      internal_force<2, false>(
          e.fields, g,
          [&](const mat3<T>& gradient, int point) {
            const released<T> out =
                M::release(e.F(point), material<M>(c), e.at(c, first_row(gradient), point));
            source[point] = e.weight(point) * out.source;
            mat3<T> P{};
            for (int d = 0; d < 3; ++d) P(0, d) = -out.flow[d];
            return P;
          },
          f);
    });
    for (int n = 0; n < 8; ++n) r[n] = f[n][0];
    add_to_nodes(source, r);
    for (int n = 0; n < 8; ++n) c.rate(n, r[n]);
  }

 protected:
  /// Calls visit(measure, F, field point) for every point.
  template <class Cell, class Visit>
  static void for_measures(const Cell& c, const Visit& visit) {
    const element_of_law<Cell> e(c);
    for_gradients(c, e, [&](const auto& measure, const auto& gradient, int point) {
      visit(measure, e.F(point), e.at(c, first_row(gradient), point));
    });
  }
  template <class Cell>
  static auto hourglass_energy(const Cell& c) {
    return Force::template deformed<true>(plain_cell<Cell>{c}).hourglass_energy;
  }
  /// With the weights that flow and source have in rate(): what depends on the rate of the field is
  /// due to the source.
  template <class Cell>
  static typename Cell::scalar power(const Cell& c) {
    using T = typename Cell::scalar;
    const element_of_law<Cell> e(c);
    T sum(0.0);
    for_gradients(c, e, [&](const auto& measure, const auto& gradient, int point) {
      field_point<T> at = e.at(c, first_row(gradient), point);
      at.field = e.value[point];
      const T of_both = M::dissipation(material<M>(c), at);
      at.rate = at.mean_rate;
      const T of_flow = M::dissipation(material<M>(c), at);
      sum += measure * of_flow + e.weight(point) * (of_both - of_flow);
    });
    return sum;
  }

  /// Calls visit(measure, gradient of fields, number) for every point.
  template <class Cell, class Element, class Visit>
  static void for_gradients(const Cell& c, const Element& e, const Visit& visit) {
    Whole::template with_geometry<2>(plain_cell<Cell>{c}, [&](const auto& g) {
      int point = 0;
      for_deformations<2>(e.fields, g, [&](const auto& gradient, const auto& measure) {
        visit(measure, gradient, point++);
      });
    });
  }
  template <class T>
  static SUTURE_INLINE vec3<T> first_row(const mat3<T>& m) {
    return {m(0, 0), m(0, 1), m(0, 2)};
  }
  /// What the points of an element have in common.
  template <class Cell>
  struct element_of_law {
    using T = typename Cell::scalar;
    using R = typename Cell::real;
    decltype(Force::template deformed<false>(std::declval<const plain_cell<Cell>&>())) now, moving;
    vec3<T> fields[8];      ///< (u, 0, 0)
    T value[8], change[8];  ///< the field and its rate at the points
    T mean_value{0.0}, mean_change{0.0};

    explicit element_of_law(const Cell& c)
        : now(Force::template deformed<false>(plain_cell<Cell>{c})) {
      T u[8], du[8];
      for (int n = 0; n < 8; ++n) {
        u[n] = c.field(n);
        fields[n] = {u[n], T(0.0), T(0.0)};
        mean_value += u[n] * 0.125;
      }
      values_at_points(u, value);
      if constexpr (follows_rates<M>) {
        moving = Force::template deformed<false>(plain_cell<Cell, true>{c});
        for (int n = 0; n < 8; ++n) du[n] = c.field_rate(n);
        values_at_points(du, change);
        R volume(0.0);
        for (int p = 0; p < 8; ++p) {
          mean_change += weight(p) * change[p];
          volume += weight(p);
        }
        mean_change = mean_change / volume;
      }
    }
    static constexpr bool is_mean = decltype(now)::most == 1;
    static int place(int point) { return is_mean ? 0 : point; }
    const mat3<R>& F(int point) const { return now.F[place(point)]; }
    R weight(int point) const { return now.measure[place(point)] * R(is_mean ? 0.125 : 1.0); }
    SUTURE_INLINE field_point<T> at(const Cell& c, const vec3<T>& gradient, int point) const {
      field_point<T> at{};
      at.time = c.time();
      at.dt = c.dt();
      at.field = is_mean ? mean_value : value[point];
      at.gradient = gradient;
      if constexpr (follows_rates<M>) {
        at.rate = change[point];
        at.mean_rate = mean_change;
        at.dF = moving.F[place(point)];
      }
      return at;
    }
  };
};

/// Those of elements of which only a part is material have energies, as those of whole ones.
template <class M>
struct release_in_parallelepiped_parts
    : release_with_sums<M, release_beside<M, parallelepiped_parts<M>, parallelepiped_parts<M>>> {
  static constexpr const char* name = "release in parts of parallelepipeds";
};
template <class M>
struct release_in_hexahedron_parts
    : release_with_sums<M, release_beside<M, hexahedron_parts<M>, hexahedron_parts<M>>> {
  static constexpr const char* name = "release in parts of general hexahedra";
};
template <class M>
struct functor_on_parts<release_in_parallelepipeds<M>> {
  using type = release_in_parallelepiped_parts<M>;
};
template <class M>
struct functor_on_parts<release_in_general_hexahedra<M>> {
  using type = release_in_hexahedron_parts<M>;
};

template <class M, class Force, class Whole>
struct release_at_mean : release_with_sums<M, release_beside<M, Force, Whole>> {
  static bool enabled(const values& p, std::uint32_t&) { return !is_trilinear<M>(p); }
};
/// The same in whole elements, with gradients of one field in place of three. `Trilinear`: the
/// functor of trilinear elements of the same shape. One loop without calls, so that the compiler
/// evaluates once what is the same at all points.
template <class M, class Force, class Whole, class Trilinear>
struct release_in_whole : release_at_mean<M, Force, Whole> {
  template <class Cell>
  [[gnu::noinline]] static void rate(const Cell& c) {
    using T = typename Cell::scalar;
    const typename release_in_whole::template element_of_law<Cell> e(c);
    const mat3<typename Cell::real> F = e.F(0);
    const auto inverse_at = Trilinear::inverse_at(c);
    T u[8], r[8], source[8];
    for (int n = 0; n < 8; ++n) u[n] = e.fields[n][0];
    scalar_gradients<T> gradients(u), flows = scalar_gradients<T>::zero();
    for_each_point<2, false>([&](int i, int j, int k) SUTURE_DETAIL_INLINED {
      const int point = point_number<2>(i, j, k);
      const auto inverse = inverse_at(i, j, k);
      const released<T> out =
          M::release(F, material<M>(c), e.at(c, gradients.in_space(i, j, k, inverse), point));
      source[point] = e.weight(point) * out.source;
      flows.subtract(i, j, k, inverse * (common_weight<2> / det(inverse)), out.flow);
    });
    flows.scatter(r);
    add_to_nodes(source, r);
    for (int n = 0; n < 8; ++n) c.rate(n, r[n]);
  }
};
template <class M>
struct mean_release_in_parallelepipeds
    : release_in_whole<M, mean_gradient_parallelepipeds<M>, parallelepipeds<M>,
                       release_in_parallelepipeds<M>> {
  static constexpr const char* name = "release in parallelepipeds, mean gradient";
  static constexpr std::uint32_t alternative = 4;
};
template <class M>
struct mean_release_in_hexahedra
    : release_in_whole<M, mean_gradient_hexahedra<M>, general_hexahedra<M>,
                       release_in_general_hexahedra<M>> {
  static constexpr const char* name = "release in general hexahedra, mean gradient";
  static constexpr std::uint32_t alternative = 3;
};
template <class M>
struct mean_release_in_parallelepiped_parts
    : release_at_mean<M, mean_gradient_parts<M>, parallelepiped_parts<M>> {
  static constexpr const char* name = "release in parts of parallelepipeds, mean gradient";
};
template <class M>
struct mean_release_in_hexahedron_parts
    : release_at_mean<M, mean_gradient_hexahedron_parts<M>, hexahedron_parts<M>> {
  static constexpr const char* name = "release in parts of general hexahedra, mean gradient";
};
template <class M>
struct functor_on_parts<mean_release_in_parallelepipeds<M>> {
  using type = mean_release_in_parallelepiped_parts<M>;
};
template <class M>
struct functor_on_parts<mean_release_in_hexahedra<M>> {
  using type = mean_release_in_hexahedron_parts<M>;
};

template <class M>
using release_functors = list<release_in_parallelepipeds<M>, release_in_general_hexahedra<M>,
                              mean_release_in_parallelepipeds<M>, mean_release_in_hexahedra<M>>;

}  // namespace suture::detail

#endif
