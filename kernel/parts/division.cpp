// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/division.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "kernel/base/vec3.hpp"
#include "kernel/geometry/surface.hpp"
#include "kernel/parts/cube_sides.hpp"
#include "kernel/parts/cut_patterns.hpp"
#include "kernel/parts/moments.hpp"
#include "kernel/topology/disjoint_sets.hpp"

namespace suture {
namespace {

using Tetrahedron = std::array<Index, 4>;

constexpr double smallest_part = 1e-13;

int sign_of(double height, double tolerance) {
  return height > tolerance ? 1 : height < -tolerance ? -1 : 0;
}

/// Whether an even number of exchanges leads from 0, 1, 2, 3 to this order.
bool is_even(const std::array<unsigned, 4>& order) {
  bool even = true;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j)
      if (order[i] > order[j]) even = !even;
  return even;
}

/// A tetrahedron on one side of the blade, and the one of which it is a piece.
struct Fragment {
  Tetrahedron corners;
  Index parent;
  int side;
};

/// Clips tetrahedra. New points are on the edges of old ones.
class Clipping {
 public:
  Clipping(const Material& material, const std::vector<double>& heights, double tolerance)
      : points(material.points), old_points_(points.size()), heights_(heights) {
    points.reserve(2 * points.size() + 16);
    fragments.reserve(4 * material.tetrahedra.size());
    for (const double height : heights) signs_.push_back(sign_of(height, tolerance));
    for (Index t = 0; t < material.tetrahedra.size(); ++t) clip(material.tetrahedra[t], t);
  }

  /// Which corners of a tetrahedron a point lies between, one bit each.
  unsigned support(Index point, const Tetrahedron& parent) const {
    const auto bit = [&](Index old) {
      return 1u << (std::ranges::find(parent, old) - parent.begin());
    };
    if (point < old_points_) return bit(point);
    const Crossing& crossing = crossings_[point - old_points_];
    return bit(crossing.low) | bit(crossing.high);
  }

  std::vector<Vec3> points;
  std::vector<Fragment> fragments;

 private:
  struct Crossing {
    Index low, high;
  };

  void clip(const Tetrahedron& corners, Index parent) {
    parent_ = parent;
    bool has[3] = {false, false, false};
    for (const Index p : corners) has[signs_[p] + 1] = true;
    if (has[0] && has[2]) {
      for (const int side : {-1, 1}) clip(corners, side);
    } else {
      double sum = 0;  // if all are on the blade
      for (const Index p : corners) sum += heights_[p];
      fragments.push_back({corners, parent, has[0] || (!has[2] && sum < 0) ? -1 : 1});
    }
  }

  /// What is on one side of a tetrahedron with corners on both.
  void clip(const Tetrahedron& corners, int side) {
    side_ = side;
    std::array<unsigned, 4> order;  // corners on this side, on the blade, beyond
    unsigned n = 0, ins = 0, zeros = 0;
    for (const int wanted : {side, 0, -side})
      for (unsigned i = 0; i < 4; ++i)
        if (signs_[corners[i]] == wanted) {
          order[n++] = i;
          ins += wanted == side ? 1 : 0;
          zeros += wanted == 0 ? 1 : 0;
        }
    const bool even = is_even(order);
    const auto at = [&](unsigned i) { return corners[order[i]]; };
    const auto cut = [&](unsigned i, unsigned j) { return crossing(at(i), at(j)); };
    if (ins == 1) {
      Tetrahedron piece{at(0), 0, 0, 0};
      for (unsigned i = 1; i < 4; ++i) piece[i] = i <= zeros ? at(i) : cut(0, i);
      add(piece, even);
    } else if (ins == 3) {
      add_wedge({at(0), at(1), at(2)}, {cut(0, 3), cut(1, 3), cut(2, 3)}, even);
    } else if (zeros == 0) {
      // (0, 2, 3, 1) is an even rearrangement of (0, 1, 2, 3).
      add_wedge({at(0), cut(0, 2), cut(0, 3)}, {at(1), cut(1, 2), cut(1, 3)}, even);
    } else {
      // (0, 1, 3, 2) is an odd one.
      add_pyramid({at(0), at(1), cut(1, 3), cut(0, 3)}, at(2), !even);
    }
  }

  void add(const Tetrahedron& corners, bool is_positive) {
    const auto [a, b, c, d] = corners;
    fragments.push_back({is_positive ? corners : Tetrahedron{a, b, d, c}, parent_, side_});
  }

  bool less(Index a, Index b) const { return points[a] < points[b]; }
  template <std::size_t N>
  std::size_t lowest(const std::array<Index, N>& list) const {
    const auto before = [&](Index a, Index b) { return less(a, b); };
    return static_cast<std::size_t>(std::ranges::min_element(list, before) - list.begin());
  }

  /// Two triangles, corner i of the first joined to corner i of the second. The diagonal of each
  /// side begins at the lowest of its points (Dompierre et al. 1999). Positive if (low, high[0]) is
  /// positively oriented.
  void add_wedge(Triangle low, Triangle high, bool is_positive) {
    if (less(high[lowest(high)], low[lowest(low)])) {
      low.swap(high);
      is_positive = !is_positive;
    }
    const std::size_t i = lowest(low), j = (i + 1) % 3, k = (i + 2) % 3;
    const Index a = low[i], b = low[j], c = low[k], d = high[i], e = high[j], f = high[k];
    const std::array<Index, 4> side{b, c, e, f};
    const std::size_t start = lowest(side);
    if (start == 0 || start == 3) {
      add({a, b, c, f}, is_positive);
      add({a, b, f, e}, is_positive);
    } else {
      add({a, b, c, e}, is_positive);
      add({a, e, c, f}, is_positive);
    }
    add({a, e, f, d}, is_positive);
  }

  /// A quadrilateral and a point; the diagonal begins at the lowest.
  void add_pyramid(const std::array<Index, 4>& base, Index apex, bool is_positive) {
    const std::size_t i = lowest(base), j = (i + 1) % 4, k = (i + 2) % 4, l = (i + 3) % 4;
    add({base[i], base[j], base[k], apex}, is_positive);
    add({base[i], base[k], base[l], apex}, is_positive);
  }

  /// Where the blade crosses the edge between two points: computed from the lower one, so that all
  /// elements at the edge find the same bits.
  Index crossing(Index low, Index high) {
    if (less(high, low)) std::swap(low, high);
    for (std::size_t i = 0; i < crossings_.size(); ++i)
      if (crossings_[i].low == low && crossings_[i].high == high)
        return old_points_ + static_cast<Index>(i);
    const double share = heights_[low] / (heights_[low] - heights_[high]);
    crossings_.push_back({low, high});
    points.push_back(plus(points[low], scaled(share, minus(points[high], points[low]))));
    return static_cast<Index>(points.size() - 1);
  }

  Index old_points_;
  const std::vector<double>& heights_;
  std::vector<int> signs_;
  std::vector<Crossing> crossings_;
  Index parent_ = 0;
  int side_ = 0;
};

/// A face of a fragment. Its key stands for its points, of which there are fewer than 2^21.
struct FragmentFace {
  std::uint64_t key;
  Index fragment;
  unsigned face;
};

Triangle points_of(const Fragment& fragment, unsigned face) {
  const auto& [a, b, c] = tetrahedron_faces[face];
  return {fragment.corners[a], fragment.corners[b], fragment.corners[c]};
}

std::vector<FragmentFace> faces_of(const std::vector<Fragment>& fragments) {
  std::vector<FragmentFace> faces;
  faces.reserve(4 * fragments.size());
  for (Index f = 0; f < fragments.size(); ++f)
    for (unsigned i = 0; i < 4; ++i) {
      auto [low, middle, high] = points_of(fragments[f], i);
      if (middle < low) std::swap(low, middle);
      if (high < middle) std::swap(middle, high);
      if (middle < low) std::swap(low, middle);
      faces.push_back({low | std::uint64_t{middle} << 21 | std::uint64_t{high} << 42, f, i});
    }
  std::ranges::sort(faces, {}, &FragmentFace::key);
  return faces;
}

bool is_on_side(const std::vector<Vec3>& points, const Triangle& corners) {
  return (sides_at(points[corners[0]]) & sides_at(points[corners[1]]) &
          sides_at(points[corners[2]])) != 0;
}

/// The triangles of the material before, by their points in ascending order.
class OldSurface {
 public:
  explicit OldSurface(const Material& material) {
    for (std::size_t t = 0; t < material.triangles.size(); ++t) {
      Triangle points = material.triangles[t];
      std::ranges::sort(points);
      triangles_.push_back({points, material.is_cut[t]});
    }
    std::ranges::sort(triangles_, {}, &Marked::points);
  }
  /// Whether a blade made the triangle.
  bool is_cut(Triangle points) const {
    std::ranges::sort(points);
    const auto at = std::ranges::lower_bound(triangles_, points, {}, &Marked::points);
    return at != triangles_.end() && at->points == points && at->is_cut != 0;
  }

 private:
  struct Marked {
    Triangle points;
    std::uint8_t is_cut;
  };
  std::vector<Marked> triangles_;
};

/// Collects the fragments of parts, which number their points themselves.
class PartBuilder {
 public:
  PartBuilder(const Material& material, const Clipping& clipping)
      : material_(material), clipping_(clipping), old_surface_(material) {}

  std::vector<DividedPart> build() {
    const std::vector<FragmentFace> faces = faces_of(clipping_.fragments);
    find_parts(faces);
    for (Index f = 0; f < clipping_.fragments.size(); ++f) add_fragment(f);
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const bool follows = i > 0 && faces[i - 1].key == faces[i].key;
      const bool is_followed = i + 1 < faces.size() && faces[i + 1].key == faces[i].key;
      if (follows || is_followed) {
        const FragmentFace& other = faces[follows ? i - 1 : i + 1];
        if (side(faces[i]) != side(other)) add_triangle(faces[i], true);
      } else if (!is_on_side(clipping_.points, points_of(faces[i]))) {
        add_triangle(faces[i], was_cut(faces[i]));
      }
    }
    std::erase_if(parts_, [](const DividedPart& p) { return !(p.moments.fraction > 0); });
    return std::move(parts_);
  }

 private:
  int side(const FragmentFace& face) const { return clipping_.fragments[face.fragment].side; }
  Triangle points_of(const FragmentFace& face) const {
    return suture::points_of(clipping_.fragments[face.fragment], face.face);
  }

  void find_parts(const std::vector<FragmentFace>& faces) {
    DisjointSets sets(clipping_.fragments.size());
    for (std::size_t i = 1; i < faces.size(); ++i)
      if (faces[i].key == faces[i - 1].key && side(faces[i]) == side(faces[i - 1]))
        sets.unite(faces[i].fragment, faces[i - 1].fragment);
    std::vector<MomentSum> sums;
    for (std::size_t f = 0; f < clipping_.fragments.size(); ++f) {
      const std::size_t first = sets.find(f);
      if (first == f) {
        part_of_.push_back(parts_.size());
        parts_.emplace_back().side = clipping_.fragments[f].side;
        sums.emplace_back();
      } else {
        part_of_.push_back(part_of_[first]);
      }
      std::array<Vec3, 4> places;
      for (std::size_t i = 0; i < 4; ++i)
        places[i] = clipping_.points[clipping_.fragments[f].corners[i]];
      sums[part_of_[f]].add(places);
    }
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      parts_[p].moments = sums[p].moments();
      if (!(parts_[p].moments.fraction >= smallest_part)) parts_[p].moments.fraction = 0;
    }
    number_of_.assign(parts_.size() * clipping_.points.size(), none);
    for (DividedPart& part : parts_) {
      part.material.points.reserve(clipping_.points.size());
      part.material.tetrahedra.reserve(clipping_.fragments.size());
      part.material.triangles.reserve(clipping_.fragments.size());
      part.material.is_cut.reserve(clipping_.fragments.size());
    }
  }

  Index number(std::size_t part, Index point) {
    Index& number = number_of_[part * clipping_.points.size() + point];
    std::vector<Vec3>& points = parts_[part].material.points;
    if (number == none) {
      number = static_cast<Index>(points.size());
      points.push_back(clipping_.points[point]);
    }
    return number;
  }

  void add_fragment(Index f) {
    Tetrahedron corners = clipping_.fragments[f].corners;
    for (Index& p : corners) p = number(part_of_[f], p);
    parts_[part_of_[f]].material.tetrahedra.push_back(corners);
  }

  void add_triangle(const FragmentFace& face, bool is_cut) {
    const std::size_t part = part_of_[face.fragment];
    Material& material = parts_[part].material;
    Triangle corners = points_of(face);
    for (Index& p : corners) p = number(part, p);
    material.triangles.push_back(corners);
    material.is_cut.push_back(is_cut ? 1 : 0);
  }

  /// Whether a face on the surface of the material before was made by a blade: it is a piece of a
  /// face of the fragment's parent.
  bool was_cut(const FragmentFace& face) const {
    const Tetrahedron& parent = material_.tetrahedra[clipping_.fragments[face.fragment].parent];
    unsigned support = 0;
    for (const Index p : points_of(face)) support |= clipping_.support(p, parent);
    Triangle points{};
    std::size_t n = 0;
    for (unsigned i = 0; i < 4 && n < 3; ++i)
      if (support >> i & 1) points[n++] = parent[i];
    return old_surface_.is_cut(points);
  }

  const Material& material_;
  const Clipping& clipping_;
  OldSurface old_surface_;
  std::vector<DividedPart> parts_;
  std::vector<std::size_t> part_of_;  ///< by fragment
  std::vector<Index> number_of_;      ///< by part and point
};

}  // namespace

const Material& Material::full_element() {
  static const Material full = [] {
    const CutPattern& pattern = cut_pattern(all_corners);
    Material material;
    for (const PatternPoint point : pattern.points) material.points.push_back(place_of(point, 0));
    for (const auto& [a, b, c, d] : pattern.tetrahedra) material.tetrahedra.push_back({a, b, c, d});
    return material;
  }();
  return full;
}

int side_of(const Material& material, const std::vector<double>& heights, double tolerance) {
  bool above = false, below = false;
  for (std::size_t p = 0; p < material.points.size(); ++p) {
    above = above || heights[p] > tolerance;
    below = below || heights[p] < -tolerance;
  }
  if (above != below) return above ? 1 : -1;
  if (above) return 0;
  return std::accumulate(heights.begin(), heights.end(), 0.0) < 0 ? -1 : 1;
}

std::vector<DividedPart> divide(const Material& material, const std::vector<double>& heights,
                                double tolerance) {
  const Clipping clipping(material, heights, tolerance);
  return PartBuilder(material, clipping).build();
}

}  // namespace suture
