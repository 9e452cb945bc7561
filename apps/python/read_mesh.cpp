// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/python/read_mesh.hpp"

#include "kernel/build/built_scene.hpp"
#include "kernel/build/cell_values.hpp"
#include "kernel/plugin_host/plugin_host.hpp"
#include "kernel/scene/json_document.hpp"
#include "kernel/scene/scene_reader.hpp"

namespace suture::python {
namespace {

namespace py = pybind11;

/// The key of a mesh: the folder that its files are relative to, /mesh, and the arrays.
std::string key_of(const Scene& scene) {
  const JsonValue root = parse_json(scene.text_that_counts, "scene");
  const JsonValue* mesh = root.find("mesh");
  if (mesh == nullptr) return "";
  std::string key = scene.file.parent_path().string() + '\n' + canonical_json(*mesh);
  for (const std::string& array : arrays_of(scene)) key += '\n' + array;
  return key;
}

}  // namespace

std::shared_ptr<ReadMesh> read_mesh(const std::string& text, const std::filesystem::path& file,
                                    bool is_text, const std::vector<std::string>& sets) {
  Diagnostics of_scene, of_mesh;  // every run has those of the scene itself
  auto read = std::make_shared<ReadMesh>();
  {
    const py::gil_scoped_release others_may_run;
    PluginHost host(&of_scene);
    const ModelLookup lookup = lookup_of(host);
    const Scene scene = is_text ? read_scene_text(text, file, sets, lookup, of_scene)
                                : read_scene(file, sets, lookup, of_scene, {});
    read->key = key_of(scene);
    read->mesh = read_mesh_of(scene, of_mesh);
  }
  for (const std::string& warning : of_mesh.warnings())
    if (PyErr_WarnEx(PyExc_UserWarning, warning.c_str(), 2) != 0) throw py::error_already_set();
  return read->mesh ? read : nullptr;
}

void use(const std::shared_ptr<ReadMesh>& read, Scene& scene) {
  if (read && read->key == key_of(scene)) scene.mesh.given = read->mesh;
}

}  // namespace suture::python
