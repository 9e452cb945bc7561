// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/numpy.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/python/views.hpp"
#include "kernel/attributes/attributes.hpp"
#include "kernel/forces/term_capabilities.hpp"

namespace suture::python {

/// What a force function in Python is, and the values that its author gives.
struct PythonForce {
  std::string name;
  py::function force;                  ///< force(x, v, t, f) adds to f
  std::optional<py::function> energy;  ///< energy(x, t) in J
  std::optional<double> stiffness;     ///< bound per vertex, N/m; none: found from the forces
};

/// What a force function has cost and done; Python may keep it.
struct ForceReport {
  std::string name;
  std::uint64_t calls = 0;
  double seconds = 0;  ///< spent in the function
  double work = 0;     ///< since the start, J; 0 with an energy
};

/// A force that a Python function computes from positions, velocities and time.
///
///   f(x, v, t)      forces on all vertices, N
///   tangent         by central differences of f: two calls for each product
///   bounds          the author's stiffness, else the largest eigenvalue of the tangent
///   work            by the trapezoidal rule from the forces at both ends of a step; with an
///   energy,
///                   the function is taken to be conservative and its work is in the stored energy
///
/// The function gets arrays that Python owns or that Views keep alive: it may keep them.
class PythonTerm final : public ForceTerm,
                         public TangentTerm,
                         public BoundedTerm,
                         public EnergyTerm,
                         public WorkTerm {
 public:
  PythonTerm(PythonForce force, Attributes& attributes);
  /// The same force in another run of the scene, with the same report; it is zero until start().
  PythonTerm(const PythonTerm& other, Attributes& attributes);
  void start() { has_functions_ = true; }

  const char* name() const override { return report_->name.c_str(); }
  void add_forces(double time, const LiveMask& live, double* rows) override;
  void add_forces_in_step(const StepTimes& step, const LiveMask& live, double* rows) override;
  void add_forces_at(const VertexSelection& selection, std::span<const Index> vertices, double time,
                     std::vector<Vec3>& forces) override;
  bool is_stiff() const override { return force_.stiffness != 0; }
  bool is_conservative(double) override { return force_.energy.has_value(); }
  void add_tangent(const double* d, double dx, double dv, const TangentTime& at,
                   double* out) override;
  /// That of the author's stiffness, if there is one.
  void add_tangent_for_step(const double* d, double dx, double dv, const TangentTime& at,
                            double* out) override;
  void add_bounds(double time, const AddBounds& sums) override;
  void add_bounds_at(const VertexSelection&, std::span<const Index> vertices, double time,
                     const AddBounds& sums) override;
  double energy(double time) override;
  double work() const override { return report_->work; }
  void book(double time) override;
  void forget_last() override { last_x_.clear(); }
  void restart() override;
  void follow(const CellComplex&, const TopologyChange&) override { forget_last(); }
  void state(Archive& archive) override;

  std::shared_ptr<ForceReport> report() const { return report_; }
  int traverse(visitproc visit, void* argument) const;
  /// Drops the functions: no force from now on.
  void clear();

 private:
  using Array = py::array_t<double>;
  Array call(const Array& x, const Array& v, double time);
  Array copy_of(const Column& column) const;
  std::vector<double> evaluate(double time);
  double largest_stiffness(double time);
  void book_work(const std::vector<double>& forces);

  PythonForce force_;
  Attributes& attributes_;
  double size_ = 0;  ///< of the body at rest, m: the scale of differences
  bool has_functions_ = true;
  double bound_ = 0;  ///< the last one found, N/m
  std::shared_ptr<ForceReport> report_ = std::make_shared<ForceReport>();
  std::vector<double> last_x_, last_f_;  ///< when the work was last booked; empty: not yet
};

}  // namespace suture::python
