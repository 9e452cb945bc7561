// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/forces/term_capabilities.hpp"
#include "kernel/parts/surface_triangle.hpp"

// Springs to ground on a surface
// ==============================
//
//   ////////////////  ground    What lies around a body, and is not computed itself, resists its
//    |   |   |   |              surface in proportion to the displacement u = x - X. The traction
//   +-------------+             is, with the outward normal N at rest (a Robin condition),
//   |    body     |
//   +-------------+                t = - k_n (u . N) N - k_t (u - (u . N) N) - c v
//
// The weak form is lumped at the corners: f = - K_c (x - X_c) - C_c v for corner c of an element,
//
//   K_c = integral of N_c (k_n N N^T + k_t (1 - N N^T)) dA,   C_c = integral of N_c c dA.
//
// Rigid translations feel exactly the whole stiffness; otherwise, the error is of second order in
// the size of elements, as with the element itself.

namespace suture {

/// Stiffness and damping per area of a foundation.
struct FoundationLaw {
  double normal = 0;      ///< k_n, Pa/m
  double tangential = 0;  ///< k_t, Pa/m
  double damping = 0;     ///< c, Pa s/m
};

/// Foundations on faces of elements or on triangles of an embedded surface. They follow cuts: each
/// piece keeps the springs of its part of the surface. A face that is removed or sewn loses its
/// springs permanently. Costs O(corners) per step.
class Foundations final : public ForceTerm,
                          public TangentTerm,
                          public CellTangentTerm,
                          public BoundedTerm,
                          public EnergyTerm,
                          public WorkTerm {
 public:
  explicit Foundations(Attributes& attributes) : attributes_(attributes) {}

  /// `faces`: any dart of each, on the side of the element. Throws InputError for no faces.
  void add(const CellComplex& complex, std::span<const Dart> faces, const FoundationLaw& law);
  /// The same on triangles of an embedded surface.
  void add(const CellComplex& complex, std::span<const SurfaceTriangle> triangles,
           const FoundationLaw& law);

  const char* name() const override { return "foundation"; }
  void add_forces(double time, const LiveMask& live, double* rows) override;
  void add_forces_in_step(const StepTimes& step, const LiveMask& live, double* rows) override;
  void add_forces_at(const VertexSelection& selection, std::span<const Index> vertices, double time,
                     std::vector<Vec3>& forces) override;
  bool adds_no_rows() const override { return supports_.empty(); }
  bool marks_vertices() const override { return !is_damped_; }
  void mark_vertices(std::vector<bool>& marks) const override;

  bool is_stiff() const override { return !supports_.empty(); }
  bool is_anchored() const override { return true; }
  void add_tangent(const double* d, double dx, double dv, const TangentTime& at,
                   double* out) override;
  bool add_tangent_in_single(const float* d, double dx, double dv, const TangentTime& at,
                             float* out) override;
  void for_each_tangent(double dx, double dv, const TangentTime& at,
                        const VisitTangents& visit) override;
  void add_bounds(double time, const AddBounds& sums) override;

  /// sum (x - X_c) . K_c (x - X_c) / 2
  double energy(double time) override;
  /// The work of the dampers.
  double work() const override { return work_; }
  void forget_last() override { booked_.clear(); }
  void restart() override;

  void follow(const CellComplex& complex, const TopologyChange& change) override;
  void state(Archive& archive) override;

 private:
  struct Patch {
    SurfaceTriangle triangle;
    Index law;
    Dart face = none;  ///< on bodies without an embedded surface: the face that it is half of
  };
  /// A vertex, or one of the corners that meet there, if these have rest positions of their own.
  struct Support {
    Index vertex;
    Vec3 rest;                        ///< X_c, m
    std::array<double, 6> stiffness;  ///< K_c, N/m: XX YY ZZ XY YZ XZ
    double damping;                   ///< C_c, N s/m
  };
  struct Booked {
    Vec3 position, force;  ///< force of the damper
  };

  void build(const CellComplex& complex);
  void add_supports(const Patch& patch, const RestPlaces& rest);
  void add_copies(std::span<const Split> copies);
  Vec3 displacement(const Support& support) const;
  Vec3 damping_force(const Support& support) const;
  Vec3 force(const Support& support) const;
  template <class Real>
  void multiply(const Real* d, double dx, double dv, Real* out) const;

  Attributes& attributes_;
  std::vector<FoundationLaw> laws_;
  bool is_damped_ = false;
  std::vector<Patch> patches_;
  std::vector<Support> supports_;  ///< by vertex, ascending
  double work_ = 0;
  std::vector<Booked> booked_;  ///< by support, at the last step; empty: no step yet
};

}  // namespace suture
