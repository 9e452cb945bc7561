// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/suture-bench/work_scene.hpp"

namespace suture::bench {

/// What CalculiX solves beside Suture: the same scenes with its own elements.
struct CalculixMethod {
  std::string element, solver;
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
  std::vector<CalculixMethod> beside{};
  /// Makes the file `mesh_file` of scenes that name it; none: scenes name a box.
  std::function<Mesh(const WorkMesh&)> mesh{};
  CalculixMethod finest{};  ///< on three meshes, from which the reference is extrapolated
  static constexpr const char* mesh_file = "mesh.msh";
};

/// Made again by each call; `largest`: with the meshes that take longer than 5 s.
std::vector<WorkCase> work_cases(bool largest);

}  // namespace suture::bench
