// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/suture-bench/cantilever.hpp"
#include "kernel/mesh/mesh.hpp"

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

inline const char* const static_solver = R"({"static": {"frames": 1}, "threads": 1})";

/// An equilibrium; `element` "": of models that have no choice of elements.
WorkMethod static_method(const std::string& model, const std::string& element,
                         std::vector<WorkMesh> meshes);

/// A box of this size, m, at the origin, without loads, constraints and output.
nlohmann::json box_scene(const WorkMesh& mesh, const Vec3& size, const WorkMethod& method,
                         const nlohmann::json& material);

/// Members of a scene's output for tables only, with rows at the beginning and at the end.
nlohmann::json tables(const nlohmann::json& probe);

/// {"fix": "xyz"} of a set of nodes.
nlohmann::json held(const std::string& set);

nlohmann::json cantilever_scene(const Cantilever& what, const WorkMesh& mesh,
                                const WorkMethod& method);

/// The box that a scene names.
Mesh box_of(const nlohmann::json& scene);

}  // namespace suture::bench
