// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "kernel/dynamics/body.hpp"
#include "kernel/plugin_host/plugin_host.hpp"

namespace suture::bench {

/// A body for linear solvers, with its cuts.
struct SolveCase {
  std::string name;
  Mesh mesh;
  std::string model = "tm-faure";
  double nu = 0.3;
  double held = 0;  ///< the part of its height along z that is held, from the lower end
  /// Whether to cut between two elements, by their centres in multiples of the mean edge.
  std::function<bool(const Vec3&, const Vec3&)> is_cut{};
};

/// The cases of the benchmark, with bodies of about 4 n^3 elements.
std::vector<SolveCase> solve_cases(Index n);
/// A file, held at its lowest tenth.
SolveCase case_of_file(const std::string& path);

/// The centre of an element at rest.
Vec3 centre_of(const Body& body, Index element);

/// Builds, cuts and holds the body of a case.
std::unique_ptr<Body> body_of(const SolveCase& what, PluginHost& host);

}  // namespace suture::bench
