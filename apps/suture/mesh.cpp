// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "apps/suture/commands.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/escape.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/geometry/surface_file.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "kernel/output/frame_file.hpp"
#include "kernel/parts/embedding.hpp"
#include "kernel/parts/fill_labels.hpp"
#include "kernel/parts/fill_shape.hpp"
#include "kernel/parts/shape_boundary.hpp"
#include "kernel/results/part_frames.hpp"
#include "kernel/topology/bad_elements.hpp"
#include "kernel/topology/import.hpp"
#include "kernel/topology/rest_shape.hpp"

namespace suture {
namespace {

std::string text_of(const Vec3& v) {
  char text[100];
  std::snprintf(text, sizeof text, "[%.6g, %.6g, %.6g]", v[0], v[1], v[2]);
  return text;
}

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

void print_counts(const Mesh& mesh, Console& console) {
  console.print(mesh.source + ": " + count(mesh.points.size(), "point") + ", " +
                std::to_string(mesh.hexahedra.size()) +
                (mesh.hexahedra.size() == 1 ? " hexahedron" : " hexahedra"));
  for (const auto& [type, number] : mesh.skipped_cells) {
    console.print("skipped: " + std::to_string(number) + " " + type);
  }
}

void print_sets(const char* of, const std::map<std::string, std::vector<Index>>& sets,
                Console& console) {
  for (const auto& [name, members] : sets) {
    console.print(std::string("set of ") + of + " \"" + escaped(name) +
                  "\": " + std::to_string(members.size()));
  }
}

/// "1000 to 5000", of all components; what is not finite is counted.
std::string range_of(const MeshArray& array) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double low = infinity, high = -infinity;
  std::size_t not_finite = 0;
  for (const double x : array.values) {
    if (!std::isfinite(x)) {
      ++not_finite;
      continue;
    }
    low = std::min(low, x);
    high = std::max(high, x);
  }
  std::string text = low <= high ? number_text(low) + " to " + number_text(high) : "no number";
  if (not_finite > 0) text += ", " + count(not_finite, "value") + " not finite";
  return text;
}

void print_arrays(const Mesh& mesh, Console& console) {
  for (const MeshArray& array : mesh.arrays) {
    const std::string name = std::string("array of ") +
                             (array.of_elements ? "elements" : "points") + " \"" +
                             escaped(array.name) + "\": ";
    if (array.unreadable.empty())
      console.print(name + count(array.components, "component") + ", " + range_of(array));
    else
      console.print(name + "cannot be read: " + array.unreadable);
  }
}

void print_bounds(const Mesh& mesh, Console& console) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Vec3 low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
  for (const Vec3& point : mesh.points) {
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], point[a]);
      high[a] = std::max(high[a], point[a]);
    }
  }
  console.print("bounding box: " + text_of(low) + " to " + text_of(high) + " m");
}

// Volume, and the scaled shape: smallest corner Jacobian over the mean one.
void print_shape(const Imported& imported, Console& console) {
  double volume = 0, worst = std::numeric_limits<double>::infinity();
  Index worst_element = 0;
  for (Index e = 0; e < imported.complex.element_count(); ++e) {
    Corners corners;
    for (std::size_t n = 0; n < 8; ++n)
      corners[n] = imported.rest[imported.complex.vertices()[e][n]];
    double element_volume = 0;
    for (const double j : gauss_jacobians(corners)) element_volume += j / 8;
    const auto jacobians = corner_jacobians(corners);
    const double quality = *std::min_element(jacobians.begin(), jacobians.end()) / element_volume;
    volume += element_volume;
    if (quality < worst) worst_element = imported.user_element[e];
    worst = std::min(worst, quality);
  }
  char text[160];
  std::snprintf(text, sizeof text,
                "volume: %.6g m^3; smallest corner Jacobian over volume: %.3g (element %u)", volume,
                worst, worst_element);
  console.print(text);
}

void print_topology(Imported& imported, Console& console) {
  CellComplex& complex = imported.complex;
  complex.require_edges();
  complex.require_faces();
  std::size_t boundary = 0;
  for (Index e = 0; e < complex.element_count(); ++e) {
    for (int f = 0; f < 6; ++f) boundary += complex.neighbour(e, f) == none ? 1 : 0;
  }
  Index islands = 0;
  complex.islands(&islands);
  console.print("cells: " + std::to_string(complex.count(0)) + " vertices, " +
                std::to_string(complex.count(1)) + " edges, " + std::to_string(complex.count(2)) +
                " faces (" + std::to_string(boundary) + " on the boundary); " +
                count(islands, "island"));
}

int surface_info(const MeshInfoCommand& command, Console& console) {
  const PolygonSoup soup = read_soup(command.file, command.scale.value_or(1));
  const Closing closing = closing_of(soup, false);
  console.print(soup.source + ": a surface of " + count(soup.points.size(), "point") + ", " +
                count(closing.triangles, "triangle") + ", " +
                count(closing.components, "component"));
  const Box box = box_of(soup.points);
  console.print("bounding box: " + text_of(box.low) + " to " + text_of(box.high) + " m");
  if (closing.faces_dropped > 0)
    console.print("dropped: " + count(closing.faces_dropped, "face") +
                  " without area or there twice");
  for (const Hole& hole : closing.holes) console.print(hole_text(hole));
  if (!closing.holes.empty())
    console.print("not closed: " + count(closing.holes.size(), "hole") + ", " +
                  count(closing.border_edges, "edge") + " with a face on one side only");
  else if (closing.crossings > 0)
    console.print("closed, and crosses itself: " + count(closing.crossings, "pair") +
                  " of triangles");
  else
    console.print("closed; volume: " + number_text(closing.volume) + " m^3");
  return 0;
}

int image_info(const MeshInfoCommand& command, Console& console) {
  const ImageHeader image = read_image_header(command.file);
  const double unit = command.scale.value_or(image.unit);
  console.print(image.source + ": an image of " + size_text(image));
  Vec3 spacing;
  for (std::size_t a = 0; a < 3; ++a) spacing[a] = unit * norm(image.steps[a]);
  console.print("spacing: " + text_of(spacing) + " m; first voxel at " +
                text_of(scaled(unit, image.origin)) + " m");
  const double voxel =
      unit * unit * unit * std::abs(dot(image.steps[0], cross(image.steps[1], image.steps[2])));
  for (const auto& [label, number] : count_labels(image, console.diagnostics()))
    console.print("label " + std::to_string(label) + ": " + count(number, "voxel") + ", " +
                  number_text(voxel * double(number)) + " m^3");
  return 0;
}

/// Cells that are not all hexahedra give a shape.
bool is_shape(const Mesh& cells) {
  return std::ranges::none_of(cells.hexahedra, [](Hexahedron nodes) {
    std::ranges::sort(nodes);
    return std::ranges::adjacent_find(nodes) == nodes.end();
  });
}

void print_contents(const Mesh& mesh, Console& console) {
  print_sets("points", mesh.point_sets, console);
  print_sets("elements", mesh.element_sets, console);
  print_arrays(mesh, console);
  print_bounds(mesh, console);
}

int shape_info(const Mesh& shape, Console& console) {
  console.print(shape.source + ": " + count(shape.points.size(), "point") + ", " +
                count(shape.hexahedra.size(), "solid cell") + ", " +
                count(boundary_of(shape).size(), "face") + " on the boundary");
  print_contents(shape, console);
  console.print(
      "no hexahedra: /mesh takes it with \"cells\" as a shape that is filled, as 'suture "
      "mesh fill' does");
  return 0;
}

}  // namespace

int mesh_info(const MeshInfoCommand& command, Console& console) {
  if (is_surface_file(command.file)) return surface_info(command, console);
  if (is_image_file(command.file)) return image_info(command, console);
  const double scale = command.scale.value_or(1);
  Diagnostics unheard;
  if (const Mesh cells = read_shape(command.file, scale, unheard, all_arrays); is_shape(cells))
    return shape_info(cells, console);
  const Mesh mesh = read_mesh(command.file, scale, console.diagnostics(), all_arrays);
  print_counts(mesh, console);
  print_contents(mesh, console);
  Imported imported = import_mesh(mesh, {}, console.diagnostics());
  print_topology(imported, console);
  print_shape(imported, console);
  return 0;
}

int mesh_convert(const MeshConvertCommand& command, Console& console) {
  Mesh mesh = read_mesh(command.from, command.scale, console.diagnostics(), all_arrays);
  if (command.drop_bad) drop_bad_elements(mesh, false, console.diagnostics());
  write_mesh(command.to, mesh, console.diagnostics());
  if (!console.quiet()) print_counts(mesh, console);
  return 0;
}

int mesh_generate_box(const MeshBoxCommand& command, Console& console) {
  const Mesh mesh = make_box(command.box);
  write_mesh(command.to, mesh, console.diagnostics());
  if (!console.quiet()) print_counts(mesh, console);
  return 0;
}

namespace {

TriangleSurface surface_of(const std::filesystem::path& file, double scale, bool repair,
                           Console& console) {
  return close_surface(read_soup(file, scale), repair, console.diagnostics());
}

void require_size(const char* command, std::size_t cells, double edge) {
  if (cells == 0 && edge == 0)
    throw UsageError(std::string("suture mesh ") + command +
                     ": the size of the cubes is missing; give --cells or --edge");
}

/// The mesh that fills a closed surface, the shape of a mesh of solid cells or an image.
Mesh filled(const MeshFillCommand& command, Console& console) {
  Diagnostics& diagnostics = console.diagnostics();
  const double scale = command.scale.value_or(1);
  if (is_image_file(command.from))
    return fill_labels(
        read_labels(command.from, {.names = command.labels, .scale = command.scale}, diagnostics),
        command.size, diagnostics);
  if (!command.labels.empty())
    throw UsageError("suture mesh fill: --label is for images; " + command.from.string() +
                     " is none");
  if (is_surface_file(command.from))
    return fill_surface(surface_of(command.from, scale, command.repair, console), command.size,
                        diagnostics);
  return fill_shape(read_shape(command.from, scale, diagnostics), command.size, command.repair,
                    diagnostics);
}

/// The mesh at rest, as frames of a run have it, with the fraction of each element and its sets.
Frame frame_of(const Mesh& mesh, Diagnostics& diagnostics) {
  const Imported imported = import_mesh(mesh, {.renumber = false}, diagnostics);
  Frame frame;
  frame.points = imported.rest;
  const auto hexahedra = imported.complex.vertices();
  frame.hexahedra.assign(hexahedra.begin(), hexahedra.end());
  FrameField& fraction = frame.cell_fields.emplace_back();
  fraction.name = "fraction";
  fraction.values.assign(mesh.hexahedra.size(), 1);
  for (std::size_t i = 0; i < mesh.parts.elements.size(); ++i)
    fraction.values[mesh.parts.elements[i]] = mesh.parts.moments[i].fraction;
  for (const auto& [name, members] : mesh.element_sets) {
    FrameField& field = frame.cell_fields.emplace_back();
    field.name = name;
    field.values.assign(mesh.hexahedra.size(), 0);
    for (const Index e : members) field.values[e] = 1;
  }
  if (!mesh.parts.empty())
    show_parts(frame, mesh.parts, Embedding(mesh.parts, imported.complex), imported.complex);
  return frame;
}

void write_frame(const std::filesystem::path& path, Frame frame) {
  const Folder folder = Folder::open(path.parent_path());
  AtomicFile file(folder, path.filename().string());
  write_frame(file, frame, FrameWriterOptions::Compression::lz4);
  file.commit();
}

/// The surface of a mesh inside its elements.
TriangleSurface embedded_surface(const Mesh& mesh, Diagnostics& diagnostics) {
  const Imported imported = import_mesh(mesh, {.renumber = false}, diagnostics);
  Frame frame;
  frame.points = imported.rest;
  show_surface(frame, Embedding(mesh.parts, imported.complex));
  TriangleSurface surface{mesh.source, std::move(frame.points), {}};
  for (const auto& [a, b, c, unused] : frame.cells) surface.triangles.push_back({a, b, c});
  return surface;
}

}  // namespace

int mesh_voxelize(const MeshVoxelizeCommand& command, Console& console) {
  require_size("voxelize", command.options.cells, command.options.edge);
  const Mesh mesh = voxelize(surface_of(command.from, command.scale, command.repair, console),
                             command.options, console.diagnostics());
  write_mesh(command.to, mesh, console.diagnostics());
  if (!console.quiet()) print_counts(mesh, console);
  return 0;
}

int mesh_fill(const MeshFillCommand& command, Console& console) {
  require_size("fill", command.size.cells, command.size.edge);
  const std::string extension = command.to.extension().string();
  const bool is_frame = extension == ".vtu";
  if (!is_frame && (extension == ".vtp" || !is_surface_file(command.to)))
    throw UsageError(command.to.string() +
                     ": expected .vtu for the mesh, or .obj, .off, .ply or .stl for its surface, "
                     "not '" +
                     extension + "'; scenes read the surface itself: \"surface\" in /mesh");
  const Mesh mesh = filled(command, console);
  if (is_frame)
    write_frame(command.to, frame_of(mesh, console.diagnostics()));
  else
    write_surface(command.to, embedded_surface(mesh, console.diagnostics()));
  if (console.quiet()) return 0;
  print_counts(mesh, console);
  print_sets("elements", mesh.element_sets, console);
  console.print("elements that the surface crosses: " + std::to_string(mesh.parts.elements.size()));
  return 0;
}

}  // namespace suture
