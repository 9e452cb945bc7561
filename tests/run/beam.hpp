// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/plugin_host/plugin_host.hpp"
#include "kernel/run/simulation.hpp"
#include "kernel/scene/scene.hpp"

namespace suture::test {

/// The plugins of the tree, loaded once.
PluginHost& tree_plugins();

/// One value per declared parameter of the model, by name; defaults elsewhere.
std::vector<double> parameters(const suture_model& model,
                               const std::map<std::string, double>& values);

/// The paper's cantilever (tests/reference/beam.hpp), nx x n x n elements, with
/// no output; clamped at x = 0 under `gravity` along -y.
Scene beam(PluginHost& host, const std::string& model, Index nx, Index n, double gravity,
           const std::map<std::string, double>& values = {});

/// Centre of the end face as a selection of 4 nodes (odd n) or one (even n).
Selection beam_tip(Index n);

}  // namespace suture::test
