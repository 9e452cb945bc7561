// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/general_part.hpp"

#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/parts/cube_sides.hpp"
#include "kernel/parts/moments.hpp"

// Formulas
// ========
//
// In the frame of its edges E = dX/dx at the centre, the element is
//   Y = x + sum_k c_k h_k,   h = yz, zx, xy, xyz,   J = dY/dx = 1 + sum_k c_k (x) dh_k/dx.
// With the integrals over the part, and over the whole cube,
//   V = integral of det J,   g_k = integral of grad_Y h_k det J = integral of cof(J) dh_k/dx,
// the part has the fraction V / V_cube and d_k = g_k / V - (g_k / V)_cube (suture/parts.h). Both
// integrands have at most the degree 4: two columns of J never have a factor xyz both, as det and
// cof vanish for columns that are parallel.

namespace suture {
namespace {

class RestIntegral {
 public:
  explicit RestIntegral(const std::array<Vec3, 4>& c) : c_(c) {}

  void add(const Vec3& at, double weight) {
    const auto& [x, y, z] = at;
    const std::array<Vec3, 4> slopes{{{0, z, y}, {z, 0, x}, {y, x, 0}, {y * z, z * x, x * y}}};
    std::array<Vec3, 3> J{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  // columns
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t a = 0; a < 3; ++a) J[a] = plus(J[a], scaled(slopes[k][a], c_[k]));
    const std::array<Vec3, 3> cof{cross(J[1], J[2]), cross(J[2], J[0]), cross(J[0], J[1])};
    volume_ += weight * dot(J[0], cof[0]);
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t a = 0; a < 3; ++a)
        gradients_[k] = plus(gradients_[k], scaled(weight * slopes[k][a], cof[a]));
  }

  double volume() const { return volume_; }
  Vec3 mean_gradient(std::size_t k) const { return scaled(1 / volume_, gradients_[k]); }

 private:
  std::array<Vec3, 4> c_;
  double volume_ = 0;
  std::array<Vec3, 4> gradients_{};
};

std::array<Vec3, 4> hourglasses_in_frame(const std::array<Vec3, 8>& rest) {
  std::array<Vec3, 3> E{};
  std::array<Vec3, 4> H{};
  for (std::size_t n = 0; n < 8; ++n) {
    const Vec3 s = corner_place(n), X = scaled(0.125, rest[n]);
    for (std::size_t a = 0; a < 3; ++a) {
      E[a] = plus(E[a], scaled(s[a], X));
      H[a] = plus(H[a], scaled(s[(a + 1) % 3] * s[(a + 2) % 3], X));
    }
    H[3] = plus(H[3], scaled(s[0] * s[1] * s[2], X));
  }
  const std::array<Vec3, 3> normals{cross(E[1], E[2]), cross(E[2], E[0]), cross(E[0], E[1])};
  const double volume = dot(E[0], normals[0]);
  for (Vec3& h : H)
    h = {dot(normals[0], h) / volume, dot(normals[1], h) / volume, dot(normals[2], h) / volume};
  return H;
}

/// Exact for degree 5: N. J. Walkington, Quadrature on simplices of arbitrary dimension (2000).
/// visit(place, share of the volume)
template <class Visit>
void for_each_point(const std::array<Vec3, 4>& corners, Visit visit) {
  Vec3 sum{};
  for (const Vec3& p : corners) sum = plus(sum, p);
  // a at three corners, 1 - 3 a at one
  for (const auto& [a, weight] : {std::pair{0.31088591926330060980, 0.11268792571801585080},
                                  std::pair{0.09273525031089122640, 0.07349304311636194954}})
    for (const Vec3& p : corners) visit(plus(scaled(a, sum), scaled(1 - 4 * a, p)), weight);
  // a at two corners, 1/2 - a at two
  constexpr double a = 0.04550370412564964949, weight = 0.04254602077708146644;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j)
      visit(plus(scaled(a, sum), scaled(0.5 - 2 * a, plus(corners[i], corners[j]))), weight);
}

}  // namespace

GeneralPart general_part(const Parts& parts, std::size_t place, const std::array<Vec3, 8>& rest) {
  const std::array<Vec3, 4> c = hourglasses_in_frame(rest);
  RestIntegral part(c), cube(c);
  for (Index t = parts.first[place]; t < parts.first[place + 1]; ++t) {
    std::array<Vec3, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) corners[i] = parts.points[parts.tetrahedra[t][i]].at;
    const double volume = six_volumes(corners) / 6;
    for_each_point(corners, [&](const Vec3& at, double share) { part.add(at, share * volume); });
  }
  for (std::size_t n = 0; n < 8; ++n) cube.add(scaled(1 / std::sqrt(3), corner_place(n)), 1);
  GeneralPart result;
  result.fraction = part.volume() / cube.volume();
  if (!(result.fraction > 0) || !std::isfinite(result.fraction))
    throw NumericalError("a part of an element has " + std::to_string(result.fraction) +
                         " of its volume at rest, expected more than 0: the element is turned "
                         "inside out there; improve the mesh, or cut along \"faces\"");
  for (std::size_t k = 0; k < 4; ++k)
    result.gradients[k] = minus(part.mean_gradient(k), cube.mean_gradient(k));
  return result;
}

}  // namespace suture
