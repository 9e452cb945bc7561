// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "kernel/attributes/attributes.hpp"

namespace suture {

/// Everything that adds internal forces: the enabled functors of all instances,
/// compiled into batches of 8 cells. Same bits for any number of threads.
class ForceLoop {
 public:
  ForceLoop(Attributes& attributes, const CellComplex& complex, unsigned threads);
  ~ForceLoop();

  /// force += sum of all functors, at (position, velocity, time).
  /// Throws NumericalError with the lowest failing cell's message.
  void add_forces(double time, double dt);
  /// Stored energy of all functors, J. Fixed order of summation.
  double energy(double time);
  /// Per vertex the largest eigenvalue of the summed bounds over m:
  /// K/m (1/s^2) and C/m (1/s); the maxima over all free vertices.
  struct Bounds { double stiffness = 0, damping = 0; Index vertex = none; };
  Bounds bounds(double time);
  /// Re-reads connectivity, rows and chunks after a change.
  void update(const CellComplex& complex, const TopologyChange& change);

  struct Summary {  ///< for `suture explain`
    std::string instance, functor;
    Index cells, batches, chunks, colours;
    std::uint32_t reads;
    bool skipped;
    std::string reason;
  };
  std::vector<Summary> summary() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace suture
