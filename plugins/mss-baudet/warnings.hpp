// SPDX-License-Identifier: MIT
//
// The warnings about rest shapes for which the model's known weaknesses matter.
#ifndef MSS_BAUDET_WARNINGS_HPP
#define MSS_BAUDET_WARNINGS_HPP

#include <cstdio>
#include <string>

#include "contributions.hpp"

namespace mss_baudet {

inline std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", x);
  return text;
}

/// Lane of the first cell in which `where` holds.
template <class Mask>
int first_of(const Mask& where) {
  int i = 0;
  while (!where[i]) ++i;
  return i;
}

/// Rest shapes outside of the formulas' range, to 1e-6 of the edges' lengths.
template <class Cell>
auto is_no_box(const Cell& c) {
  const auto node = rest_of(c);
  const vec3<typename Cell::real> A[3] = {mean_edge(node, 0), mean_edge(node, 1),
                                          mean_edge(node, 2)};
  auto bad = dot(A[0], A[0]) < 0.0;
  for (int e = 0; e < 12; ++e) {
    const auto* ends = suture_hexahedron_edges[e];
    const auto off = node(ends[1]) - node(ends[0]) - A[e / 4];
    bad = bad | (dot(off, off) > 1e-12 * dot(A[e / 4], A[e / 4]));
  }
  for (int a = 0; a < 3; ++a) {
    const auto& b = A[(a + 1) % 3];
    const auto cosine = dot(A[a], b);
    bad = bad | (cosine * cosine > 1e-12 * dot(A[a], A[a]) * dot(b, b));
  }
  return bad;
}

template <class Cell>
void inspect_shape(const Cell& c) {
  using suture::max;
  using suture::min;
  const auto bad = is_no_box(c);
  if (any(bad))
    c.report(SUTURE_WARNING, bad, "not-a-box",
             "the rest shape is not a box, for which the springs are derived; the box of its mean "
             "edges is used, with the actual lengths as rest lengths");
  const auto l = box_lengths(rest_of(c));
  const auto ratio = max(max(l[0], l[1]), l[2]) / min(min(l[0], l[1]), l[2]);
  const auto flat = ratio > 1.2;
  if (any(flat))
    c.report(SUTURE_WARNING, flat, "aspect-ratio",
             "the ratio of the edges is " + number(ratio[first_of(flat)]) +
                 ": the three shear moduli differ by up to its square, because one inner spring "
                 "stiffness cannot match them all; keep the ratio below 1.2");
}

template <class Cell>
void inspect_stiffness(const Cell& c) {
  using suture::min;
  const auto m = material_of(c);
  const auto k = springs_of_box(m, box_lengths(rest_of(c)));
  const auto least = min(min(k.edge[0], k.edge[1]), k.edge[2]);
  const auto negative = least < 0.0;
  if (!any(negative)) return;
  const char* then = m.negative == clamp  ? "; it is set to 0"
                     : m.negative == keep ? "; it is used unchanged and may be unstable"
                                          : "";
  c.report(m.negative == refuse ? SUTURE_ERROR : SUTURE_WARNING, negative, "negative-stiffness",
           "the box is so long that the formula gives an edge the stiffness " +
               number(least[first_of(negative)]) + " N/m" + then +
               " (parameter negative_stiffness); use boxes of edge ratio below 1.2");
}

}  // namespace mss_baudet

#endif
