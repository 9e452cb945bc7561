// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kernel/forces/pressed_faces.hpp"
#include "kernel/forces/term_capabilities.hpp"
#include "kernel/forces/time_ramp.hpp"

// Why the tangent of pressures has two parts
// ==========================================
//
// It is a sum of cross products, df_a = p sum_b w_ab x du_b. Its symmetric part replaces w_ab by
// (w_ab - w_ba) / 2. The other part cancels between neighbouring faces and remains at free edges,
// where a pressure does work along a closed path:
//
//      free edge          held, or the next face
//         |  p p p p p p  |
//         v  v v v v v v  v
//         +---------------+
//         ^ the other part remains here only
//
// Where it vanishes, a negative eigenvalue proves instability. Where it does not, as in Beck's
// column, GMRES solves the equations of Newton's method.

namespace suture {

/// Pressures, normal to the deformed faces (pressed_faces.hpp). Their tangent
/// (Hibbitt, Int. J. Solids Struct. 15 (1979) 937) is
///   df_a = p  integral of N_a (dx/dr x du/ds - dx/ds x du/dr) dr ds
/// It is symmetric where p is uniform up to edges that are held or absent; of other tangents, the
/// symmetric part is used where a symmetric one is needed.
/// Pressure on a removed element is removed with it; a face that is sewn permanently carries none.
/// Face: PressedFace, or PressedPart on bodies whose surface lies inside elements, or will do so
/// after cuts along blades, which these pressures follow.
template <class Face>
class PressuresOn final : public ForceTerm,
                          public TangentTerm,
                          public CellTangentTerm,
                          public WorkTerm {
 public:
  explicit PressuresOn(Attributes& attributes) : attributes_(attributes) {}

  /// Pa, positive inward. Throws InputError for no faces.
  void add(const CellComplex& complex, std::span<const typename Face::Given> faces, double pressure,
           const TimeRamp& ramp, const LoadProfile& profile = {});
  /// Changes that of a load that was added.
  void set(std::size_t load, double pressure) { loads_[load].pressure = pressure; }

  const char* name() const override { return "pressure"; }
  /// O(faces).
  void add_forces(double time, const LiveMask& live, double* rows) override;
  void add_forces_in_step(const StepTimes& step, const LiveMask& live, double* rows) override;
  void add_forces_at(const VertexSelection& selection, std::span<const Index> vertices, double time,
                     std::vector<Vec3>& forces) override;
  bool adds_no_rows() const override { return loads_.empty(); }
  bool marks_vertices() const override { return true; }
  void mark_vertices(std::vector<bool>& marks) const override;
  bool is_stiff() const override { return !loads_.empty(); }
  void add_tangent(const double* d, double dx, double dv, const TangentTime& at,
                   double* out) override;
  void add_skew_tangent(const double* d, double dx, const TangentTime& at, double* out) override;
  bool add_tangent_in_single(const float* d, double dx, double dv, const TangentTime& at,
                             float* out) override;
  void for_each_tangent(double dx, double dv, const TangentTime& at,
                        const VisitTangents& visit) override;
  bool is_conservative(double time) override;
  bool has_transpose(double) override { return true; }
  double work() const override { return work_; }
  void forget_last() override;
  void restart() override;
  void follow(const CellComplex& complex, const TopologyChange& change) override;
  void state(Archive& archive) override;
  double last_change() const override;

 private:
  using Nodes = std::array<Index, Face::node_count>;
  using Positions = typename Face::Positions;
  struct Booked {
    Positions position, force;
  };
  struct Load {
    double pressure;
    std::vector<Face> faces;
    std::vector<Nodes> nodes;  ///< their current vertices
    TimeRamp ramp;
    std::vector<Booked> booked;                 ///< by face, at the last step
    std::vector<typename Face::Given> given{};  ///< kept where it may be divided
    LoadProfile profile{};
  };
  /// visit(load, face number, forces on its nodes) for each face of all loads that is `wanted`, by
  /// its nodes.
  template <class Wanted, class Visit>
  void for_each_face(double time, Wanted wanted, Visit visit);
  /// The same for all, whose forces are added to rows.
  template <class Visit>
  void add(double time, const LiveMask& live, double* rows, Visit visit);
  /// visit(nodes, pressure, w_ab) for each face of all loads.
  template <class Visit>
  void for_each_arms(double time, Visit visit) const;
  /// out += factor times the symmetric (sign = -1) or the other part (1) of the tangent times d.
  template <class Real>
  void multiply(const Real* d, double factor, double sign, double time, Real* out) const;
  Positions positions_of(const Nodes& nodes) const;
  bool may_be_divided() const { return Face::may_be_divided && attributes_.parts().may_grow(); }
  void load_copies(Load& load, const CellComplex& complex, std::span<const Split> copies) const;

  Attributes& attributes_;
  std::vector<Load> loads_;
  double work_ = 0;
  bool is_booked_ = false;
};

using Pressures = PressuresOn<PressedFace>;
using SurfacePressures = PressuresOn<PressedPart>;

}  // namespace suture
