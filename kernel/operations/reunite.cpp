// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/reunite.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <unordered_set>

#include "kernel/operations/seam_batch.hpp"
#include "kernel/parts/lip_triangle.hpp"
#include "kernel/parts/moments.hpp"
#include "kernel/parts/part_writer.hpp"

// How parts become one element
// ============================
//
//      +-------+-------+            +-------+-------+
//      |  a   /|       |            |       |       |      a and b: one group
//      |     / |   w   |   ---->    |   c   |   w   |      c: its copy; w was joined to b only
//      |    / b|       |            |       |       |
//      +-------+-------+            +-------+-------+
//
//   sides      The sides of elements with the same points of the user's mesh have been one face.
//   touches    Those whose material overlaps, of which one belongs to a group, may be joined.
//   joints     Each side is joined once: the largest contact first.
//   surface    Lips that a and b have in common vanish.

namespace suture {
namespace {

// An element is whole again if no more than this share of it is missing: divisions drop parts
// smaller than 1e-13.
constexpr double whole_rounding = 1e-9;

using FacePoints = std::array<Index, 4>;
struct HashOfPoints {
  std::size_t operator()(const FacePoints& points) const {
    std::uint64_t hash = 0;
    for (const Index p : points) hash = (hash ^ p) * 0x9E3779B97F4A7C15u;
    return hash ^ hash >> 32;
  }
};

/// Sides whose material overlaps, and by how much.
struct SideContact {
  Seam seam;  ///< in the old numbers
  double area;
};

class Uniter {
 public:
  Uniter(const CellComplex& complex, const Parts& parts, std::span<const Index> points,
         const std::vector<std::vector<Index>>& groups)
      : complex_(complex),
        parts_(parts),
        materials_(parts),
        faces_(parts),
        points_(points),
        groups_(groups),
        copy_of_(complex.element_count(), none),
        writer_(result_.parts) {}

  Reunion find() {
    number_copies();
    find_sides();
    find_contacts();
    join();
    for (std::size_t g = 0; g < groups_.size(); ++g) add_part(g);
    return std::move(result_);
  }

 private:
  bool is_member(Index element) const { return copy_of_[element] != none; }
  Index after(Index element) const { return is_member(element) ? copy_of_[element] : element; }
  Dart after_dart(Dart dart) const { return corresponding_dart(after(element_of(dart)), dart); }

  /// The largest of a group is the origin of its copy.
  void number_copies() {
    std::vector<std::pair<Index, std::size_t>> origins;
    std::vector<Index> members;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      members.insert(members.end(), groups_[g].begin(), groups_[g].end());
      const auto largest = std::ranges::max_element(groups_[g], {}, [&](Index e) {
        return parts_.moments[position_in(parts_.elements, e)].fraction;
      });
      origins.push_back({*largest, g});
    }
    std::ranges::sort(origins);
    group_of_copy_.resize(origins.size());
    for (std::size_t i = 0; i < origins.size(); ++i) {
      const auto& [origin, group] = origins[i];
      const Index copy = complex_.element_count() + static_cast<Index>(i);
      group_of_copy_[i] = group;
      result_.cloning.origins.push_back(origin);
      for (const Index e : groups_[group]) {
        copy_of_[e] = copy;
        if (e != origin) result_.cloning.absorbed.push_back({e, copy});
      }
    }
    std::ranges::sort(result_.cloning.absorbed, {}, &Split::old_cell);
    std::ranges::sort(members);
    materials_.find_surface(members, complex_.element_count());
  }

  FacePoints points_at(Dart side) const {
    FacePoints points;
    for (Dart k = 0; k < 4; ++k) points[k] = points_[complex_.origin(side + k)];
    std::ranges::sort(points);
    return points;
  }

  void find_sides() {
    for (const auto& group : groups_)
      for (const Index e : group)
        for (const Dart side : sides_of(e)) sides_[points_at(side)];
    for (Index e = 0; e < complex_.element_count(); ++e) {
      if (!complex_.exists(3, e)) continue;
      for (const Dart side : sides_of(e))
        if (const auto known = sides_.find(points_at(side)); known != sides_.end())
          known->second.push_back(side);
    }
  }

  void find_contacts() {
    for (const auto& [points, sides] : sides_)
      for (const Dart one : sides) {
        if (!is_member(element_of(one))) continue;
        for (const Dart other : sides) {
          const Index there = element_of(other);
          if (after(there) == after(element_of(one))) continue;
          if (is_member(there) && there < element_of(one)) continue;
          // What stays joined to another element that stays is not free.
          const Dart mate = complex_.beta3(other);
          if (!is_member(there) && mate != none && !is_member(element_of(mate))) continue;
          if (const auto seam = seam_of(one, other)) add_contact(*seam);
        }
      }
    std::ranges::sort(contacts_, [](const SideContact& a, const SideContact& b) {
      return std::tuple(-a.area, a.seam.one, a.seam.other) <
             std::tuple(-b.area, b.seam.one, b.seam.other);
    });
  }
  /// Corner by corner the same points.
  std::optional<Seam> seam_of(Dart one, Dart other) const {
    for (Dart turn = 0; turn < 4; ++turn) {
      const Seam seam{one, face_of(other) | turn};
      bool is_same = true;
      for (Dart k = 0; k < 4; ++k)
        is_same = is_same && points_[corner_vertex(complex_, seam, k)] ==
                                 points_[partner_vertex(complex_, seam, k)];
      if (is_same) return seam;
    }
    return {};
  }
  void add_contact(const Seam& seam) {
    if (const double area = faces_.area(seam); area > 0) contacts_.push_back({seam, area});
  }

  void join() {
    const auto side_after = [&](Dart dart) { return face_of(after_dart(dart)); };
    for (const auto& [seam, area] : contacts_) {
      const Dart one = side_after(seam.one), other = side_after(seam.other);
      if (joined_.contains(one) || joined_.contains(other)) continue;
      joined_.insert({one, other});
      const Seam joint{after_dart(seam.one), after_dart(seam.other)};
      const bool was_joined = complex_.beta3(origin_of(joint.one)) == origin_of(joint.other);
      (was_joined ? result_.cloning.seams : result_.seams).push_back(joint);
    }
  }
  /// The dart of the origin of a copy, or the dart itself.
  Dart origin_of(Dart dart) const {
    const Index element = element_of(dart);
    return element < complex_.element_count()
               ? dart
               : corresponding_dart(result_.cloning.origins[element - complex_.element_count()],
                                    dart);
  }

  // ------------------------------------------------------------------------ surface --

  void add_part(std::size_t copy_number) {
    const std::vector<Index>& group = groups_[group_of_copy_[copy_number]];
    const Index copy = complex_.element_count() + static_cast<Index>(copy_number);
    std::vector<Material> materials(group.size());
    for (std::size_t i = 0; i < group.size(); ++i) materials_.of(group[i], materials[i]);
    const Material together = united(materials);
    const Index first = writer_.add_volume(copy, together);
    for (std::size_t t = 0; t < together.triangles.size(); ++t)
      writer_.add_triangle(first, together.triangles[t], together.is_cut[t] != 0);
    MomentSum sum;
    const auto& x = together.points;
    for (const auto& [a, b, c, d] : together.tetrahedra) sum.add({x[a], x[b], x[c], x[d]});
    const PartMoments moments = sum.moments();
    const bool is_whole = std::abs(moments.fraction - 1) < whole_rounding;
    writer_.end_copy(copy, is_whole ? PartMoments{} : moments);
  }

  /// One material of all, without the lips that they have in common. What is at the same place is
  /// one point: where a lip ends, the others go on.
  static Material united(std::span<const Material> materials) {
    Material result;
    std::map<Vec3, Index> number_at;
    Index first_cell = 0;
    for (const Material& material : materials) {
      const auto number = [&](Index p) {
        const Vec3& at = material.points[p];
        const auto [known, is_new] =
            number_at.try_emplace(at, static_cast<Index>(result.points.size()));
        if (is_new) result.points.push_back(at);
        return known->second;
      };
      for (const auto& [a, b, c, d] : material.tetrahedra)
        result.tetrahedra.push_back({number(a), number(b), number(c), number(d)});
      for (const Index cell : material.cells) result.cells.push_back(first_cell + cell);
      first_cell = std::ranges::max(result.cells) + 1;
      for (std::size_t t = 0; t < material.triangles.size(); ++t) {
        if (material.is_cut[t] != 0 && has_lip_before(material, t, materials)) continue;
        const auto& [a, b, c] = material.triangles[t];
        result.triangles.push_back({number(a), number(b), number(c)});
        result.is_cut.push_back(std::uint8_t{material.is_cut[t]});
      }
    }
    return result;
  }
  static LipTriangle lip(const Material& material, std::size_t t) {
    const auto& [a, b, c] = material.triangles[t];
    return LipTriangle({material.points[a], material.points[b], material.points[c]});
  }
  /// Whether a lip of another part lies on that triangle of a lip.
  static bool has_lip_before(const Material& material, std::size_t t,
                             std::span<const Material> materials) {
    const LipTriangle here = lip(material, t);
    for (const Material& other : materials)
      for (std::size_t i = 0; i < other.triangles.size() && &other != &material; ++i)
        if (other.is_cut[i] != 0)
          if (const LipTriangle there = lip(other, i); there.faces(here) && there.covers(here))
            return true;
    return false;
  }

  const CellComplex& complex_;
  const Parts& parts_;
  PartMaterials materials_;
  FaceContacts faces_;
  std::span<const Index> points_;
  const std::vector<std::vector<Index>>& groups_;
  std::vector<Index> copy_of_;  ///< by element; none: it stays
  std::vector<std::size_t> group_of_copy_;
  std::unordered_map<FacePoints, std::vector<Dart>, HashOfPoints> sides_;
  std::vector<SideContact> contacts_;
  std::unordered_set<Dart> joined_;  ///< first darts of sides
  Reunion result_;
  PartWriter writer_;  ///< of the result
};

}  // namespace

std::vector<std::vector<Index>> divided_groups(const CellComplex& complex,
                                               std::span<const Index> origin,
                                               const std::vector<std::uint8_t>& is_wanted) {
  std::map<Index, std::vector<Index>> of_origin;
  for (Index e = 0; e < complex.element_count(); ++e)
    if (complex.exists(3, e) && is_wanted[e] != 0) of_origin[origin[e]].push_back(e);
  std::vector<std::vector<Index>> groups;
  for (auto& [from, elements] : of_origin)
    if (elements.size() > 1) groups.push_back(std::move(elements));
  return groups;
}

Reunion reunite(const CellComplex& complex, const Parts& parts,
                std::span<const Index> point_of_vertex,
                const std::vector<std::vector<Index>>& groups) {
  return Uniter(complex, parts, point_of_vertex, groups).find();
}

}  // namespace suture
