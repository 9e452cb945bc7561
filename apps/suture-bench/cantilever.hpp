// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "apps/suture-bench/body.hpp"

namespace suture::bench {

/// In a report: no figure.
inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// The paper's cantilever (1 m x 0.25 m x 0.25 m, E = 400 kPa, rho = 1000) under its weight, and
/// the deflections of its tip by independent programs: DOLFINx and FreeFem++, as in
/// tests/reference/beam.hpp and blocks.hpp.
struct Cantilever {
  std::string name;
  double gravity, nu;        ///< m/s^2, -
  double discrete[3];        ///< m, of 5x5x20, 10x10x40 and 20x20x80 trilinear elements
  double converged;          ///< m
  bool is_converged = true;  ///< false: that of the finest mesh; there is no limit

  /// NaN for other meshes.
  double discrete_tip(Index across) const;
};

std::span<const Cantilever> cantilevers();
/// Throws UsageError naming the nearest.
const Cantilever& cantilever(std::string_view name);

struct CantileverMesh {
  Index across = 10;       ///< elements over the height; four times that along
  std::string element{};   ///< of models that have this parameter; empty: their default
  bool distorted = false;  ///< general hexahedra
};

BodyOptions options_of(const Cantilever& what, const suture_model& model,
                       const CantileverMesh& mesh);

/// Deflection of the centre of the free end, m.
double tip_of(BenchBody& body, Index across);

/// Iterations of a body's implicit steps since its construction.
class Work {
 public:
  explicit Work(Dynamics& dynamics);
  ~Work();
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;
  double newton = 0, krylov = 0, coarse = 0;  ///< iterations of the body, and on coarse levels

 private:
  Dynamics& dynamics_;
};

}  // namespace suture::bench
