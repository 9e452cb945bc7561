// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/output/checkpoint_file.hpp"
#include "kernel/processes/communicator.hpp"
#include "kernel/scene/scene.hpp"

namespace suture {

/// Throws InputError, naming it, for what processes that make a run together cannot share.
void require_shareable(const Scene& scene);

/// Throws InputError, naming both, unless all processes run the same program and plugins with the
/// same instruction set on the same scene, mesh and files that the scene names: otherwise their
/// bits would differ.
void require_same_run(Communicator& processes, const Scene& scene, const CheckpointHeader& run);

}  // namespace suture
