// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kernel/forces/pressures.hpp"

namespace suture {

/// Pressures that keep the volumes which boundary faces enclose, of a whole body or of a cavity:
///   U = kappa / (2 |V0|) (V - V0)^2,   p = kappa (V - V0) / |V0|, inward
/// V is the volume on the side of the elements: that of a body, and minus that of a cavity. Both
/// are those of bilinear faces, exactly; V0 is that of the rest positions.
///
/// Each closed surface is one volume. The lips of a cut belong to the surfaces that they touch, so
/// each piece of a body that is cut keeps its own volume. A cavity that a cut opens has none any
/// more.
///
/// Every function takes O(faces). The tangent is symmetric, as the surfaces are closed. The part of
/// it that joins all faces of a surface is missing from preconditioners: it has rank one.
class EnclosedVolumes final : public ForceTerm,
                              public TangentTerm,
                              public CellTangentTerm,
                              public WorkTerm {
 public:
  EnclosedVolumes(Attributes& attributes, const CellComplex& complex)
      : attributes_(attributes), complex_(complex) {}

  /// `stiffness`: kappa, Pa. `path`: of the faces, for messages. Throws InputError if the faces do
  /// not enclose a volume.
  void add(std::span<const Dart> faces, double stiffness, const TimeRamp& ramp,
           const std::string& path);

  const char* name() const override { return "volume"; }
  void add_forces(double time, const LiveMask& live, double* rows) override;
  void add_forces_in_step(const StepTimes& step, const LiveMask& live, double* rows) override;
  void add_forces_at(const VertexSelection& selection, std::span<const Index> vertices, double time,
                     std::vector<Vec3>& forces) override;
  bool adds_no_rows() const override { return surfaces_.empty(); }
  bool marks_vertices() const override { return true; }
  void mark_vertices(std::vector<bool>& marks) const override {
    if (pressures_) pressures_->mark_vertices(marks);
  }
  bool is_stiff() const override { return !surfaces_.empty(); }
  void add_tangent(const double* d, double dx, double dv, const TangentTime& at,
                   double* out) override;
  bool add_tangent_in_single(const float* d, double dx, double dv, const TangentTime& at,
                             float* out) override;
  void for_each_tangent(double dx, double dv, const TangentTime& at,
                        const VisitTangents& visit) override;
  double work() const override { return work_; }
  void forget_last() override { is_booked_ = false; }
  void restart() override;
  void follow(const CellComplex& complex, const TopologyChange& change) override;
  void state(Archive& archive) override;
  double last_change() const override;

 private:
  struct Load {
    double stiffness;
    TimeRamp ramp;
  };
  struct Booked {
    double volume = 0, pressure = 0;
  };
  struct Surface {
    std::size_t load = 0;
    std::vector<PressedFace> faces{};
    std::vector<std::array<Index, 4>> nodes{};
    double rest = 0;  ///< V0, m^3
    Booked booked{};  ///< at the last step
    bool is_cavity() const { return rest < 0; }
  };
  Surface measured(std::size_t load, std::vector<PressedFace> faces) const;
  double volume_of(const Surface& surface, Column& positions) const;
  double stiffness_of(const Surface& surface, double time) const;
  Booked state_of(const Surface& surface, double time) const;
  void make_pressures();
  void set_pressures(double time);
  template <class Real>
  void add_common(const Real* d, double dx, double time, Real* out) const;

  Attributes& attributes_;
  const CellComplex& complex_;
  std::vector<Load> loads_;
  std::vector<Surface> surfaces_;
  std::unique_ptr<Pressures> pressures_;  ///< a load for each surface
  double work_ = 0;
  bool is_booked_ = false;
};

}  // namespace suture
