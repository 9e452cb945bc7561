// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/suture-bench/cantilever.hpp"

namespace suture::bench {

/// A model with its parameters, and how the scene is solved, as members of a scene.
struct WorkMethod {
  std::string name, model, parameters, solver;
};

inline const char* const static_solver = R"({"static": {"frames": 1}, "threads": 1})";

/// An equilibrium; `element` "": of models that have no choice of elements.
WorkMethod static_method(const std::string& model, const std::string& element);

/// A box of this size, m, at the origin, without loads, constraints and output.
nlohmann::json box_scene(const std::array<Index, 3>& cells, const Vec3& size,
                         const WorkMethod& method, const nlohmann::json& material);

/// Members of a scene's output for tables only, with rows at the beginning and at the end.
nlohmann::json tables(const nlohmann::json& probe);

/// {"fix": "xyz"} of a set of nodes.
nlohmann::json held(const std::string& set);

nlohmann::json cantilever_scene(const Cantilever& what, const std::array<Index, 3>& cells,
                                const WorkMethod& method);

}  // namespace suture::bench
