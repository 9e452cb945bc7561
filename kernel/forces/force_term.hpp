// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/attributes/live_mask.hpp"
#include "kernel/base/archive.hpp"
#include "kernel/forces/follower.hpp"
#include "kernel/forces/vertex_selection.hpp"

namespace suture {

/// A step of a run, s.
struct StepTimes {
  double time = 0;  ///< at its start
  double dt = 0;    ///< 0: outside a step
  double last = 0;  ///< dt of the previous step, 0 before the first
};

/// A contribution to the forces on a body: internal forces of models, gravity, loads. To add one,
/// write such a class in its own file and one line that adds it to the body (Body::add). What it
/// can do besides, it says by deriving from the classes of term_capabilities.hpp as well: a term
/// whose forces depend on positions or velocities is a TangentTerm, too.
///
/// A term has access to the attributes that it reads: its forces refer to the current columns
/// `position` and `velocity`. Rows have 4 doubles per vertex; the fourth is 0.
class ForceTerm : public Follower {
 public:
  /// Its name for users: the column of energies.csv with its work.
  virtual const char* name() const = 0;

  /// rows += its forces at `time`, N, on the `live` vertices.
  virtual void add_forces(double time, const LiveMask& live, double* rows) = 0;
  /// The same in a step of the run, or again in the same state: also books its work.
  virtual void add_forces_in_step(const StepTimes& step, const LiveMask& live, double* rows) {
    add_forces(step.time, live, rows);
  }
  /// The same at the vertices of a selection, in its order. O(cells there).
  virtual void add_forces_at(const VertexSelection& selection, std::span<const Index> vertices,
                             double time, std::vector<Vec3>& forces) = 0;
  /// True if it never adds to rows, like gravity or empty loads.
  virtual bool adds_no_rows() const { return false; }
  /// True if it adds no rows, or if these depend on the time, its own state and the positions of
  /// marked vertices alone, and are theirs: then each of several processes needs no others.
  virtual bool marks_vertices() const { return adds_no_rows(); }
  /// marks[v] = true at these, as they are in the complex now. O(vertices marked).
  virtual void mark_vertices(std::vector<bool>& /*marks*/) const {}
  /// A uniform acceleration, m/s^2, which the passes over the vertices add.
  virtual Vec3 acceleration(double /*time*/) const { return {}; }

  /// Called when a step was accepted: trial states become final.
  virtual void accept() {}
  void follow(const CellComplex&, const TopologyChange&) override {}
  /// The models have other parameters: what was found from them must be found again.
  virtual void forget_models() {}
  /// All of its state that a run changes.
  virtual void state(Archive&) {}
  /// When its last ramp ends, s.
  virtual double last_change() const { return 0; }
};

}  // namespace suture
