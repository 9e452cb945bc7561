// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/geometry/oriented_surface.hpp"
#include "kernel/operations/plane_patch.hpp"

namespace suture {

/// The blade of a cut that divides elements: a surface with two sides, which may end inside the
/// body.
class Blade {
 public:
  virtual ~Blade() = default;
  /// The signed distance of each vertex of existing elements, which is at rows[stride v], m: NaN
  /// where the blade is more than about two edges away.
  virtual std::vector<double> heights(const CellComplex& complex, const double* rows,
                                      std::size_t stride) const = 0;
  /// True if it ends nowhere: holds() is true everywhere.
  virtual bool is_endless() const = 0;
  /// Whether the point of it that is nearest to a place is not on its rim, or the place is at most
  /// `reach` (m) beyond that.
  virtual bool holds(const Vec3& place, double reach) const = 0;
  /// Whether a cut says how much of it has been opened.
  virtual bool is_measured() const { return !is_endless(); }
  /// Whether it has divided the element before, and must not do so again: along these heights, or
  /// elsewhere.
  enum class Earlier { never, here, elsewhere };
  virtual Earlier earlier_cut(Index /*element*/, const std::vector<double>& /*heights*/) const {
    return Earlier::never;
  }
};

class PlaneBlade final : public Blade {
 public:
  explicit PlaneBlade(const PlanePatch& patch) : patch_(patch) {}
  std::vector<double> heights(const CellComplex& complex, const double* rows,
                              std::size_t stride) const override;
  bool is_endless() const override;
  bool holds(const Vec3& place, double reach) const override {
    return is_inside(patch_, place, reach);
  }

 private:
  PlanePatch patch_;
};

/// Triangles, open or closed. Elements see its distance at their nodes: what is smaller than an
/// element, such as an edge of the blade, is rounded.
class SurfacePatch final : public Blade {
 public:
  /// Equal points are merged. Throws InputError if its two sides cannot be told apart; `origin`:
  /// that of the body, for the message.
  explicit SurfacePatch(TriangleSurface surface, const Vec3& origin = {});
  /// A surface whose points are merged already, at most two triangles at an edge, on different
  /// sides of it. `longest_edge`: of the elements, m.
  SurfacePatch(TriangleSurface surface, double longest_edge);
  const TriangleSurface& surface() const { return surface_.surface(); }
  /// O(vertices), and 1 us for each near the blade.
  std::vector<double> heights(const CellComplex& complex, const double* rows,
                              std::size_t stride) const override;
  /// The same for vertices in one of the boxes, enlarged by the margin, that are `within` m of the
  /// blade.
  std::vector<double> heights_in(std::span<const Box> boxes, double margin,
                                 const CellComplex& complex, const double* rows, std::size_t stride,
                                 double within) const;
  bool is_endless() const override { return false; }
  bool holds(const Vec3& place, double reach) const override;

 private:
  OrientedSurface surface_;
  double longest_edge_ = 0;  ///< of the elements, m; 0: not known
};

/// Returns the longest edge of existing elements, whose vertices are at rows[stride v], m.
double longest_edge(const CellComplex& complex, const double* rows, std::size_t stride);

}  // namespace suture
