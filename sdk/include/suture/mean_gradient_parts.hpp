// SPDX-License-Identifier: MIT
//
// suture/mean_gradient_parts.hpp - rest shapes of mean_gradient.hpp for elements of which only a
// part is material.
#ifndef SUTURE_MEAN_GRADIENT_PARTS_HPP
#define SUTURE_MEAN_GRADIENT_PARTS_HPP

#include "suture/mean_gradient.hpp"

namespace suture {

/// A parallelepiped of which only a part is material (`part_moments` of hexahedron.hpp). Its edges
/// are those whose gradient is the mean over the part,
///   A_x + first_y h_xy + first_z h_xz + second_yz h_xyz,
/// and likewise for y and z. The law and the hourglass energy see them alone, so that nothing
/// depends on how the rest of the element is deformed.
template <class Rest, class R>
struct part_rest : Rest {
  vec3<R> first, second;

  template <class T>
  SUTURE_INLINE void separate(nodal_modes<T>& now) const {
    const vec3<T>(&h)[4] = now.hourglass;
    for (int i = 0; i < 3; ++i) {
      const int a = (i + 1) % 3, b = (i + 2) % 3;
      now.edge.column[i] += h[b] * first[a] + h[a] * first[b] + h[3] * second[i];
    }
  }
  template <class T>
  SUTURE_INLINE void unite(nodal_modes<T>& pull) const {
    const vec3<T>(&e)[3] = pull.edge.column;
    for (int i = 0; i < 3; ++i) {
      const int a = (i + 1) % 3, b = (i + 2) % 3;
      pull.hourglass[i] += e[b] * first[a] + e[a] * first[b];
    }
    pull.hourglass[3] += e[0] * second[0] + e[1] * second[1] + e[2] * second[2];
  }
};

/// Any hexahedron of which only a part is material (`general_part` of hexahedron_geometry.hpp). In
/// the frame of its mean edges, the mean of grad h_k over the part is beta_k + d_k. As above, its
/// edges are those whose gradient is the mean over the part,
///   A + sum_k g_k (x) (beta_k + d_k).
template <class R>
struct hexahedron_part_rest : parallelepiped_rest<R> {
  vec3<R> gamma[4], mean[4];

  /// `whole`: its stiffness times the fraction.
  template <class Part>
  SUTURE_INLINE hexahedron_part_rest(const hexahedron_rest<R>& whole, const Part& part)
      : parallelepiped_rest<R>(whole) {
    this->volume = whole.volume * part.fraction;
    for (int k = 0; k < 4; ++k) {
      gamma[k] = whole.gamma[k];
      mean[k] = part.more[k];
      if (k < 3) mean[k] += whole.beta[k];
    }
  }

  template <class T>
  SUTURE_INLINE void separate(nodal_modes<T>& now) const {
    for (int k = 0; k < 4; ++k) now.hourglass[k] -= now.edge * gamma[k];
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < 3; ++i) now.edge.column[i] += now.hourglass[k] * mean[k][i];
  }
  template <class T>
  SUTURE_INLINE void unite(nodal_modes<T>& pull) const {
    for (int k = 0; k < 4; ++k) pull.hourglass[k] += pull.edge * mean[k];
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < 3; ++i) pull.edge.column[i] -= pull.hourglass[k] * gamma[k][i];
  }
};

}  // namespace suture

#endif
