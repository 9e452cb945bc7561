// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "kernel/attributes/live_mask.hpp"
#include "kernel/base/archive.hpp"
#include "kernel/forces/follower.hpp"
#include "kernel/forces/vertex_selection.hpp"

namespace suture {

/// A step of a run, s.
struct StepTimes {
  double time = 0;  ///< at its beginning
  double dt = 0;    ///< 0: outside a step
  double last = 0;  ///< dt of the step before, 0 before the first
};

/// Something that adds forces to a body: internal forces of models, gravity, loads. A new one is
/// a file with such a class, and a line where it is added to the body (Body::add).
///
/// A term knows the attributes that it reads: forces are those at the present columns `position`
/// and `velocity`. Rows are of 4 doubles per vertex, the fourth 0.
class ForceTerm : public Follower {
 public:
  /// What users call it: the column of energies.csv with its work.
  virtual const char* name() const = 0;

  /// rows += its forces at `time`, N, on vertices that are `live`.
  virtual void add_forces(double time, const LiveMask& live, double* rows) = 0;
  /// The same in a step of the run, or again at the same place: books its work besides.
  virtual void add_forces_in_step(const StepTimes& step, const LiveMask& live, double* rows) {
    add_forces(step.time, live, rows);
  }
  /// The same at the vertices of a selection, in its order. O(what is there).
  virtual void add_forces_at(const VertexSelection& selection, std::span<const Index> vertices,
                             double time, std::vector<Vec3>& forces) = 0;
  /// It never adds to rows: a body without loads, gravity.
  virtual bool adds_no_rows() const { return false; }
  /// What it gives every kilogram, m/s^2: passes over the vertices add it on their way.
  virtual Vec3 acceleration(double /*time*/) const { return {}; }

  /// Its forces have a derivative in positions and velocities that is not zero.
  virtual bool is_stiff() const { return false; }
  /// add_tangent() gives it. False for forces that follow a surface.
  virtual bool has_tangent() const { return true; }
  /// out += the derivative of its forces in the direction (dx d, dv d); 3 numbers per vertex.
  virtual void add_tangent(const double* /*d*/, double /*dx*/, double /*dv*/, double /*time*/,
                           double* /*out*/) {}
  /// sums(vertex, K, C): bounds of the stiffness (N/m) and damping (N s/m) that it gives
  /// vertices, XX YY ZZ XY YZ XZ each (stable_step.hpp).
  using AddBounds = std::function<void(Index, const double* stiffness, const double* damping)>;
  virtual void add_bounds(double /*time*/, const AddBounds& /*sums*/) {}
  /// Those of a selection at least. O(what is there) where it pays.
  virtual void add_bounds_at(const VertexSelection&, std::span<const Index> /*vertices*/,
                             double time, const AddBounds& sums) {
    add_bounds(time, sums);
  }

  /// What it stores, J: part of the elastic energy.
  virtual double energy(double /*time*/) { return 0; }
  /// Of forces that keep their place: 0 at rest, J.
  virtual double potential(double /*time*/) { return 0; }
  /// What it has done since the start of the run, J, but for what it stores; by the trapezoid,
  /// forces of both ends of a step times its way.
  virtual double work() const { return 0; }
  /// Brings work() up to the present state.
  virtual void book(double /*time*/) {}
  /// Positions or cells jump: nothing is booked between the last step and the next.
  virtual void forget_last() {}
  /// No work was done yet.
  virtual void restart() {}

  /// A step was accepted: trial states become those of the body.
  virtual void accept() {}
  void follow(const CellComplex&, const TopologyChange&) override {}
  /// Everything of it that a run changes.
  virtual void state(Archive&) {}
  /// When its last ramp ends, s.
  virtual double settled_after() const { return 0; }
};

}  // namespace suture
