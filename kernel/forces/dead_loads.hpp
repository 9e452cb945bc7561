// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/forces/load_profile.hpp"
#include "kernel/forces/term_capabilities.hpp"
#include "kernel/forces/time_ramp.hpp"
#include "kernel/parts/surface_triangle.hpp"

namespace suture {

/// Forces of constant direction and magnitude. Every load is stored per corner of an element, which
/// no cut changes: a vertex receives the loads of the corners of its elements, so the parts of a
/// split vertex share its load in proportion to their volumes and the total does not change; loads
/// of sewn vertices add up. The share of a removed element is removed with it. A traction on a face
/// that is sewn ends permanently: a cut that opens the face again creates a new surface.
class DeadLoads final : public ForceTerm, public EnergyTerm, public WorkTerm {
 public:
  explicit DeadLoads(Attributes& attributes) : attributes_(attributes) {}

  /// `total` newtons on `vertices`, distributed in proportion to the boundary area around each
  /// (faces whose vertices are all in the set), or equally if a vertex of the set has no such face.
  /// Throws InputError for no vertices.
  void add_force(const CellComplex& complex, std::span<const Index> vertices, const Vec3& total,
                 const TimeRamp& ramp);

  /// Force per rest area (Pa) on faces. `faces`: any dart of each, on the side of the element
  /// that carries it. Throws InputError for no faces.
  void add_traction(const CellComplex& complex, std::span<const Dart> faces, const Vec3& traction,
                    const TimeRamp& ramp, const LoadProfile& profile = {});
  /// The same on triangles of an embedded surface. It follows cuts along blades.
  void add_surface_traction(const CellComplex& complex, std::span<const SurfaceTriangle> triangles,
                            const Vec3& traction, const TimeRamp& ramp,
                            const LoadProfile& profile = {});

  const char* name() const override { return "loads"; }
  /// O(loaded vertices).
  void add_forces(double time, const LiveMask& live, double* rows) override;
  void add_forces_in_step(const StepTimes& step, const LiveMask& live, double* rows) override;
  /// O(selected log loaded).
  void add_forces_at(const VertexSelection& selection, std::span<const Index> vertices, double time,
                     std::vector<Vec3>& forces) override;
  bool adds_no_rows() const override { return loads_.empty(); }
  bool marks_vertices() const override { return true; }
  void mark_vertices(std::vector<bool>& marks) const override;
  /// - sum f . (x - X) over the corners, J.
  double potential(double time) override;
  double work() const override { return work_; }
  void forget_last() override { booked_.clear(); }
  void restart() override;
  /// Updates the vertices of the corners. O(loaded corners).
  void follow(const CellComplex& complex, const TopologyChange& change) override;
  void state(Archive& archive) override;
  double last_change() const override;

 private:
  struct Corner {
    Index element;
    std::uint32_t node;
    Vec3 force;
    Dart face = none;  ///< the boundary face that carries it, if any
  };
  struct Nodal {
    Index vertex;
    Vec3 force;
    double at_rest;  ///< sum of f . X
  };
  struct Load {
    std::vector<Corner> corners;
    std::vector<Nodal> nodal;  ///< the same, summed over the current vertices
    TimeRamp ramp;
    // A traction on triangles that may be divided.
    Vec3 traction{};  ///< Pa
    LoadProfile profile{};
    std::vector<SurfaceTriangle> triangles;
  };
  struct Booked {
    double value, ramp;  ///< sum f . (x - X), and the ramp
  };

  void add_at_vertex(Load& load, const RestPlaces& rest, Index vertex, const Vec3& force) const;
  void add_corners(Load& load, std::span<const SurfaceTriangle> triangles,
                   const RestPlaces& rest) const;
  void load_copies(Load& load, std::span<const Split> copies, const RestPlaces& rest) const;
  static void sum_corners(Load& load, const RestPlaces& rest);
  double value(const Load& load) const;

  Attributes& attributes_;
  std::vector<Load> loads_;
  double work_ = 0;
  std::vector<Booked> booked_;  ///< by load, at the last step; empty before the first
};

}  // namespace suture
