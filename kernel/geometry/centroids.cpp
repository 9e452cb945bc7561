// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/centroids.hpp"

#include <algorithm>

#include "kernel/base/box_text.hpp"

namespace suture {

std::string why_nothing_was_cut(const Box& blade, const CellComplex& complex, const Places& places,
                                const Vec3& origin, bool divides) {
  Box body = no_box;
  for (Index v = 0; v < complex.count(0); ++v) {
    if (!complex.exists(0, v)) continue;
    const double* x = places.rows + places.stride * v;
    include(body, {x[0], x[1], x[2]});
  }
  bool apart = false;
  for (int a = 0; a < 3; ++a)
    apart = apart || blade.high[a] < body.low[a] || blade.low[a] > body.high[a];
  const auto text_of = [&](const Box& box) {
    Vec3 low = box.low, high = box.high;
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] += origin[a];
      high[a] += origin[a];
    }
    return box_text(low, high, 4);
  };
  return "the blade cuts nothing: " +
         std::string(
             apart     ? "it lies outside the body"
             : divides ? "it sweeps no whole section of an element"
                       : "it does not pass between the centroids of any two elements that share a "
                         "face") +
         "; blade " + text_of(blade) + " m, body " + text_of(body) + " m";
}

}  // namespace suture
