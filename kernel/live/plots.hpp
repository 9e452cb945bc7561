// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "kernel/results/probe_table.hpp"
#include "kernel/run/simulation.hpp"

namespace suture {

/// What pages plot against time: the energies, the forces on obstacles and the probes of the scene.
class Plots {
 public:
  explicit Plots(Simulation& simulation);

  /// [{"name", "unit", "curves": [...]}].
  nlohmann::json names() const;
  /// The values now, one per curve. Costs the stored energy, and with probes of forces those of the
  /// next step, which does not compute them again. Throws NumericalError for values that are not
  /// finite.
  std::vector<double> values();

 private:
  Simulation& simulation_;
  std::optional<ProbeTable> probes_;
};

}  // namespace suture
