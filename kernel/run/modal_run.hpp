// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "kernel/build/built_scene.hpp"
#include "kernel/output/output_folder.hpp"
#include "kernel/run/run_report.hpp"
#include "kernel/spectrum/natural_modes.hpp"

namespace suture {

class PluginHost;

struct ModalOptions {
  unsigned count = 10;
  /// The static equilibrium at the end of the scene, after its events; otherwise the rest shape.
  bool at_equilibrium = false;
};

/// The natural modes of the body of a scene.
class ModalRun {
 public:
  /// Builds the scene. Throws InputError for mistakes in it, models without a tangent, more modes
  /// than unknowns and, about an equilibrium, a body that nothing holds.
  ModalRun(const Scene& scene, PluginHost& host, Diagnostics& diagnostics,
           const ModalOptions& options);
  ~ModalRun();

  /// Finds the equilibrium, if that is wanted, and the modes. Throws NumericalError.
  NaturalModes solve(Observer& observer);

  /// Writes modes.csv, and a frame of each mode with its shape as the point field "mode":
  /// mode_0001.vtu and so on, listed in modes.pvd with their numbers as times. Returns the path of
  /// that list. Throws IoError.
  std::string write(const NaturalModes& modes, const std::shared_ptr<OutputFolder>& folder);

  Index elements() { return built().body().complex().existing(3); }

 private:
  void build();
  BuiltScene& built();

  const Scene& scene_;
  PluginHost& host_;
  Diagnostics& diagnostics_;
  ModalOptions options_;
  std::unique_ptr<BuiltScene> rest_;        ///< or
  std::unique_ptr<class RunLoop> statics_;  ///< the run that leads to the equilibrium
};

}  // namespace suture
