// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/mesh/mesh_file.hpp"

#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/mesh/accepted_as.hpp"
#include "kernel/mesh/readers.hpp"

namespace suture {
namespace {

using Reader = Mesh (*)(const FileText&, const MeshWants&, Diagnostics&);

// What the file says of itself; null if nothing known.
Reader reader_by_content(const FileText& file) {
  std::string_view text = file.view().substr(0, 4096);
  const std::size_t start = text.find_first_not_of(" \t\r\n");
  text.remove_prefix(start == text.npos ? text.size() : start);
  if (text.starts_with("# vtk DataFile")) return read_vtk_legacy;
  if (text.starts_with("<?xml") || text.starts_with("<VTKFile")) return read_vtu;
  if (text.starts_with("$")) return read_gmsh;
  if (text.starts_with("MeshVersionFormatted")) return read_medit;
  return nullptr;
}

Reader reader_by_extension(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".mesh") return read_medit;
  if (extension == ".msh") return read_gmsh;
  if (extension == ".vtk") return read_vtk_legacy;
  if (extension == ".vtu") return read_vtu;
  return nullptr;
}

std::string list_of(const std::map<std::string, std::size_t>& cells) {
  std::string text;
  for (const auto& [name, count] : cells) {
    text += (text.empty() ? "" : ", ") + grouped(count) + " " + name;
  }
  return text;
}

std::string contents_of(const Mesh& mesh) {
  const std::string others = list_of(mesh.skipped_cells);
  return "; the file contains " + grouped(mesh.points.size()) + " points" +
         (others.empty() ? "" : ", " + others) + ". ";
}

void check_hexahedra(const Mesh& mesh, Diagnostics& diagnostics) {
  const std::string others = list_of(mesh.skipped_cells);
  if (mesh.hexahedra.empty()) {
    throw InputError(mesh.source + ": no hexahedra" + contents_of(mesh) +
                     "Mesh the body with 8-node hexahedra, or let it be filled with them: with "
                     "\"cells\" beside \"file\" in a scene, and in 'suture mesh fill', other solid "
                     "cells give its shape");
  }
  if (!others.empty()) {
    diagnostics.warn(mesh.source + ": skipped " + others + "; only the " +
                     grouped(mesh.hexahedra.size()) + " hexahedra are used");
  }
}

void scale_points(Mesh& mesh, double scale) {
  if (!(scale > 0) || !std::isfinite(scale)) {
    throw InputError(mesh.source + ": scale must be positive and finite");
  }
  if (scale == 1) return;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    for (double& x : mesh.points[i]) {
      x *= scale;
      if (!std::isfinite(x)) {
        throw InputError(mesh.source + ": point " + std::to_string(i) +
                         " is not finite after scaling");
      }
    }
  }
}

}  // namespace

namespace {

Mesh read_cells(const std::filesystem::path& path, const MeshWants& wants,
                Diagnostics& diagnostics) {
  const FileText file(path);
  Reader reader = reader_by_content(file);
  if (!reader) reader = reader_by_extension(path);
  if (!reader) {
    throw InputError(path.string() +
                     ": neither the contents nor the extension are those of a mesh; expected Medit "
                     ".mesh, Gmsh .msh, VTK .vtk or .vtu" +
                     accepted_as(path));
  }
  Mesh mesh = reader(file, wants, diagnostics);
  mesh.source = path.string();
  return mesh;
}

}  // namespace

Mesh read_mesh(const std::filesystem::path& path, double scale, Diagnostics& diagnostics,
               const WantsArray& wants) {
  Mesh mesh = read_cells(path, {.array = wants}, diagnostics);
  check_hexahedra(mesh, diagnostics);
  scale_points(mesh, scale);
  return mesh;
}

Mesh read_shape(const std::filesystem::path& path, double scale, Diagnostics& diagnostics,
                const WantsArray& wants) {
  Mesh mesh = read_cells(path, {.array = wants, .all_solids = true}, diagnostics);
  if (mesh.hexahedra.empty())
    throw InputError(mesh.source + ": no tetrahedra, pyramids, wedges or hexahedra" +
                     contents_of(mesh) +
                     "Give a mesh of the inside of the body, or a closed surface as \"surface\"");
  scale_points(mesh, scale);
  return mesh;
}

void add_sets_by_value(Sets& sets, const std::string& prefix,
                       const std::vector<std::int64_t>& values, bool with_zero,
                       const std::string& source, Diagnostics& diagnostics) {
  constexpr std::size_t max_labels = 4096;
  std::map<std::int64_t, std::vector<Index>> by_value;
  std::vector<Index>* last = nullptr;
  std::int64_t last_value = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::int64_t value = values[i];
    if (value == 0 && !with_zero) continue;
    if (!last || value != last_value) {
      last = &by_value[value];
      last_value = value;
      if (by_value.size() > max_labels) {
        diagnostics.warn(source + ": '" + prefix + "' has more than " + grouped(max_labels) +
                         " different values; they are not read as sets");
        return;
      }
    }
    last->push_back(static_cast<Index>(i));
  }
  for (auto& [value, members] : by_value) {
    sets[std::string(prefix).append(1, ' ').append(std::to_string(value))] = std::move(members);
  }
}

void check_count(const FileText& file, std::uint64_t count, const char* what) {
  if (count >= none) {
    throw InputError(file.name() + ": " + grouped(count) + " " + what +
                     " are too many for 32-bit numbers");
  }
}

void warn_of_curved_cells(const FileText& file, Diagnostics& diagnostics) {
  diagnostics.warn(file.name() +
                   ": of quadratic cells, only the corners are read: their edges become straight");
}

std::string too_many_nodes(std::size_t nodes) {
  return "hexahedra with " + std::to_string(nodes) +
         " nodes are not supported; save the mesh at order 1 (in Gmsh: Mesh.ElementOrder = 1)";
}

}  // namespace suture
