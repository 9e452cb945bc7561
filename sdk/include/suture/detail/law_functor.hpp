// SPDX-License-Identifier: MIT
//
// suture/detail/law_functor.hpp - what trilinear and mean-gradient hexahedra of continuum.hpp have
// in common: energies and outputs. Authors need not read it.
#ifndef SUTURE_DETAIL_LAW_FUNCTOR_HPP
#define SUTURE_DETAIL_LAW_FUNCTOR_HPP

#include "suture/detail/law.hpp"

namespace suture::detail {

/// What the fields of an element are means of.
template <class M, class T>
struct mean_results {
  T volume{0.0}, energy{0.0};
  sym3<T> stress{};
  state_of<M, T> state{};

  template <int Points, class Cell>
  void add(const Cell& c, const mat3<T>& F, const T& w, int point) {
    add(F, w, material<M>(c), instant_at<M, Points>(c, F, point));
  }
  /// One function for all shapes.
  template <class Material, class At>
  [[gnu::noinline]] void add(const mat3<T>& F, const T& w, const Material& p, const At& at) {
    volume += w;
    const mat3<T> P = law_stress<M>(F, p, at);
    if constexpr (is_linear<M>())
      stress = stress + symmetric(P) * w;
    else
      stress = stress + cauchy(P, F) * w;
    for (int i = 0; i < state_components<M>(); ++i)
      numbers_of<T>(state)[i] += numbers_of<T>(at.state)[i] * w;
    if constexpr (has_energy_density<M>) energy += called_energy<M>(F, p, at) * w;
  }
  template <class Results>
  void set(const Results& out) const {
    const T share = 1.0 / volume;
    const sym3<T> mean = stress * share;
    out.set(0, mean);
    out.set(1, von_mises(mean));
    if constexpr (has_energy_density<M>) out.set(2, energy * share);
    constexpr int first = has_energy_density<M> ? 3 : 2;
    if constexpr (has_state<M>)
      for_state<M>([&](int part, int i, int number) {
        out.set(first + part, i, numbers_of<T>(state)[number] * share);
      });
  }
};

/// Output fields of every element: means over its Gauss points. For a law that is linear in
/// displacements, all stresses are the same.
template <class M>
constexpr auto fields_of_law() {
  constexpr auto stress = field("stress", "Pa", "Cauchy stress, mean of the element", 6);
  constexpr auto mises = field("von_mises", "Pa", "Equivalent stress of von Mises of it");
  constexpr auto energy = field("energy_density", "J/m^3", "Stored energy per rest volume");
  constexpr std::size_t first = has_energy_density<M> ? 3 : 2;
  std::array<suture_field, first + state_count<M>()> fields{stress, mises};
  if (has_energy_density<M>) fields[2] = energy;
  if constexpr (has_state<M>)
    for (std::size_t i = 0; i < state_count<M>(); ++i) {
      const attribute& s = M::states[i];
      fields[first + i] = field(s.name, s.unit, s.doc, int(s.components));
    }
  return fields;
}

/// What energies and outputs are sums over: the Gauss points of an element, of at most `Most`.
template <class T, int Most>
struct deformed_element {
  static constexpr int most = Most;
  int points = 0;
  mat3<T> F[Most];
  T measure[Most];              ///< m^3
  T hourglass_energy = T(0.0);  ///< J; 0 for laws without an energy

  SUTURE_INLINE void add(const mat3<T>& gradient, const T& volume) {
    F[points] = gradient;
    measure[points++] = volume;
  }
};

/// `Shape` provides deformed(cell), a function of its own that energies and outputs share, and
/// deformed<false>(cell), without the energy of hourglasses. `Points` as in instant_at().
template <class M, class Shape, int Points, bool = has_energy_density<M>>
struct law_functor : on_volumes {
  static_assert(check_law<M>());
  static constexpr bool element_parameters = varies<M>;
  static constexpr auto vertex_columns = field_columns<M>;
  static constexpr auto fields = fields_of_law<M>();

  template <class Cell, class Results>
  static void output(const Cell& c, const Results& out) {
    const auto e = Shape::deformed(c);
    mean_results<M, typename Cell::scalar> means;
    for (int p = 0; p < e.points; ++p) means.template add<Points>(c, e.F[p], e.measure[p], p);
    means.energy += e.hourglass_energy;
    means.set(out);
  }

 protected:
  template <class Cell>
  static SUTURE_INLINE void positions(const Cell& c, vec3<typename Cell::scalar> (&x)[8]) {
    for (int n = 0; n < 8; ++n) x[n] = c.position(n);
  }
};
template <class M, class Shape, int Points>
struct law_functor<M, Shape, Points, true> : law_functor<M, Shape, Points, false> {
  template <class Cell>
  static typename Cell::scalar energy(const Cell& c) {
    const auto e = Shape::deformed(c);
    auto sum = e.hourglass_energy;
    for (int p = 0; p < e.points; ++p)
      sum += e.measure[p] *
             called_energy<M>(e.F[p], material<M>(c), instant_at<M, Points>(c, e.F[p], p));
    return sum;
  }
};

}  // namespace suture::detail

#endif
