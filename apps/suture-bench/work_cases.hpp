// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "kernel/base/types.hpp"

namespace suture::bench {

/// Cells of a box and their grading along the first axis (last cell / first).
struct WorkMesh {
  std::array<Index, 3> cells;
  double grading = 1;

  double dofs() const;
  std::string name() const;  ///< "40x10x10", "36x12x12 graded 8"
};

/// A model with its parameters, and how the scene is solved, as members of a scene.
struct WorkMethod {
  std::string name, model, parameters, solver;
  std::vector<WorkMesh> meshes;
};

/// A problem with a known answer.
struct WorkCase {
  std::string name;
  double reference;
  std::string source;  ///< of the reference
  std::function<nlohmann::json(const WorkMesh&, const WorkMethod&)> scene;
  std::string column;  ///< of probes.csv, whose last value is compared
  double scale;        ///< of that value
  std::vector<WorkMethod> methods;
  std::string cantilever{};  ///< what CalculiX solves beside it, "" for nothing
};

/// Made again by each call; `largest`: with the meshes that take longer than 5 s.
std::vector<WorkCase> work_cases(bool largest);

}  // namespace suture::bench
