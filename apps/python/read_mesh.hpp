// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <string>
#include <vector>

#include "kernel/scene/scene.hpp"

namespace suture::python {

/// The mesh that a scene reads from its files, for runs of scenes that differ elsewhere only.
struct ReadMesh {
  std::string key;  ///< of what determines it
  std::shared_ptr<const Mesh> mesh;
};

/// Reads it; null if the scene reads no mesh. Warnings become those of Python. Throws the errors of
/// the scene and of the mesh.
std::shared_ptr<ReadMesh> read_mesh(const std::string& text, const std::filesystem::path& file,
                                    bool is_text, const std::vector<std::string>& sets);

/// Lets a scene use a mesh that was read, if it would read the same.
void use(const std::shared_ptr<ReadMesh>& read, Scene& scene);

}  // namespace suture::python
