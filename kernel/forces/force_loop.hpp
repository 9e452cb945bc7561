// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <exception>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/parallel.hpp"
#include "kernel/forces/functor_times.hpp"
#include "kernel/forces/term_capabilities.hpp"

namespace suture {

class BodyShare;

/// A model asks for a smaller step: the state before the step is still valid.
class StepRejected : public NumericalError {
 public:
  StepRejected(const std::string& text, double factor, std::uint64_t where = nowhere)
      : NumericalError(text, where), step_factor(factor) {}
  double step_factor;  ///< proposed dt / current dt, in (0, 1)
};

/// Who runs the body gives up the step that is being made: the state before it is still valid. Not
/// an error, so nobody looks for another way to the end of the step.
class StepAbandoned : public std::exception {
 public:
  const char* what() const noexcept override { return "the step was given up"; }
};

/// The internal forces: the enabled functors of all instances, compiled into batches of 8 cells.
/// The results are bitwise identical for any number of threads. Instead of the forces, the rates of
/// a field: then "force", "position" in a tangent and "N" below stand for the rate, the field and
/// the unit of its capacity times its own per second, in component 0.
///
/// The cells of a functor are coloured in chunks (batch_list.hpp); the loop itself is
/// compiled for each instruction set (loops/). Memory: 4 B per row of a vertex functor, 8 B
/// of an edge functor, 16 B of a face functor, nothing per element.
class ForceLoop final : public ForceTerm,
                        public TangentTerm,
                        public CellTangentTerm,
                        public BoundedTerm,
                        public EnergyTerm,
                        public WorkTerm {
 public:
  /// `threads`: 0 = as many as are useful; only loops that are large enough use more than one.
  /// `field`: whose rates; null: forces. Throws PluginError if a functor requires what this program
  /// does not support.
  ForceLoop(Attributes& attributes, const CellComplex& complex, unsigned threads,
            const VertexField* field = nullptr);
  ~ForceLoop() override;

  const char* name() const override { return "models"; }

  /// Which functors: those with an energy (suture.energy/1), whose work is the negative change
  /// of that energy, those without, or all.
  enum class Part { all, with_energy, without_energy };
  bool has(Part part) const;  ///< whether an enabled functor belongs to it
  /// Whether an enabled functor with an energy also reads velocities or keeps a state: it then
  /// dissipates, too.
  bool dissipates() const;
  /// rows += sum of the functors (by default in the column `force`), at (position, velocity, time).
  /// Throws NumericalError with the lowest failing cell's message, StepRejected
  /// if a smaller step may help. `dt`: of the step in progress, 0 outside one.
  void add_forces(double time, double dt, Part part = Part::all, double* rows = nullptr);
  /// Cells that sleep are left out regardless of `live`.
  void add_forces(double time, const LiveMask& live, double* rows) override;
  void add_forces_in_step(const StepTimes& step, const LiveMask& live, double* rows) override;
  /// Sums in another order, hence with other rounding. O(cells around them).
  void add_forces_at(const VertexSelection& selection, std::span<const Index> vertices, double time,
                     std::vector<Vec3>& forces) override;

  /// Makes room in the lists of rows for what a cut of `faces` faces adds. O(faces).
  void make_room(Index faces);

  /// The work of functors without an energy, if others have one.
  double work() const override;
  bool books_work() const { return has(Part::without_energy) && has(Part::with_energy); }
  void forget_last() override;
  void restart() override;
  /// Makes the trial copies of state columns the accepted ones.
  void accept() override;

  /// Stored energy of all functors that have one, J. Summed in a fixed order.
  double energy(double time) override;
  /// What functors dissipate (suture.dissipation/1), W; and whether an enabled one says so.
  double dissipation(double time);
  bool has_dissipation() const;
  /// A pass of position based dynamics over all cells (force_loop_project.cpp).
  struct Projection {
    double time = 0, dt = 0;       ///< at the end of the step, and its length, s
    const double* inverse_mass{};  ///< rows of 4, 1/kg; 0 at components that are held
    double* velocity{};            ///< rows of 4, which change as the positions do; null: none
    bool moves = true;             ///< false: only finds the softness
    bool compensates = false;      ///< makes up for the softness where it can
  };
  /// Sums over the cells, J: their energy U, and what the pass leaves out of it.
  struct Softness {
    double energy = 0, missing = 0;
  };
  /// Moves the vertices of one cell after the other, in the order of the chunks. About two
  /// evaluations of the forces. Throws as add_forces() does.
  Softness project(const Projection& step);
  /// The first functor that cannot be projected and why, or "": it needs an energy.
  std::string without_projection() const;
  /// The part of energy() in these elements, their edges and their faces: an operation
  /// that touches no others changes energy() by the difference. Removed elements add
  /// nothing. Summed in another order, hence with other rounding. O(elements).
  double energy_around(std::span<const Index> elements, double time);
  /// out[row] += direction . f + energy W for each cell of the instance with this dimension: its
  /// forces f and its stored energy W, which counts as 0 where the model is active.
  /// `direction`: 3 numbers per vertex. An evaluation of the forces, which sets trial states.
  void add_cell_work(const Instance& instance, int dimension, const double* direction,
                     double energy, const TangentTime& at, std::span<double> out);
  /// Elements with one of these vertices, ascending: those that an operation on the vertices
  /// can touch. O(elements around them).
  std::vector<Index> elements_around(std::span<const Index> vertices);

  /// Throws NoStepBound if an enabled functor has no suture.stable-dt/1.
  void add_bounds(double time, const AddBounds& sums) override;
  void add_bounds_at(const VertexSelection& selection, std::span<const Index> vertices, double time,
                     const AddBounds& sums) override;

  /// Needs has_tangent(). About three evaluations of forces. The forces are differentiated in
  /// double; floats, in rows of 4 as in add_tangent_in_single(), halve the memory of a search that
  /// needs few digits (step_search.hpp).
  void add_tangent(const double* d, double dx, double dv, const TangentTime& at,
                   double* out) override;
  void add_tangent(const float* d, double dx, double dv, const TangentTime& at, float* out);
  bool add_tangent_in_single(const float* d, double dx, double dv, const TangentTime& at,
                             float* out) override {
    add_tangent(d, dx, dv, at, out);
    return true;
  }
  /// 3 products with the tangent per node of a cell: 24 for hexahedra.
  void for_each_tangent(double dx, double dv, const TangentTime& at,
                        const VisitTangents& visit) override;
  void for_each_piece(double dx, double dv, const TangentTime& at, TangentPieces& pieces) override;
  void for_some_tangents(double dx, double dv, const TangentTime& at, const SelectCell& select,
                         const VisitTangents& visit) override;
  /// From the tangents of some cells of every functor; true if a functor has none.
  bool is_conservative(double time) override;
  bool has_tangent() const override;    ///< every enabled functor has suture.tangent/1
  std::string without_tangent() const;  ///< the first functor without a tangent, or ""
  bool reads_velocity() const;          ///< whether an enabled functor does
  bool keeps_states() const;            ///< whether forces depend on accepted states (SUTURE_TRIAL)
  bool reads_fields() const;            ///< whether forces depend on fields (SUTURE_FIELD)
  bool reads_motion() const;            ///< whether an enabled functor reads where vertices are
  /// Whether forces depend on nothing else that steps change: no velocities, states and fields.
  bool depends_on_positions_alone() const;
  /// Whether an enabled functor is on edges or faces, or reads columns of vertices: then an
  /// operation changes its bounds also at vertices that keep their elements.
  bool reads_summed_columns() const;

  /// An output field (suture.output/1) of an instance's functors on cells of a
  /// dimension: values[row*components + c] of its table; rows that no functor
  /// computes are left alone. False if no enabled functor provides the field.
  /// `wanted`: these cells alone, and those in one batch with them; null: all.
  bool compute_field(const Instance& instance, int dimension, std::string_view field, double time,
                     std::span<double> values, const std::vector<Index>* wanted = nullptr);
  /// Marks the vertices that it reads for `wanted` cells of a dimension.
  void mark_for_fields(int dimension, const std::vector<Index>& wanted,
                       std::vector<bool>& vertices);

  /// Updates connectivity, rows and chunks after a change. O(cells touched), except
  /// when an eighth of the rows is new (edges) or for functors on faces.
  void follow(const CellComplex& complex, const TopologyChange& change) override;

  /// Leaves out, for every functor, blocks of 8 cells whose vertices are all `fixed` (one
  /// flag per vertex: permanently held at its rest position): their forces move nothing. The
  /// other cells keep their order, so the forces on free vertices are bitwise the same.
  /// From now on, forces and fields in the blocks left out are not computed. Returns the
  /// number of cells left out. O(cells).
  Index skip_fixed(std::vector<bool> fixed);

  /// Cells of these elements are no longer visited by add_forces(); state columns keep
  /// their values. Energies, fields and bounds still include them. Only for whole
  /// islands: a cell that an element which is awake shares is left out, too. O(elements),
  /// the first time O(rows / 8).
  void sleep(std::span<const Index> elements);
  void wake_all();  ///< so does follow()

  /// To be loaded after the attributes, into a loop that was built in the same way.
  void state(Archive& archive) override;

  /// From now on this process computes its share of the forces and of the energies; others compute
  /// the rest. Functors that keep states are computed by all. The share outlives the loop.
  /// `mark_others`: marks the vertices that other terms and contact read.
  void share(BodyShare& share, std::function<void(std::vector<bool>&)> mark_others);
  /// Call when these have changed other than by an operation. O(cells).
  void find_share();
  /// False from an operation until the next forces.
  bool knows_share() const;
  /// Whether forces at own vertices of the share are enough for a step: there is one, and no
  /// functor keeps states, reads fields, or has its work booked.
  bool may_divide() const;
  /// add_forces_in_step() if may_divide(), for the rows of own and common vertices. Others at the
  /// borders get parts of their forces.
  void add_own_forces(const StepTimes& step, double* rows);
  /// The same for add_tangent(); `d` has own and common rows and borders.
  void add_own_tangent(const float* d, double dx, double dv, const TangentTime& at, float* out);
  void add_own_tangent(const double* d, double dx, double dv, const TangentTime& at, double* out);

  /// From now on every call of a force is checked for mistakes of its plugin (checked_force.hpp),
  /// and energies, bounds, tangents and fields must be finite. Small bodies run hundreds of times
  /// more slowly.
  void check_plugins();

  /// From now on the loops over functors are timed: two readings of the clock each.
  void measure();
  /// What they took, in the order of their first calls; empty without measure().
  std::vector<FunctorCost> costs() const;

  struct Summary {  ///< for `suture explain`
    std::string instance, functor;
    Index cells = 0, batches = 0, chunks = 0, colours = 0;
    Index left_out = 0;       ///< by skip_fixed(), not among the cells
    std::uint32_t reads = 0;  ///< suture_read bits that are gathered
    bool skipped = false;
    std::string reason;
  };
  std::vector<Summary> summary() const;

  const Workers& workers() const;  ///< the run's threads
  unsigned threads() const;      ///< used for the forces; 1 below the size at which more are useful
  std::string_view isa() const;  ///< "avx512", "avx2" or "base"

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace suture
