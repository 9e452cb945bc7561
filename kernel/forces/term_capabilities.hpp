// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>

#include "kernel/base/error.hpp"
#include "kernel/forces/force_term.hpp"

// What a term can do besides adding forces
// ========================================
//
//   TangentTerm      derivatives                  Newton's method, the stable step, modes
//   CellTangentTerm  the same cell by cell        preconditioners
//   BoundedTerm      bounds on the stiffness      the stable step without a search
//   EnergyTerm       stored energy, potential     the balance of energy
//   WorkTerm         work since the start         the balance of energy
//   SharedTerm       sums over vertices           several processes
//   ConstraintTerm   multipliers                  Newton's method
//   NonsmoothTerm    kinks (nonsmooth_term.hpp)   Newton's method
//
// A term derives from ForceTerm and from those that it has.

namespace suture {

class BodyShare;

/// visit(capability) for those of a list of terms that have it, in their order.
template <class Capability, class Terms, class Visit>
void for_each_with(const Terms& terms, Visit visit) {
  for (const auto& term : terms)
    if (auto* capability = dynamic_cast<Capability*>(term.get())) visit(*capability);
}

/// Where in time a tangent is taken. States of models may make a force depend on dt.
struct TangentTime {
  double time = 0;  ///< s
  double dt = 0;    ///< of the step in progress, s; 0: outside a step
  TangentTime(double when, double step = 0) : time(when), dt(step) {}
};

/// CellTangents::functor of cells whose nodes share no element: of pieces that touch each other, or
/// that a model holds together.
constexpr Index link_functor = none;

/// The tangents of up to 8 cells of one functor: the derivatives of the forces on their nodes, N/m.
struct CellTangents {
  Index cells;            ///< 1 .. 8
  Index nodes;            ///< of each cell: 1, 2, 4 or 8
  const Index* vertices;  ///< vertices[cell * nodes + node]
  const double* values;   ///< values[(column * 3 nodes + row) * 8 + cell]; 3 rows per node
  Index functor = 0;      ///< the number of their functor
};

/// Forces that depend on positions or velocities, and are differentiated.
class TangentTerm {
 public:
  /// False if its forces depend on neither at present, as those of no pressure.
  virtual bool is_stiff() const { return true; }
  /// False if add_tangent() cannot be called, as a model has no derivatives.
  virtual bool has_tangent() const { return true; }
  /// True if it joins the body to the ground, so that it resists translations.
  virtual bool is_anchored() const { return false; }
  /// True if the whole tangent on the free components is symmetric. False for pressures up to a
  /// free edge, and for models whose forces have no energy: the matrices of a sample of 24 cells
  /// per functor are computed at the current state.
  virtual bool is_conservative(double /*time*/) { return true; }
  /// True if the transpose of the whole tangent is add_tangent() minus add_skew_tangent().
  virtual bool has_transpose(double time) { return is_conservative(time); }
  /// out += the derivative of its forces in the direction (dx d, dv d), but for what
  /// add_skew_tangent() adds; 3 numbers per vertex.
  virtual void add_tangent(const double* d, double dx, double dv, const TangentTime& at,
                           double* out) = 0;
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

 protected:
  ~TangentTerm() = default;
};

/// What visits the matrices of cells in pieces, several of which may be visited at once.
class TangentPieces {
 public:
  /// `slots`: pieces at once.
  explicit TangentPieces(std::size_t slots) : slots_(slots) {}
  std::size_t slots() const { return slots_; }

  /// Some cells of the piece in a slot. On any thread, but on one thread at a time for each slot.
  virtual void visit(std::size_t slot, const CellTangents& cells) = 0;
  /// The piece in a slot is complete. On the calling thread, in the order of the pieces.
  virtual void end_piece(std::size_t slot) = 0;

 protected:
  ~TangentPieces() = default;

 private:
  std::size_t slots_;
};

/// A tangent that is a sum over cells. A term without it is missing from preconditioners, which
/// only makes solvers slower.
class CellTangentTerm {
 public:
  using VisitTangents = std::function<void(const CellTangents&)>;
  /// Visits dx df/dx + dv df/dv of all its cells, in a fixed order, on this thread.
  virtual void for_each_tangent(double dx, double dv, const TangentTime& at,
                                const VisitTangents& visit) = 0;
  /// The same in pieces, which do not depend on the number of slots or threads.
  virtual void for_each_piece(double dx, double dv, const TangentTime& at, TangentPieces& pieces) {
    for_each_tangent(dx, dv, at, [&](const CellTangents& cells) {
      pieces.visit(0, cells);
      pieces.end_piece(0);
    });
  }
  /// Whether the tangent of one cell is wanted; it has no values that could be read.
  using SelectCell = std::function<bool(const CellTangents&)>;
  /// The same for a selection: `select` is asked about every cell, in the order of the visits.
  /// Where the term implements it, only selected cells cost products.
  virtual void for_some_tangents(double dx, double dv, const TangentTime& at,
                                 const SelectCell& select, const VisitTangents& visit) {
    std::vector<double> values;  // of one cell, with room for eight, which are read
    for_each_tangent(dx, dv, at, [&](const CellTangents& cells) {
      values.resize(std::size_t{72} * cells.nodes * cells.nodes);
      for (std::size_t l = 0; l < cells.cells; ++l) {
        CellTangents cell{1, cells.nodes, cells.vertices + l * cells.nodes, nullptr, cells.functor};
        if (!select(cell)) continue;
        for (std::size_t i = 0; i < values.size(); i += 8) values[i] = cells.values[i + l];
        cell.values = values.data();
        visit(cell);
      }
    });
  }

 protected:
  ~CellTangentTerm() = default;
};

/// A model offers no bound of the stable step.
class NoStepBound : public PluginError {
 public:
  using PluginError::PluginError;
};

/// Bounds on stiffness and damping.
class BoundedTerm {
 public:
  /// sums(vertex, K, C): bounds on its stiffness (N/m) and damping (N s/m) at the vertices, XX YY
  /// ZZ XY YZ XZ each (stable_step.hpp).
  using AddBounds = std::function<void(Index, const double* stiffness, const double* damping)>;
  virtual void add_bounds(double time, const AddBounds& sums) = 0;
  /// At least the bounds of a selection. O(cells there) where that is worthwhile.
  virtual void add_bounds_at(const VertexSelection&, std::span<const Index> /*vertices*/,
                             double time, const AddBounds& sums) {
    add_bounds(time, sums);
  }

 protected:
  ~BoundedTerm() = default;
};

/// Energies that the state determines.
class EnergyTerm {
 public:
  /// Its stored energy, J: part of the elastic energy.
  virtual double energy(double /*time*/) { return 0; }
  /// The potential of forces that do not follow the body: 0 at rest, J.
  virtual double potential(double /*time*/) { return 0; }

 protected:
  ~EnergyTerm() = default;
};

/// Work that is summed from step to step.
class WorkTerm {
 public:
  /// Its work since the start of the run, J, excluding stored energy; by the trapezoidal rule, with
  /// the forces at both ends of a step.
  virtual double work() const = 0;
  /// Updates work() to the current state.
  virtual void book(double /*time*/) {}
  /// Positions or cells jump: no work is booked between the last step and the next.
  virtual void forget_last() = 0;
  /// The part of some vertices in the state from which book() continues. O(vertices).
  virtual double booked_at(std::span<const Index> /*vertices*/) const { return 0; }
  /// Cells changed, and with them booked_at() their vertices, by this difference, which is no
  /// work. Called instead of forget_last() if no term adds rows, except the models.
  virtual void shift_booked(double /*difference*/) {}
  /// Resets the work to zero.
  virtual void restart() = 0;

 protected:
  ~WorkTerm() = default;
};

/// Sums over vertices that several processes can divide.
class SharedTerm {
 public:
  /// From now on, several processes compute its sums over vertices, and this one its share.
  virtual void divide_sums(BodyShare& share) = 0;

 protected:
  ~SharedTerm() = default;
};

/// Forces by which a constraint holds, with multipliers that converge to them. On the way to an
/// equilibrium they are not a sum of those at several times.
class ConstraintTerm {
 public:
  /// An implicit step begins, or begins again after an attempt failed: multipliers are those that
  /// were accepted last.
  virtual void begin_step(double time) = 0;
  /// The step is not made: everything is as it was before.
  virtual void reject_step() = 0;
  /// Called when the equations of such a step are solved: improves the multipliers. True if the
  /// constraint does not hold to its tolerance yet, so that they have to be solved again.
  virtual bool update(double time) = 0;
  /// For derivatives of an equilibrium: until the next step, only what carries a force has a
  /// tangent. False if that tangent is not the whole one.
  virtual bool hold(double time) = 0;
  /// out += the part of add_tangent() by which gaps resist, where they are held; 3 numbers per
  /// vertex. Motions that keep the constraint have none.
  virtual void add_gap_tangent(const double* d, double time, double* out) = 0;

 protected:
  ~ConstraintTerm() = default;
};

}  // namespace suture
