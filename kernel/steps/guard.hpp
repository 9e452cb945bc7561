// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "kernel/base/diagnostics.hpp"
#include "kernel/build/built_scene.hpp"

// Growth of energy in stable steps
// ================================
//
// A step may be stable and still too coarse for the motion. A spinning body gains 14 % energy in
// 100 s at safety 0.8, with h w at 0.7, and 2 % at 0.5. If 2 % of the exchanged energy is
// unexplained although the step is stable, safety becomes 0.5, with a message. If the energy grew
// by 1 % between two checks, the steps are repeated with half the step, twice at each place. A
// breaking wave adds up to 60 % within 64 steps.
//
// Growth is judged without h^2/8 sum F^2/m (`recoverable`). Sudden loads on coarse meshes change
// this part by 20 % and back; with it, 105 of 1,500 valid runs were reported.

namespace suture {

/// The parameter by which the model of an element makes it resist folding more: "element":
/// "trilinear" where it is "mean-gradient"; otherwise "".
std::string stiffer_element(const BuiltScene& built, Index element);

/// Checks that a run is still valid: finite energies, a balance that closes, no more than a few
/// inverted elements (judge_inversion) unless the model allows it. (The step itself finds
/// velocities that are not finite, and the frequency of the motion reveals an unstable step.)
class Guard {
 public:
  Guard(BuiltScene& built, Diagnostics& diagnostics);

  /// Starts the ledger.
  void start() { last_ = built_.dynamics().check_balance(); }

  /// Checks the current state; throws NumericalError with what is wrong, without the advice, which
  /// depends on the step. Costs an evaluation of energies (0.7 of the forces), a pass over the
  /// vertices and one over the elements.
  void check(std::uint64_t step, double time);

  /// The fraction of the exchanged energy that is unexplained since start() or forgive_growth(); 0
  /// if rounding explains it.
  double growth() const;
  void forgive_growth() { forgiven_ = unexplained(); }

  /// The balance as a fraction of the energy exchanged, without the part that is recoverable; 0 if
  /// rounding explains it. Messages and summaries state this number.
  double open_balance() const;
  /// EnergyBalance::exchanged of the last check, J; 0 if it is as small as noise.
  double exchanged() const { return last_.exchanged > noise_ ? last_.exchanged : 0; }
  /// Call after the motion or the forces were changed from outside.
  void after_jump() { stored_rounding_ = 0; }
  /// The largest number at once.
  std::uint64_t inverted_elements() const { return worst_inverted_; }
  /// The element that the last inversion that ends a run was reported at, or `none`.
  Index fatal_element() const { return fatal_; }
  void state(Archive& archive);

 private:
  void check_inversion(std::uint64_t step, double time);
  double unexplained() const;
  double share(double energy) const;

  BuiltScene& built_;
  Diagnostics& diagnostics_;
  std::vector<bool> stops_;              ///< whether inversion stops the run, by instance
  std::vector<Index> inverted_at_rest_;  ///< allowed by the scene, ascending
  Index worst_inverted_ = 0;             ///< in addition to those
  Index fatal_ = none;                   ///< see fatal_element()
  double noise_ = 0;            ///< an estimate of the energy that rounding has added so far, J
  double stored_rounding_ = 0;  ///< of one evaluation of the stored energy, J; 0: not known yet
  EnergyBalance last_;
  double forgiven_ = 0;
};

}  // namespace suture
