// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <numeric>

#include "kernel/base/error.hpp"
#include "kernel/base/escape.hpp"
#include "kernel/base/file.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "kernel/mesh/vtk_order.hpp"
#include "kernel/mesh/writers.hpp"
#include "kernel/vtk/vtk_module.hpp"

namespace suture {
namespace {

using Sets = std::map<std::string, std::vector<Index>>;

// Arrays of 0 and 1, one per set, that live as long as the image that points to them.
class FlagArrays {
 public:
  void add(const Sets& sets, std::size_t count, std::vector<VtuArray>& arrays) {
    for (const auto& [name, members] : sets) {
      auto& flags = memory_.emplace_back(count, std::uint8_t{0});
      for (const Index i : members) flags[i] = 1;
      VtuArray& array = arrays.emplace_back();
      array.name = name;
      array.flags = flags.data();
    }
  }

 private:
  std::vector<std::vector<std::uint8_t>> memory_;
};

void add_numbers(const Mesh& mesh, bool of_elements, std::vector<VtuArray>& arrays) {
  for (const MeshArray& from : mesh.arrays) {
    if (from.of_elements != of_elements || from.values.empty()) continue;
    VtuArray& array = arrays.emplace_back();
    array.name = from.name;
    array.components = static_cast<int>(from.components);
    array.values = from.values.data();
  }
}

void add_ids(const std::vector<std::uint64_t>& ids, const char* name,
             std::vector<VtuArray>& arrays) {
  if (ids.empty()) return;
  VtuArray& array = arrays.emplace_back();
  array.name = name;
  array.ids = reinterpret_cast<const std::int64_t*>(ids.data());
  array.global_ids = true;
}

void write_vtu(const std::filesystem::path& path, const Mesh& mesh) {
  std::vector<Hexahedron> cells(mesh.hexahedra.size());
  std::transform(mesh.hexahedra.begin(), mesh.hexahedra.end(), cells.begin(), swap_vtk_order);
  VtuImage image;
  image.points = mesh.points.data();
  image.point_count = mesh.points.size();
  image.connectivity = reinterpret_cast<const Index*>(cells.data());
  image.connectivity_size = 8 * cells.size();
  image.cell_count = cells.size();
  FlagArrays flags;
  flags.add(mesh.point_sets, mesh.points.size(), image.point_arrays);
  flags.add(mesh.element_sets, cells.size(), image.cell_arrays);
  add_numbers(mesh, false, image.point_arrays);
  add_numbers(mesh, true, image.cell_arrays);
  add_ids(mesh.point_ids, "point ids", image.point_arrays);
  add_ids(mesh.element_ids, "element ids", image.cell_arrays);

  const Folder folder = Folder::open(path.parent_path());
  AtomicFile file(folder, path.filename().string());
  const VtuOutcome outcome = vtk_module().write_vtu(file.descriptor(), image);
  if (outcome.error != 0) fail_io(path, "written", outcome.error);
  if (!outcome.text.empty()) throw IoError(path.string() + ": cannot be written: " + outcome.text);
  file.commit();
}

}  // namespace

void write_mesh(const std::filesystem::path& path, const Mesh& mesh, Diagnostics& diagnostics) {
  for (const MeshArray& array : mesh.arrays)
    if (!array.unreadable.empty())
      diagnostics.warn("array " + quote(array.name) + " is lost: it cannot be read from " +
                       mesh.source + ": " + array.unreadable);
  const std::string extension = path.extension().string();
  if (extension == ".vtu") {
    write_vtu(path, mesh);
  } else if (extension == ".vtk") {
    write_file(path, vtk_legacy_text(mesh));
  } else if (extension == ".mesh") {
    write_file(path, medit_text(mesh, diagnostics));
  } else if (extension == ".msh") {
    write_file(path, gmsh_text(mesh, diagnostics));
  } else {
    throw UsageError(path.string() +
                     ": cannot write this mesh format; expected .vtu, .vtk, .mesh or .msh, not '" +
                     extension + "'");
  }
}

std::vector<std::uint64_t> tags_of(const std::vector<std::uint64_t>& ids, std::size_t count) {
  std::vector<std::uint64_t> sorted = ids;
  std::sort(sorted.begin(), sorted.end());
  const bool usable = ids.size() == count && count > 0 && sorted.front() > 0 &&
                      std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
  if (usable) return ids;
  sorted.resize(count);
  std::iota(sorted.begin(), sorted.end(), std::uint64_t{1});
  return sorted;
}

}  // namespace suture
