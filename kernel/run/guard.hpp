// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "kernel/base/diagnostics.hpp"
#include "kernel/scene/built_scene.hpp"

namespace suture {

/// Looks whether the numbers of a run are still right: finite energies, a balance that closes,
/// no inverted element where the model does not admit one. (Velocities that are not finite are
/// found by the step itself, an unstable step by the frequency of the motion.)
class Guard {
 public:
  Guard(const Scene& scene, BuiltScene& built, Diagnostics& diagnostics);

  /// The beginning of the ledger.
  void start() { last_ = built_.dynamics().balance(); }

  /// Looks at the present state; throws NumericalError with what is wrong, but for the advice,
  /// which depends on the step. An evaluation of energies (0.7 of the forces), a pass over the
  /// vertices and one over the elements.
  void check(std::uint64_t step, double time);

  /// The part of the exchanged energy that came from nowhere since start() or
  /// forgive_growth(); 0 where rounding explains it.
  double growth() const;
  void forgive_growth() { forgiven_ = unexplained(); }

  /// What rounding can have added to the energy so far, J.
  double noise() const { return noise_; }

  const EnergyBalance& last() const { return last_; }
  std::uint64_t inverted_elements() const { return worst_inverted_; }
  void state(Archive& archive);

 private:
  void check_inversion(std::uint64_t step, double time);
  double unexplained() const;

  BuiltScene& built_;
  Diagnostics& diagnostics_;
  std::vector<bool> stops_;              ///< on inversion, by instance
  std::vector<Index> inverted_at_rest_;  ///< admitted by the scene, ascending
  Index worst_inverted_ = 0;             ///< beyond those
  double noise_ = 0;
  EnergyBalance last_;
  double forgiven_ = 0;
};

}  // namespace suture
