// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/patch.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/base/rows.hpp"
#include "kernel/contact/row_lanes.hpp"
#include "kernel/solvers/clones.hpp"

namespace suture {
namespace {

constexpr int iterations = 2;
constexpr std::size_t lanes = 8;
typedef double Eight __attribute__((vector_size(64)));

/// A vector in space, or eight: T is double or Eight.
template <class T>
struct Space {
  T x, y, z;
};
template <class T>
SUTURE_INLINE Space<T> operator+(const Space<T>& a, const Space<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
SUTURE_INLINE Space<T> operator-(const Space<T>& a, const Space<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
SUTURE_INLINE Space<T> operator*(const T& s, const Space<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T>
SUTURE_INLINE T inner(const Space<T>& a, const Space<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
SUTURE_INLINE Space<T> cross_of(const Space<T>& a, const Space<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
SUTURE_INLINE T clamped(const T& a) {
  const T zero{}, one = zero + 1;
  const T above = a > zero ? a : zero;
  return above < one ? above : one;
}
/// With a comparison of distances: gcc computes one of two conditions lane by lane.
template <class T>
SUTURE_INLINE T if_clamped(const T& a, const T& then, const T& otherwise) {
  const T zero{}, beyond = a < zero ? zero - a : a - 1;
  return beyond > zero ? then : otherwise;
}
SUTURE_INLINE double root(double a) { return std::sqrt(a); }
SUTURE_INLINE Eight root(const Eight& a) {
  Eight roots;
  for (std::size_t l = 0; l < lanes; ++l) roots[l] = std::sqrt(a[l]);
  return roots;
}

/// Towards the minimum of |offset - a dr - b ds| within the square. On a side, the other coordinate
/// has a minimum of its own.
template <class T>
SUTURE_INLINE void improve(T& r, T& s, const Space<T>& a, const Space<T>& b,
                           const Space<T>& offset) {
  const T aa = inner(a, a), ab = inner(a, b), bb = inner(b, b);
  const T fa = inner(a, offset), fb = inner(b, offset), det = aa * bb - ab * ab, zero{};
  const T free_r = r + (bb * fa - ab * fb) / det, free_s = s + (aa * fb - ab * fa) / det;
  const T near_r = clamped(free_r), near_s = clamped(free_s);
  const T side_s = clamped(s + (fb - ab * (near_r - r)) / bb);
  const T side_r = clamped(r + (fa - ab * (near_s - s)) / aa);
  const T to_s = if_clamped(free_r, side_s, near_s);
  const T to_r = if_clamped(free_r, near_r, if_clamped(free_s, side_r, near_r));
  r = det > zero ? to_r : r;
  s = det > zero ? to_s : s;
}

template <class T>
struct FootOf {
  T r, s;
  Space<T> normal, offset;
};

/// x(r, s) = p0 + r e + s f + r s w.
template <class T>
SUTURE_INLINE FootOf<T> foot_on(const std::array<Space<T>, 4>& corners, const Space<T>& place) {
  const Space<T> e = corners[1] - corners[0], f = corners[3] - corners[0];
  const Space<T> w = corners[2] - corners[1] - f, from_first = place - corners[0];
  const T zero{}, one = zero + 1;
  FootOf<T> foot{zero + 0.5, zero + 0.5, {}, {}};
  Space<T> a{}, b{};
  for (int i = 0; i <= iterations; ++i) {
    a = e + foot.s * w;
    b = f + foot.r * w;
    foot.offset = from_first - foot.r * a - foot.s * f;
    if (i < iterations) improve(foot.r, foot.s, a, b, foot.offset);
  }
  const Space<T> normal = cross_of(a, b);
  const T length = root(inner(normal, normal));
  const T factor = length > zero ? one / length : zero;
  foot.normal = {factor * normal.x, factor * normal.y, length > zero ? factor * normal.z : one};
  return foot;
}

Space<double> space(const Vec3& a) { return {a[0], a[1], a[2]}; }
Vec3 vec(const Space<double>& a) { return {a.x, a.y, a.z}; }

SUTURE_INLINE void load(Space<Eight>& to, std::size_t lane, const double* row) {
  to.x[lane] = row[0];
  to.y[lane] = row[1];
  to.z[lane] = row[2];
}

/// Eight feet; the last ones again if there are fewer pairs.
SUTURE_INLINE void find_eight(const double* positions, const BoundarySurface::Corners* corners,
                              const NearPair* pairs, std::size_t count, FaceFoot* feet) {
  std::array<Space<Eight>, 4> of_face;
  Space<Eight> place;
  for (std::size_t l = 0; l < lanes; ++l) {
    const NearPair pair = pairs[l < count ? l : count - 1];
    load(place, l, positions + 4 * std::size_t{pair.vertex});
    for (std::size_t i = 0; i < 4; ++i)
      load(of_face[i], l, positions + 4 * std::size_t{corners[pair.face][i]});
  }
  const FootOf<Eight> foot = foot_on(of_face, place);
  const Eight gap = inner(foot.offset, foot.normal);
  const Space<Eight> beside = foot.offset - gap * foot.normal;
  const Eight distance = root(inner(foot.offset, foot.offset)), off = root(inner(beside, beside));
  for (std::size_t l = 0; l < count; ++l)
    feet[l] = {foot.r[l], foot.s[l],   {foot.normal.x[l], foot.normal.y[l], foot.normal.z[l]},
               gap[l],    distance[l], off[l]};
}

SUTURE_CLONES
void find_all(const double* positions, const BoundarySurface::Corners* corners,
              const NearPair* pairs, std::size_t count, FaceFoot* feet) {
  for (std::size_t i = 0; i < count; i += lanes)
    find_eight(positions, corners, pairs + i, count - i < lanes ? count - i : lanes, feet + i);
}

/// Eight planes; of fewer faces the last one again.
SUTURE_INLINE void find_eight_planes(const double* positions,
                                     const BoundarySurface::Corners* corners, std::size_t count,
                                     double depth, double beside, FacePlane* planes, Vec3* areas) {
  std::array<Space<Eight>, 4> at;
  for (std::size_t l = 0; l < lanes; ++l)
    for (std::size_t i = 0; i < 4; ++i)
      load(at[i], l, positions + 4 * std::size_t{corners[l < count ? l : count - 1][i]});
  const Eight zero{}, one = zero + 1.0, quarter = zero + 0.25;
  const Space<Eight> area = cross_of(at[2] - at[0], at[3] - at[1]);
  const Eight length = root(inner(area, area));
  const Eight inverse = length > zero ? one / length : zero;
  const Space<Eight> normal = inverse * area;
  const Space<Eight> centre = quarter * ((at[0] + at[1]) + (at[2] + at[3]));
  const Eight above = inner(normal, at[0] - centre), height = above < zero ? -above : above;
  Eight squared = zero;
  for (const Space<Eight>& corner : at) {
    const Space<Eight> arm = corner - centre;
    const Eight here = inner(arm, arm);
    squared = squared < here ? here : squared;
  }
  const Eight radius = root(squared), lean = 16 * height * radius * inverse;
  const Eight known = lean < one ? lean : one, sine = length > zero ? known : one;
  const Eight reach = radius + (beside + sine * depth);
  for (std::size_t l = 0; l < count; ++l) {
    planes[l] = {{normal.x[l], normal.y[l], normal.z[l]},
                 {centre.x[l], centre.y[l], centre.z[l]},
                 height[l],
                 reach[l] * reach[l]};
    areas[l] = {area.x[l], area.y[l], area.z[l]};
  }
}

SUTURE_CLONES
void find_all_planes(const double* positions, const BoundarySurface::Corners* corners,
                     std::size_t count, double depth, double beside, FacePlane* planes,
                     Vec3* areas) {
  for (std::size_t i = 0; i < count; i += lanes)
    find_eight_planes(positions, corners + i, count - i < lanes ? count - i : lanes, depth, beside,
                      planes + i, areas + i);
}

}  // namespace

Patch patch_of(const BoundarySurface::Corners& corners, const double* positions) {
  Patch patch;
  for (std::size_t i = 0; i < 4; ++i) patch.corners[i] = row(positions, corners[i]);
  return patch;
}

std::array<double, 4> Patch::weights_at(double r, double s) {
  return {(1 - r) * (1 - s), r * (1 - s), r * s, (1 - r) * s};
}

Vec3 Patch::centre() const {
  return scaled(0.25, plus(plus(corners[0], corners[1]), plus(corners[2], corners[3])));
}

Patch::Foot Patch::foot(const Vec3& place) const {
  const FootOf<double> foot = foot_on<double>(
      {space(corners[0]), space(corners[1]), space(corners[2]), space(corners[3])}, space(place));
  return {weights_at(foot.r, foot.s), vec(foot.normal), vec(foot.offset)};
}

void find_feet(const double* positions, std::span<const BoundarySurface::Corners> corners,
               std::span<const NearPair> pairs, std::vector<FaceFoot>& feet) {
  feet.resize(pairs.size());
  find_all(positions, corners.data(), pairs.data(), pairs.size(), feet.data());
}

void find_planes(const double* positions, std::span<const BoundarySurface::Corners> corners,
                 double depth, double beside, std::vector<FacePlane>& planes,
                 std::vector<Vec3>& areas) {
  planes.resize(corners.size());
  areas.resize(corners.size());
  find_all_planes(positions, corners.data(), corners.size(), depth, beside, planes.data(),
                  areas.data());
}

}  // namespace suture
