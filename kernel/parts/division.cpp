// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/division.hpp"

#include <algorithm>
#include <bit>
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

std::int8_t sign_of(double height, double tolerance) {
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

/// Face 4 f + i is face i of fragment f.
Triangle points_of(const std::vector<Fragment>& fragments, Index face) {
  const Tetrahedron& corners = fragments[face / 4].corners;
  const auto& [a, b, c] = tetrahedron_faces[face % 4];
  return {corners[a], corners[b], corners[c]};
}

}  // namespace

/// Clips tetrahedra. New points are on the edges of old ones.
class Divider::Clipping {
 public:
  std::vector<Vec3> points;
  std::vector<Fragment> fragments;

  void clip(const Material& material, std::span<const double> heights, double tolerance) {
    points = material.points;
    old_points_ = static_cast<Index>(points.size());
    heights_ = heights;
    fragments.clear();
    signs_.clear();
    crossings_.clear();
    last_crossing_.assign(points.size(), none);
    for (const double height : heights) signs_.push_back(sign_of(height, tolerance));
    for (Index t = 0; t < material.tetrahedra.size(); ++t) clip(material.tetrahedra[t], t);
  }

  /// The face of its parent on which a face of a fragment lies: one of the material's surface.
  Triangle face_before(Index face, const Material& material) const {
    const Tetrahedron& parent = material.tetrahedra[fragments[face / 4].parent];
    unsigned corners = 0;
    for (const Index p : points_of(fragments, face)) corners |= support(p, parent);
    Triangle before{};
    std::size_t n = 0;
    for (unsigned i = 0; i < 4 && n < 3; ++i)
      if (corners >> i & 1) before[n++] = parent[i];
    return before;
  }

 private:
  /// Which corners of a tetrahedron a point lies between, one bit each.
  unsigned support(Index point, const Tetrahedron& parent) const {
    const auto bit = [&](Index old) {
      return 1u << (std::ranges::find(parent, old) - parent.begin());
    };
    if (point < old_points_) return bit(point);
    const Crossing& crossing = crossings_[point - old_points_];
    return bit(crossing.low) | bit(crossing.high);
  }

  struct Crossing {
    Index low, high;
    Index next;  ///< another one with the same low point, or none
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
    for (Index i = last_crossing_[low]; i != none; i = crossings_[i].next)
      if (crossings_[i].high == high) return old_points_ + i;
    const double share = heights_[low] / (heights_[low] - heights_[high]);
    crossings_.push_back({low, high, last_crossing_[low]});
    last_crossing_[low] = static_cast<Index>(crossings_.size() - 1);
    points.push_back(plus(points[low], scaled(share, minus(points[high], points[low]))));
    return static_cast<Index>(points.size() - 1);
  }

  Index old_points_ = 0;
  std::span<const double> heights_;
  std::vector<std::int8_t> signs_;
  std::vector<Crossing> crossings_;
  std::vector<Index> last_crossing_;  ///< by low point
  Index parent_ = 0;
  int side_ = 0;
};

/// Finds which faces of fragments lie at the same points. Face i of fragment f has the number
/// 4 f + i.
class Divider::FacePairs {
 public:
  void find(const std::vector<Fragment>& fragments) {
    mates_.resize(4 * fragments.size());
    if (table_.size() < 2 * mates_.size()) table_.resize(std::bit_ceil(2 * mates_.size()));
    mask_ = std::bit_ceil(2 * mates_.size()) - 1;
    if (++call_ == 0) {  // slots of 2^32 calls before would seem to be of this one
      table_.assign(table_.size(), {});
      call_ = 1;
    }
    // Without branches that would be taken every other time.
    for (Index face = 0; face < mates_.size(); ++face) {
      const std::uint64_t key = key_of(points_of(fragments, face));
      Slot& slot = slot_of(key);
      const bool is_found = slot.call == call_;
      const Index mate = is_found ? slot.face : face;
      mates_[mate] = is_found ? face : none;
      mates_[face] = is_found ? mate : none;
      slot = {key, mate, call_};
    }
  }
  /// The other face at the same points, or none.
  Index mate(Index face) const { return mates_[face]; }

 private:
  struct Slot {
    std::uint64_t key = 0;
    Index face = none;
    std::uint32_t call = 0;  ///< of find() in which it was written; else it is empty
  };

  /// It stands for the points, of which there are fewer than 2^21.
  static std::uint64_t key_of(const Triangle& points) {
    const auto [a, b, c] = points;
    const Index low = std::min(std::min(a, b), c), high = std::max(std::max(a, b), c);
    const Index middle = a ^ b ^ c ^ low ^ high;
    return low | std::uint64_t{middle} << 21 | std::uint64_t{high} << 42;
  }
  /// That of the key, or an empty one.
  Slot& slot_of(std::uint64_t key) {
    const std::uint64_t hash = key * 0x9E3779B97F4A7C15u;
    for (std::size_t i = hash ^ hash >> 32;; ++i) {
      Slot& slot = table_[i & mask_];
      if (slot.call != call_ || slot.key == key) return slot;
    }
  }

  std::vector<Index> mates_;
  std::vector<Slot> table_;  ///< of which find() uses the first `mask_ + 1`
  std::size_t mask_ = 0;
  std::uint32_t call_ = 0;
};

namespace {

/// The triangles of the material before, by their points in ascending order.
class OldSurface {
 public:
  void take(const Material& material) {
    triangles_.clear();
    for (std::size_t t = 0; t < material.triangles.size(); ++t) {
      Triangle points = material.triangles[t];
      std::ranges::sort(points);
      triangles_.push_back({points, static_cast<Index>(t)});
    }
    std::ranges::sort(triangles_, {}, &Numbered::points);
  }
  bool empty() const { return triangles_.empty(); }
  /// The number of the triangle with these points, or none.
  Index triangle(Triangle points) const {
    std::ranges::sort(points);
    const auto at = std::ranges::lower_bound(triangles_, points, {}, &Numbered::points);
    return at != triangles_.end() && at->points == points ? at->number : none;
  }

 private:
  struct Numbered {
    Triangle points;
    Index number;
  };
  std::vector<Numbered> triangles_;
};

}  // namespace

/// Collects the fragments of parts, which number their points themselves.
class Divider::PartBuilder {
 public:
  std::vector<DividedPart> build(const Material& material, const Clipping& clipping,
                                 const FacePairs& faces) {
    material_ = &material;
    clipping_ = &clipping;
    old_surface_.take(material);
    sides_.clear();
    for (const Vec3& point : clipping.points) sides_.push_back(sides_at(point));
    find_parts(faces);
    number_cells();
    for (Index f = 0; f < clipping.fragments.size(); ++f) add_fragment(f);
    for (Index face = 0; face < 4 * clipping.fragments.size(); ++face) {
      const Index mate = faces.mate(face);
      if (mate != none) {
        if (side(face) != side(mate)) add_triangle(face, true);
      } else if (!is_on_side(face)) {
        add_triangle(face, was_cut(face));
      }
    }
    std::vector<DividedPart> found;
    found.reserve(count_);
    for (std::size_t p = 0; p < count_; ++p)
      if (parts_[p].moments.fraction > 0) found.push_back(parts_[p]);
    return found;
  }

  double dropped() const { return dropped_; }

 private:
  const Fragment& fragment(Index face) const { return clipping_->fragments[face / 4]; }
  int side(Index face) const { return fragment(face).side; }
  Triangle points_of(Index face) const { return suture::points_of(clipping_->fragments, face); }
  bool is_on_side(Index face) const {
    const Triangle points = points_of(face);
    return (sides_[points[0]] & sides_[points[1]] & sides_[points[2]]) != 0;
  }

  void find_parts(const FacePairs& faces) {
    const auto& fragments = clipping_->fragments;
    DisjointSets sets(fragments.size());
    for (Index face = 0; face < 4 * fragments.size(); ++face)
      if (const Index mate = faces.mate(face); mate < face && side(face) == side(mate))
        sets.unite(face / 4, mate / 4);
    count_ = 0;
    part_of_.clear();
    sums_.clear();
    for (std::size_t f = 0; f < fragments.size(); ++f) {
      const std::size_t first = sets.find(f);
      if (first == f) {
        part_of_.push_back(count_++);
        begin_part(part_of_.back(), fragments[f].side);
        sums_.emplace_back();
      } else {
        part_of_.push_back(std::size_t{part_of_[first]});
      }
      std::array<Vec3, 4> places;
      for (std::size_t i = 0; i < 4; ++i) places[i] = clipping_->points[fragments[f].corners[i]];
      sums_[part_of_[f]].add(places);
    }
    dropped_ = 0;
    for (std::size_t p = 0; p < count_; ++p) {
      parts_[p].moments = sums_[p].moments();
      if (parts_[p].moments.fraction >= smallest_part) continue;
      if (parts_[p].moments.fraction > 0) dropped_ += parts_[p].moments.fraction;
      parts_[p].moments.fraction = 0;
    }
    number_of_.assign(count_ * clipping_->points.size(), none);
  }
  void begin_part(std::size_t number, int side) {
    if (number == parts_.size()) parts_.emplace_back();
    parts_[number].side = side;
    parts_[number].material.clear();
  }

  /// A cell of the material is on one side of the blade in each part.
  void number_cells() {
    const std::vector<Index>& cells = material_->cells;
    cell_count_ = cells.empty() ? 0 : std::ranges::max(cells) + std::size_t{1};
    number_of_cell_.assign(count_ * cell_count_, none);
    cells_of_part_.assign(count_, 0);
  }
  Index cell(std::size_t part, Index parent) {
    Index& number = number_of_cell_[part * cell_count_ + material_->cells[parent]];
    if (number == none) number = cells_of_part_[part]++;
    return number;
  }

  Index number(std::size_t part, Index point) {
    Index& number = number_of_[part * clipping_->points.size() + point];
    std::vector<Vec3>& points = parts_[part].material.points;
    if (number == none) {
      number = static_cast<Index>(points.size());
      points.push_back(clipping_->points[point]);
    }
    return number;
  }

  void add_fragment(Index f) {
    Tetrahedron corners = clipping_->fragments[f].corners;
    for (Index& p : corners) p = number(part_of_[f], p);
    Material& material = parts_[part_of_[f]].material;
    material.tetrahedra.push_back(corners);
    material.cells.push_back(cell(part_of_[f], clipping_->fragments[f].parent));
  }

  void add_triangle(Index face, bool is_cut) {
    const std::size_t part = part_of_[face / 4];
    Material& material = parts_[part].material;
    Triangle corners = points_of(face);
    for (Index& p : corners) p = number(part, p);
    material.triangles.push_back(corners);
    material.is_cut.push_back(is_cut ? 1 : 0);
  }

  /// Whether a face on the surface of the material before was made by a blade.
  bool was_cut(Index face) const {
    if (old_surface_.empty()) return false;
    const Index before = old_surface_.triangle(clipping_->face_before(face, *material_));
    return before != none && material_->is_cut[before] != 0;
  }

  const Material* material_ = nullptr;
  const Clipping* clipping_ = nullptr;
  OldSurface old_surface_;
  std::vector<std::uint8_t> sides_;  ///< of the cube, by point
  std::vector<DividedPart> parts_;   ///< the first `count_` of this division
  std::size_t count_ = 0;
  double dropped_ = 0;                ///< the share of the cube in parts that are left out
  std::vector<MomentSum> sums_;       ///< by part
  std::vector<std::size_t> part_of_;  ///< by fragment
  std::vector<Index> number_of_;      ///< by part and point
  std::size_t cell_count_ = 0;        ///< of the material
  std::vector<Index> number_of_cell_, cells_of_part_;  ///< by part and cell; by part
};

const Material& Material::full_element() {
  static const Material full = [] {
    const CutPattern& pattern = cut_pattern(all_corners);
    Material material;
    for (const PatternPoint point : pattern.points) material.points.push_back(place_of(point, 0));
    for (const auto& [a, b, c, d] : pattern.tetrahedra) {
      material.cells.push_back(static_cast<Index>(material.tetrahedra.size()));
      material.tetrahedra.push_back({a, b, c, d});
    }
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

Divider::Divider()
    : clipping_(std::make_unique<Clipping>()),
      faces_(std::make_unique<FacePairs>()),
      parts_(std::make_unique<PartBuilder>()) {}
Divider::~Divider() = default;

double Divider::dropped() const { return parts_->dropped(); }

std::vector<DividedPart> Divider::divide(const Material& material,
                                         const std::vector<double>& heights, double tolerance) {
  clipping_->clip(material, heights, tolerance);
  faces_->find(clipping_->fragments);
  return parts_->build(material, *clipping_, *faces_);
}

RefinedMaterial Divider::refine(const Material& material, const std::vector<double>& heights,
                                double tolerance) {
  clipping_->clip(material, heights, tolerance);
  const std::vector<Fragment>& fragments = clipping_->fragments;
  RefinedMaterial refined;
  refined.material.points = clipping_->points;
  for (const Fragment& fragment : fragments) {
    refined.material.tetrahedra.push_back(fragment.corners);
    refined.material.cells.push_back(Index{material.cells[fragment.parent]});
  }
  if (material.triangles.empty()) return refined;
  faces_->find(fragments);
  OldSurface before;
  before.take(material);
  for (Index face = 0; face < 4 * fragments.size(); ++face) {
    if (faces_->mate(face) != none) continue;
    const Index source = before.triangle(clipping_->face_before(face, material));
    if (source == none) continue;
    refined.material.triangles.push_back(points_of(fragments, face));
    refined.material.is_cut.push_back(std::uint8_t{material.is_cut[source]});
    refined.sources.push_back(source);
  }
  return refined;
}

}  // namespace suture
