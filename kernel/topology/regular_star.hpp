// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "kernel/topology/incidence.hpp"
#include "kernel/topology/marks.hpp"

/// The stars of nearly all cut cells, found without a flood fill.
///
/// A cut surface without a rim or branch at a vertex leaves a half star on either side, elements
/// a_i above and b_i below, joined one to one through cut faces F_i:
///
///        g0 | g1                 Seen along the surface: the dart d_i of F_i starts at
///       a0  |  a1                v. Around the edge of d_i the elements a_i, a_i+1 meet
///     ------v------  F_i         in face g_i, and below them b_i, b_i+1 must meet too.
///       b0  |  b1
///           |                    A step above and a step below in parallel, until the
///                                ring closes or both reach the boundary of the mesh.
///
/// At an edge of the surface, two elements meet on either side. All other cases (rims, branches,
/// elements that touch the surface at a point) are handled by the flood fill.
namespace suture::incidence {

namespace detail {
using LocalTable = std::array<Local, 32>;

/// Indexed by the local part of a link; 32 entries, so that no index is out of range.
template <class Function>
constexpr LocalTable local_table(Function of) {
  LocalTable result{};
  for (int d = 0; d < hexahedron::darts; ++d) result[d] = static_cast<Local>(of(d));
  return result;
}

inline constexpr LocalTable beta2_of = local_table([](int d) { return hexahedron::beta2[d]; });
inline constexpr LocalTable next_of = local_table(hexahedron::beta1);
inline constexpr LocalTable previous_of = local_table(hexahedron::beta0);
inline constexpr LocalTable next_of_beta2 =
    local_table([](int d) { return hexahedron::beta1(hexahedron::beta2[d]); });
inline constexpr LocalTable previous_of_beta2 =
    local_table([](int d) { return hexahedron::beta0(hexahedron::beta2[d]); });
inline constexpr LocalTable begin_of =
    local_table([](int d) { return hexahedron::dart_vertex[d]; });
inline constexpr LocalTable end_of =
    local_table([](int d) { return hexahedron::dart_vertex[hexahedron::beta1(d)]; });

inline Link turned(Link dart, const LocalTable& table) { return (dart & ~31u) | table[dart & 31]; }
/// The vertex where the dart begins or ends.
inline LocalCell place(Link dart, const LocalTable& vertex) {
  return dart >> 5 << 4 | vertex[dart & 31];
}
}  // namespace detail

inline Link next(Link dart) { return detail::turned(dart, detail::next_of); }
inline Link previous(Link dart) { return detail::turned(dart, detail::previous_of); }
/// beta3 of a dart whose face has the link `link`, which is not none and has no marks.
inline Link across_link(Link link, Link dart) { return (link & ~3u) | ((link - dart) & 3u); }

/// Sorts a few cells in ascending order.
inline void sort_local_cells(LocalCell* begin, LocalCell* end) {
  // The usual sizes are sorted without branches, which would be hard to predict.
  const auto order = [begin](int i, int j) {
    const LocalCell low = std::min(begin[i], begin[j]), high = std::max(begin[i], begin[j]);
    begin[i] = low;
    begin[j] = high;
  };
  if (end - begin == 2) return order(0, 1);
  if (end - begin == 4) {
    order(0, 1), order(2, 3), order(0, 2), order(1, 3);
    return order(1, 2);
  }
  for (LocalCell* i = begin + 1; i < end; ++i) {
    const LocalCell value = *i;
    LocalCell* to = i;
    for (; to > begin && to[-1] > value; --to) *to = to[-1];
    *to = value;
  }
}

/// Two half stars: above[0..size) and below[0..size), with size <= max_size.
struct HalfStars {
  static constexpr std::size_t max_size = 8;
  std::array<LocalCell, max_size> above, below;
  std::size_t size = 0;
  bool cut_all = true;  ///< every element of both has a cut face
  bool closed = false;  ///< the last elements are neighbours of the first (or of each other)
};

/// Whether the faces between above and below must be exactly the cut ones; or whether cut faces are
/// treated like any other, so that the two halves form the whole star.
enum class Surface { cut, any };

namespace detail {

enum class Step { on, end, irregular };

/// Steps from the dart above, on the edge across which the surface continues, and its beta3 below,
/// to the dart of the next face on that edge and its counterpart below; each is then turned by its
/// table after beta2.
template <Surface What>
Step step(const Link* links, Link& above, Link& below, const LocalTable& turn_above = beta2_of,
          const LocalTable& turn_below = beta2_of) {
  const Link up = beta2_of[above & 31], down = beta2_of[below & 31];
  Link link_up = links[std::size_t{6} * (above >> 5) + up / 4];
  Link link_down = links[std::size_t{6} * (below >> 5) + down / 4];
  if (link_up == none && link_down == none) return Step::end;
  if constexpr (What == Surface::any) {
    if (link_up == none || link_down == none) return Step::irregular;
    link_up &= ~marks::leaving;
    link_down &= ~marks::leaving;
  }
  if ((link_up | link_down) & marks::leaving) return Step::irregular;  // none among them
  above = turned(across_link(link_up, up), turn_above);
  below = turned(across_link(link_down, down), turn_below);
  return Step::on;
}

/// True if the face of `above` is cut and joins it with `below`.
template <Surface What>
bool is_glued(const Link* links, Link above, Link below) {
  const Link link = links[marks::side_of(above)];
  return link != none && (What == Surface::any || (link & marks::leaving)) &&
         across_link(link & ~marks::leaving, above) == below;
}

}  // namespace detail

/// The half stars of the vertex where `start`, a dart of a cut face, begins. Returns false if the
/// vertex is not regular. `links`: as stored, with those of cut faces marked as leaving.
template <Surface What>
bool half_stars_of_vertex(const Link* links, Link start, HalfStars& stars) {
  using namespace detail;
  stars.size = 0;
  stars.cut_all = stars.closed = true;
  const auto add = [&](LocalCell above, LocalCell below) {
    stars.above[stars.size] = above;
    stars.below[stars.size++] = below;
    return below != stars.above[0];  // otherwise there is only one side
  };
  // Darts `above` start at the vertex; their beta3 `below` end there.
  const Link mate = across_link(links[marks::side_of(start)] & ~marks::leaving, start);
  Link above = start, below = mate;
  for (;;) {
    if (!add(place(above, begin_of), place(below, end_of))) return false;
    const Step on = step<What>(links, above, below, next_of_beta2, previous_of_beta2);
    if (on == Step::irregular) return false;
    if (on == Step::end) break;
    if (!is_glued<What>(links, above, below)) return false;
    if (above == start) return below == mate;
    if (stars.size == HalfStars::max_size) return false;
  }
  // At the boundary: continue in the other direction, with darts `above` that end at the vertex.
  stars.closed = false;
  above = previous(start);
  below = next(mate);
  for (;;) {
    const Step on = step<What>(links, above, below, previous_of_beta2, next_of_beta2);
    if (on == Step::irregular) return false;
    if (on == Step::end) return true;
    if (!is_glued<What>(links, above, below) || stars.size == HalfStars::max_size) return false;
    if (!add(place(above, end_of), place(below, begin_of))) return false;
  }
}

/// The half stars of the edge of `start`, a dart of a cut face: two elements each, or one each on
/// the boundary.
template <Surface What>
bool half_stars_of_edge(const Link* links, Link start, HalfStars& stars) {
  using detail::Step;
  const auto local_cell_of = [](Link dart) {
    return dart >> 5 << 4 | local_of<1>(static_cast<int>(dart & 31));
  };
  Link above = start;
  Link below = across_link(links[marks::side_of(start)] & ~marks::leaving, start);
  stars.above[0] = local_cell_of(above);
  stars.below[0] = local_cell_of(below);
  stars.size = 1;
  stars.cut_all = true;
  stars.closed = false;
  const Step step = detail::step<What>(links, above, below);
  if (step == Step::irregular) return false;
  if (step == Step::end) return stars.above[0] != stars.below[0];
  stars.above[1] = local_cell_of(above);
  stars.below[1] = local_cell_of(below);
  stars.size = 2;
  if (stars.above[1] == stars.below[0]) return false;
  if (detail::is_glued<What>(links, above, below)) {
    stars.closed = true;
    return true;
  }
  stars.cut_all = false;
  return links[marks::side_of(above)] == none && links[marks::side_of(below)] == none;
}

template <int Dimension, Surface What = Surface::cut>
bool half_stars(const Link* links, Link start, HalfStars& stars) {
  if constexpr (Dimension == 0)
    return half_stars_of_vertex<What>(links, start, stars);
  else
    return half_stars_of_edge<What>(links, start, stars);
}

}  // namespace suture::incidence
