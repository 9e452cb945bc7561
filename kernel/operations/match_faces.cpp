// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/match_faces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <tuple>
#include <unordered_map>
#include <unordered_set>

#include "kernel/base/error.hpp"
#include "kernel/base/saturate.hpp"

namespace suture {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

bool is_boundary(const CellComplex& complex, Dart face) { return complex.beta3(face) == none; }

/// The dart of `other`'s face that is opposite to `one` if that face is turned by `turn`.
Dart partner(Dart other, Dart turn) { return (other & ~3u) | (turn & 3u); }

bool are_joined(const CellComplex& complex, Index e, Index other) {
  for (int f = 0; f < hexahedron::faces; ++f)
    if (complex.neighbour(e, f) == other) return true;
  return false;
}

/// The turn at which both faces have the same points, corner by corner.
std::optional<Seam> same_points(const CellComplex& complex, Dart one, Dart other,
                                std::span<const Index> points) {
  for (Dart turn = 0; turn < 4; ++turn) {
    const Seam seam{one, partner(other, turn)};
    bool same = true;
    for (Dart k = 0; k < 4; ++k) {
      same = same &&
             points[corner_vertex(complex, seam, k)] == points[partner_vertex(complex, seam, k)];
    }
    if (same) return seam;
  }
  return {};
}

// ------------------------------------------------------ by place --

struct FacePlaces {
  const CellComplex& complex;
  const double* rows;
  std::size_t stride;

  const double* at(Index vertex) const { return rows + stride * vertex; }
  double distance2(Index v, Index w) const {
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += (at(v)[c] - at(w)[c]) * (at(v)[c] - at(w)[c]);
    return sum;
  }
  Vec3 centre(Dart face) const {
    Vec3 sum{};
    for (Dart k = 0; k < 4; ++k)
      for (std::size_t c = 0; c < 3; ++c) sum[c] += at(complex.origin(face_of(face) + k))[c] / 4;
    return sum;
  }
  /// Cross product of the diagonals: twice the area, inward.
  Vec3 area(Dart face) const {
    const Dart d = face_of(face);
    Vec3 p, q;
    for (std::size_t c = 0; c < 3; ++c) {
      p[c] = at(complex.origin(d + 2))[c] - at(complex.origin(d))[c];
      q[c] = at(complex.origin(d + 3))[c] - at(complex.origin(d + 1))[c];
    }
    return {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
  }
  /// Opposite sides, with 60 degrees to spare (those at the edge of a box are at 90),
  /// neither behind the other by more than half an edge: lips of a cut may have gone
  /// through each other, while the two ends of a beam face away from each other.
  bool face_each_other(Dart one, Dart other) const {
    const Vec3 a = area(one), b = area(other), from = centre(one), to = centre(other);
    double opposite = 0, behind_one = 0, behind_other = 0, a2 = 0, b2 = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      opposite -= a[c] * b[c];
      behind_one += a[c] * (to[c] - from[c]);
      behind_other += b[c] * (from[c] - to[c]);
      a2 += a[c] * a[c];
      b2 += b[c] * b[c];
    }
    // |area| is twice the face's: half an edge is sqrt(|area| / 8).
    const auto depth = [](double area2) { return std::sqrt(area2 * std::sqrt(area2) / 8); };
    return opposite > 0.5 * std::sqrt(a2 * b2) && behind_one < depth(a2) &&
           behind_other < depth(b2);
  }
};

/// Two faces as near as they can be turned: the largest distance of two corners.
struct Pairing {
  Seam seam;
  double distance = infinite;  ///< m
};

Pairing nearest_turn(const FacePlaces& places, Dart one, Dart other) {
  Pairing best;
  for (Dart turn = 0; turn < 4; ++turn) {
    const Seam seam{one, partner(other, turn)};
    double worst = 0;
    for (Dart k = 0; k < 4; ++k)
      worst = std::max(worst, places.distance2(corner_vertex(places.complex, seam, k),
                                               partner_vertex(places.complex, seam, k)));
    if (std::sqrt(worst) < best.distance) best = {seam, std::sqrt(worst)};
  }
  return best;
}

std::vector<Dart> boundary_faces(const CellComplex& complex, std::span<const Index> elements) {
  std::vector<Dart> faces;
  for (const Index e : elements)
    if (complex.exists(3, e))
      std::ranges::copy_if(sides_of(e), std::back_inserter(faces),
                           [&](Dart d) { return is_boundary(complex, d); });
  return faces;
}

/// Faces by the cube that their centre is in.
class Grid {
 public:
  explicit Grid(double edge) : edge_(edge) {}
  void add(const Vec3& p, Dart face) { cubes_[key(cube(p))].push_back(face); }
  template <class Visit>
  void near(const Vec3& p, Visit visit) const {
    const auto c = cube(p);
    for (int n = 0; n < 27; ++n) {
      const auto found =
          cubes_.find(key({c[0] + n % 3 - 1, c[1] + n / 3 % 3 - 1, c[2] + n / 9 - 1}));
      if (found == cubes_.end()) continue;
      for (const Dart face : found->second) visit(face);
    }
  }

 private:
  using Cube = std::array<std::int64_t, 3>;
  Cube cube(const Vec3& p) const {
    Cube c;
    for (std::size_t a = 0; a < 3; ++a) c[a] = saturate<std::int64_t>(std::floor(p[a] / edge_));
    return c;
  }
  // Cubes that share a key only cost time: distances are compared afterwards.
  static std::uint64_t key(const Cube& c) {
    std::uint64_t k = 0;
    for (const std::int64_t i : c) k = (k ^ static_cast<std::uint64_t>(i)) * 0x9E3779B97F4A7C15u;
    return k;
  }
  double edge_;
  std::unordered_map<std::uint64_t, std::vector<Dart>> cubes_;
};

/// The edge of cubes in which centres within the gap are neighbours; a smaller gap than coordinates
/// can resolve would give them numbers that no integer holds.
double cube_edge(const FacePlaces& places, const std::vector<Dart>& faces, double gap) {
  double largest = 0;
  for (const Dart face : faces)
    for (const double x : places.centre(face)) largest = std::max(largest, std::abs(x));
  return std::max({gap, 1e-12 * largest, std::numeric_limits<double>::min()});
}

/// All pairs of faces that face each other, whose centres are within the gap and whose
/// elements have no face in common; nearest first.
std::vector<Pairing> pairings(const FacePlaces& places, const std::vector<Dart>& a,
                              const std::vector<Dart>& b, double gap) {
  Grid grid(std::max(cube_edge(places, a, gap), cube_edge(places, b, gap)));
  for (const Dart face : b) grid.add(places.centre(face), face);
  std::vector<Pairing> found;
  for (const Dart face : a) {
    const Vec3 p = places.centre(face);
    grid.near(p, [&](Dart other) {
      if (element_of(other) == element_of(face) || !places.face_each_other(face, other)) return;
      if (are_joined(places.complex, element_of(face), element_of(other))) return;
      const Vec3 q = places.centre(other);
      if (std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]) <= gap)
        found.push_back(nearest_turn(places, face, other));
    });
  }
  std::ranges::sort(found, [](const Pairing& x, const Pairing& y) {
    return std::tie(x.distance, x.seam.one, x.seam.other) <
           std::tie(y.distance, y.seam.one, y.seam.other);
  });
  return found;
}

std::string side_name(Dart face) {
  static constexpr const char* names[] = {"x0", "y0", "x1", "y1", "z0", "z1"};
  return names[local_face(face)];
}

std::string apart_text(double distance) {
  std::ostringstream text;
  text << "corners are " << distance << " m apart";
  return text.str();
}

}  // namespace

std::string misfits_text(const std::vector<Misfit>& misfits, const Naming& naming) {
  std::string text = std::to_string(misfits.size()) +
                     (misfits.size() == 1 ? " pair of faces stays" : " pairs of faces stay") +
                     " open:";
  for (std::size_t i = 0; i < misfits.size() && i < 4; ++i) {
    const auto& [seam, reason] = misfits[i];
    text += "\n  side " + side_name(seam.one) + " of element " +
            naming.element(element_of(seam.one)) + " and side " + side_name(seam.other) +
            " of element " + naming.element(element_of(seam.other)) + ": " + reason;
  }
  return text + (misfits.size() > 4 ? "\n  ..." : "");
}

MatchedSeams seams_of_cuts(const CellComplex& complex, std::span<const Index> point_of_vertex,
                           std::span<const Index> elements, const Naming& naming) {
  std::map<std::array<Index, 4>, Dart> open;  // by their points, sorted
  std::vector<Seam> seams;
  const auto add = [&](Index e) {
    if (!complex.exists(3, e)) return;
    for (const Dart d : sides_of(e)) {
      if (!is_boundary(complex, d)) continue;
      std::array<Index, 4> points;
      for (Dart k = 0; k < 4; ++k) points[k] = point_of_vertex[complex.origin(d + k)];
      std::ranges::sort(points);
      const auto [place, fresh] = open.try_emplace(points, d);
      if (fresh) continue;
      if (const auto seam = same_points(complex, place->second, d, point_of_vertex)) {
        seams.push_back(*seam);
        open.erase(place);
      }
    }
  };
  if (elements.empty())
    for (Index e = 0; e < complex.element_count(); ++e) add(e);
  for (const Index e : elements) add(e);
  std::ranges::sort(seams, {}, &Seam::one);
  SeamBatch batch(complex);
  MatchedSeams result;
  for (const Seam seam : seams)
    if (auto reason = batch.add(seam, naming)) result.misfits.push_back({seam, *reason});
  result.seams = batch.seams();
  return result;
}

MatchedSeams seams_within_gap(const CellComplex& complex, const double* rows,
                              std::span<const Index> a, std::span<const Index> b, double gap,
                              const Naming& naming, std::size_t stride) {
  const FacePlaces places{complex, rows, stride};
  const std::vector<Dart> of_a = boundary_faces(complex, a), of_b = boundary_faces(complex, b);
  SeamBatch batch(complex);
  MatchedSeams result;
  for (const auto& [seam, distance] : pairings(places, of_a, of_b, gap)) {
    if (batch.has(seam.one) || batch.has(seam.other)) continue;
    const auto reason =
        distance > gap ? std::optional(apart_text(distance)) : batch.add(seam, naming);
    if (reason) result.misfits.push_back({seam, *reason});
  }
  // A face that matches one neighbour need not match the others, and is reported once.
  std::unordered_set<Dart> reported;
  std::erase_if(result.misfits, [&](const Misfit& misfit) {
    const auto [one, other] = misfit.seam;
    if (batch.has(one) || batch.has(other)) return true;
    const bool first = reported.insert(face_of(one)).second;
    const bool second = reported.insert(face_of(other)).second;
    return !first || !second;
  });
  result.seams = batch.seams();
  return result;
}

namespace {

/// The seam of one pair; nothing if there is none to make (`idle`).
std::optional<Seam> seam_between(const FacePlaces& places, const std::string& path,
                                 const ElementPair& pair,
                                 const std::function<Index(std::uint64_t)>& element_of,
                                 std::span<const Index> points) {
  const CellComplex& complex = places.complex;
  std::array<Index, 2> e;
  for (std::size_t i = 0; i < 2; ++i) {
    e[i] = element_of(pair[i]);
    if (e[i] == none)
      throw InputError(path + ": the mesh has no element " + std::to_string(pair[i]));
  }
  if (!complex.exists(3, e[0]) || !complex.exists(3, e[1])) return {};
  const std::vector<Dart> of_one = boundary_faces(complex, std::span(&e[0], 1)),
                          of_other = boundary_faces(complex, std::span(&e[1], 1));
  for (const Dart one : of_one)
    for (const Dart other : of_other)
      if (const auto seam = same_points(complex, one, other, points)) return seam;
  if (are_joined(complex, e[0], e[1])) return {};
  Pairing best;
  for (const Dart one : of_one)
    for (const Dart other : of_other)
      if (places.face_each_other(one, other)) {
        const Pairing pairing = nearest_turn(places, one, other);
        if (pairing.distance < best.distance) best = pairing;
      }
  if (best.distance < infinite) return best.seam;
  throw InputError(path + ": elements " + std::to_string(pair[0]) + " and " +
                   std::to_string(pair[1]) +
                   " have no boundary faces that face each other, so there is nothing to sew");
}

}  // namespace

ListedSeams seams_between(const CellComplex& complex, const double* rows, const std::string& path,
                          std::span<const ElementPair> pairs,
                          const std::function<Index(std::uint64_t)>& element_of,
                          std::span<const Index> point_of_vertex, const Naming& naming,
                          std::size_t stride) {
  ListedSeams result;
  SeamBatch batch(complex);
  std::string faults;
  for (std::size_t i = 0; i < pairs.size(); ++i) try {
      const std::string here = path + "/" + std::to_string(i);
      const auto seam =
          seam_between({complex, rows, stride}, here, pairs[i], element_of, point_of_vertex);
      if (!seam)
        result.idle.push_back(pairs[i]);
      else if (const auto reason = batch.add(*seam, naming))
        throw InputError(here + ": elements " + std::to_string(pairs[i][0]) + " and " +
                         std::to_string(pairs[i][1]) + " cannot be sewn: " + *reason +
                         "; nothing was sewn");
    } catch (const InputError& error) {
      faults += (faults.empty() ? "" : "\n") + std::string(error.what());
    }
  if (!faults.empty()) throw InputError(faults);
  result.seams = batch.seams();
  return result;
}

}  // namespace suture
