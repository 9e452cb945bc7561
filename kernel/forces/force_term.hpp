// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "kernel/attributes/live_mask.hpp"
#include "kernel/base/archive.hpp"
#include "kernel/base/error.hpp"
#include "kernel/forces/follower.hpp"
#include "kernel/forces/vertex_selection.hpp"

namespace suture {

/// A model offers no bound of the stable step.
class NoStepBound : public PluginError {
 public:
  using PluginError::PluginError;
};

/// A step of a run, s.
struct StepTimes {
  double time = 0;  ///< at its start
  double dt = 0;    ///< 0: outside a step
  double last = 0;  ///< dt of the previous step, 0 before the first
};

/// Where in time a tangent is taken. States of models may make a force depend on dt.
struct TangentTime {
  double time = 0;  ///< s
  double dt = 0;    ///< of the step in progress, s; 0: outside a step
  TangentTime(double when, double step = 0) : time(when), dt(step) {}
};

/// The tangents of up to 8 cells of one functor: the derivatives of the forces on their nodes, N/m.
struct CellTangents {
  Index cells;            ///< 1 .. 8
  Index nodes;            ///< of each cell: 1, 2, 4 or 8
  const Index* vertices;  ///< vertices[cell * nodes + node]
  const double* values;   ///< values[(column * 3 nodes + row) * 8 + cell]; 3 rows per node
  Index functor = 0;      ///< the number of their functor
};

/// A contribution to the forces on a body: internal forces of models, gravity, loads. To add one,
/// write such a class in its own file and one line that adds it to the body (Body::add).
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
  /// A uniform acceleration, m/s^2, which the passes over the vertices add.
  virtual Vec3 acceleration(double /*time*/) const { return {}; }

  /// True if its forces depend on positions or velocities.
  virtual bool is_stiff() const { return false; }
  /// True if add_tangent() is implemented.
  virtual bool has_tangent() const { return true; }
  /// True if the whole tangent on the free components is symmetric. False for pressures up to a
  /// free edge, and for models whose forces have no energy: the matrices of a sample of 64 cells
  /// per functor are computed at the current state.
  virtual bool is_conservative(double /*time*/) { return true; }
  /// out += the derivative of its forces in the direction (dx d, dv d), but for what
  /// add_skew_tangent() adds; 3 numbers per vertex.
  virtual void add_tangent(const double* /*d*/, double /*dx*/, double /*dv*/,
                           const TangentTime& /*at*/, double* /*out*/) {}
  /// The same for the search of the stable step: may be that of stiffer forces, where that is
  /// cheaper.
  virtual void add_tangent_for_step(const double* d, double dx, double dv, const TangentTime& at,
                                    double* out) {
    add_tangent(d, dx, dv, at, out);
  }
  /// out += what add_tangent() leaves out of the derivative in the direction dx d: the part that is
  /// not symmetric.
  virtual void add_skew_tangent(const double* /*d*/, double /*dx*/, const TangentTime& /*at*/,
                                double* /*out*/) {}
  /// The same as add_tangent() in single precision, for preconditioners: rows of 4 numbers per
  /// vertex, the fourth 0, 16-byte aligned. False if it does not offer that.
  virtual bool add_tangent_in_single(const float* /*d*/, double /*dx*/, double /*dv*/,
                                     const TangentTime& /*at*/, float* /*out*/) {
    return false;
  }
  using VisitTangents = std::function<void(const CellTangents&)>;
  /// Visits dx df/dx + dv df/dv of all its cells, in a fixed order, on this thread. A term that
  /// does not implement it is missing from preconditioners, which only makes solvers slower.
  virtual void for_each_tangent(double /*dx*/, double /*dv*/, const TangentTime& /*at*/,
                                const VisitTangents& /*visit*/) {}
  /// Whether the tangent of one cell is wanted; it has no values that could be read.
  using SelectCell = std::function<bool(const CellTangents&)>;
  /// The same for a selection: `select` is asked about every cell, in the order of the visits.
  /// Where the term implements it, only selected cells cost products.
  virtual void for_some_tangents(double dx, double dv, const TangentTime& at,
                                 const SelectCell& select, const VisitTangents& visit) {
    for_each_tangent(dx, dv, at, [&](const CellTangents& cells) {
      for (std::size_t l = 0; l < cells.cells; ++l) {
        const CellTangents cell{1, cells.nodes, cells.vertices + l * cells.nodes, cells.values + l,
                                cells.functor};
        if (select(cell)) visit(cell);
      }
    });
  }
  /// sums(vertex, K, C): bounds on its stiffness (N/m) and damping (N s/m) at the vertices, XX YY
  /// ZZ XY YZ XZ each (stable_step.hpp).
  using AddBounds = std::function<void(Index, const double* stiffness, const double* damping)>;
  virtual void add_bounds(double /*time*/, const AddBounds& /*sums*/) {}
  /// At least the bounds of a selection. O(cells there) where that is worthwhile.
  virtual void add_bounds_at(const VertexSelection&, std::span<const Index> /*vertices*/,
                             double time, const AddBounds& sums) {
    add_bounds(time, sums);
  }

  /// Its stored energy, J: part of the elastic energy.
  virtual double energy(double /*time*/) { return 0; }
  /// The potential of forces that do not follow the body: 0 at rest, J.
  virtual double potential(double /*time*/) { return 0; }
  /// Its work since the start of the run, J, excluding stored energy; by the trapezoidal rule, with
  /// the forces at both ends of a step.
  virtual double work() const { return 0; }
  /// Updates work() to the current state.
  virtual void book(double /*time*/) {}
  /// Positions or cells jump: no work is booked between the last step and the next.
  virtual void forget_last() {}
  /// Resets the work to zero.
  virtual void restart() {}

  /// True for forces by which a constraint holds, with multipliers that converge to them. On the
  /// way to an equilibrium they are not a sum of those at several times.
  virtual bool is_constraint() const { return false; }
  /// An implicit step begins, or begins again after an attempt failed: multipliers are those that
  /// were accepted last.
  virtual void begin_step(double /*time*/) {}
  /// Called when the equations of such a step are solved: improves the multipliers. True if the
  /// constraint does not hold to its tolerance yet, so that they have to be solved again.
  virtual bool update(double /*time*/) { return false; }
  /// Called when a step was accepted: trial states become final.
  virtual void accept() {}
  void follow(const CellComplex&, const TopologyChange&) override {}
  /// All of its state that a run changes.
  virtual void state(Archive&) {}
  /// When its last ramp ends, s.
  virtual double last_change() const { return 0; }
};

}  // namespace suture
