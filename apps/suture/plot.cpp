// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures. Those of results are drawn by Python alone; those of meshes by Python from a frame that
// has the boundary of the body, with a field per set: 1 at its points.
#include <unistd.h>

#include <cerrno>
#include <numeric>
#include <variant>

#include "apps/suture/commands.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/file.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/build/built_scene.hpp"
#include "kernel/geometry/shape_mesh.hpp"
#include "kernel/geometry/surface_file.hpp"
#include "kernel/mesh/file_text.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "kernel/output/frame_file.hpp"
#include "kernel/parts/shape_boundary.hpp"
#include "kernel/results/part_frames.hpp"
#include "kernel/scene/json_document.hpp"
#include "kernel/scene/scene_reader.hpp"

namespace suture {
namespace {

namespace fs = std::filesystem;

enum class Drawn { results, mesh, surface, scene };

Drawn kind_of(const fs::path& what) {
  const std::string extension = what.extension().string();
  if (extension == ".json") {
    const JsonValue root = parse_json(FileText(what).view(), what.string());
    return root.find("scene") != nullptr ? Drawn::results : Drawn::scene;  // of a study
  }
  if (is_surface_file(what)) return Drawn::surface;
  for (const char* of_mesh : {".vtu", ".vtk", ".mesh", ".msh"})
    if (extension == of_mesh) return Drawn::mesh;
  return Drawn::results;
}

/// What is drawn of a selection: its points, in the order of the frame.
void add_field(Frame& frame, const std::string& name, const std::vector<Index>& points) {
  FrameField& field = frame.point_fields.emplace_back();
  field.name = name;
  field.values.assign(frame.points.size(), 0);
  for (const Index p : points) field.values[p] = 1;
}

/// The points of elements.
std::vector<Index> points_of(std::span<const Hexahedron> hexahedra,
                             const std::vector<Index>& elements) {
  std::vector<Index> points;
  for (const Index e : elements)
    points.insert(points.end(), hexahedra[e].begin(), hexahedra[e].end());
  return points;
}

// ---------------------------------------------------------------------- files --

Frame frame_of_mesh(const PlotCommand& command, Diagnostics& diagnostics) {
  const Mesh mesh = read_shape(command.what[0], command.scale, diagnostics);
  Frame frame;
  frame.points = mesh.points;
  for (const ShapeFace& face : boundary_of(mesh)) {
    SmallCell& cell = frame.cells.emplace_back();
    cell.fill(none);
    std::copy_n(face.corners.begin(), face.size, cell.begin());
  }
  for (const auto& [name, points] : mesh.point_sets) add_field(frame, "set " + name, points);
  for (const auto& [name, elements] : mesh.element_sets)
    add_field(frame, "set " + name, points_of(mesh.hexahedra, elements));
  return frame;
}

Frame frame_of_surface(const PlotCommand& command) {
  const PolygonSoup soup = read_soup(command.what[0], command.scale);
  Frame frame;
  frame.points = soup.points;
  for (std::size_t i = 0; i < soup.size(); ++i)  // triangles around the first corner
    for (Index c = soup.offsets[i] + 2; c < soup.offsets[i + 1]; ++c)
      frame.cells.push_back(
          {soup.corners[soup.offsets[i]], soup.corners[c - 1], soup.corners[c], none});
  return frame;
}

// --------------------------------------------------------------------- scenes --

/// The body of a scene at rest, without models: mistakes in the rest of the scene do not keep it
/// from being seen.
struct RestBody {
  BodyFrame frame;
  MeshNames names;
  Parts parts;
  Body body;
  std::vector<NamedSelection> sets;
  Selector selector;

  RestBody(Mesh mesh, const Scene& scene, Diagnostics& diagnostics)
      : frame(frame_of(mesh)),
        names(MeshNames::of(mesh)),
        parts(mesh.parts),
        body(import_mesh(std::move(mesh), scene.mesh.import, diagnostics)),
        sets(scene.sets),
        selector(body.imported(), names, body.attributes().rest(), frame, parts, sets) {
    for (NamedSelection& set : sets) set.where = in_frame(std::move(set.where), frame);
    parts = renumbered(std::move(parts), body.imported().element_of);
  }
};

/// Adds a field of the vertices that a selection names; a selection that is wrong is a warning, as
/// the picture shows why.
class SelectionFields {
 public:
  SelectionFields(const RestBody& body, Frame& frame, Diagnostics& diagnostics)
      : body_(body), frame_(frame), diagnostics_(diagnostics) {}

  void add(const std::string& name, Selection where, bool of_elements = false) {
    try {
      where = in_frame(std::move(where), body_.frame);
      const Selector& selector = body_.selector;
      add_field(frame_, name,
                of_elements ? points_of(body_.body.complex().vertices(), selector.elements(where))
                            : selector.vertices(where));
    } catch (const InputError& error) {
      diagnostics_.warn(error.what());
    }
  }

 private:
  const RestBody& body_;
  Frame& frame_;
  Diagnostics& diagnostics_;
};

void add_sets(SelectionFields& fields, const MeshNames& names) {
  for (const auto& [name, unused] : names.point_sets)
    fields.add("set " + name, {Selection::Named{name}, ""});
  for (const auto& [name, unused] : names.element_sets)
    fields.add("set " + name, {Selection::Named{name}, ""}, true);
}

void add_selections(SelectionFields& fields, const Scene& scene) {
  for (const NamedSelection& set : scene.sets) fields.add("set " + set.name, set.where);
  const auto add = [&](const Selection& where, const std::string& name, bool of_elements = false) {
    const std::string place = where.path.substr(0, where.path.rfind('/'));
    fields.add("at " + place + (name.empty() ? "" : " " + name), where, of_elements);
  };
  for (const Constraint& constraint : scene.constraints) add(constraint.where, constraint.name);
  for (const Load& load : scene.loads) add(load.where, "");
  for (const Foundation& foundation : scene.foundations) add(foundation.where, "");
  for (const InitialMotion& motion : scene.initial_motion) add(motion.where, "");
  for (const Event& event : scene.events)
    if (const Grasp* grasp = std::get_if<Grasp>(&event.what); grasp && !grasp->obstacle)
      add(grasp->held.where, grasp->held.name);
  for (const ModelUse& use : scene.models)
    if (!std::holds_alternative<Selection::All>(use.region.what)) add(use.region, use.name, true);
}

/// The quadrilaterals of the boundary, counterclockwise as seen from outside.
std::vector<SmallCell> boundary_of(const CellComplex& complex) {
  std::vector<SmallCell> faces;
  for (Index e = 0; e < complex.element_count(); ++e)
    for (int f = 0; f < 6; ++f) {
      if (complex.neighbour(e, f) != none) continue;
      const Hexahedron& nodes = complex.vertices_of(e);
      const auto& corners = suture_hexahedron_faces[f];
      faces.push_back({nodes[corners[3]], nodes[corners[2]], nodes[corners[1]], nodes[corners[0]]});
    }
  return faces;
}

/// Adds the obstacles where they are at the start, each with a field of its points.
void add_obstacles(Frame& frame, const std::vector<Obstacle>& obstacles) {
  const Box box = box_of(frame.points);
  const Vec3 middle = scaled(0.5, plus(box.low, box.high));
  const double size = 0.6 * norm(minus(box.high, box.low));  // of a half-space
  for (const Obstacle& obstacle : obstacles) {
    const ShapeMesh mesh = mesh_of(obstacle.shape, middle, size);
    const auto first = static_cast<Index>(frame.points.size());
    const Pose pose = obstacle.motion.pose(0);
    for (const Vec3& point : mesh.points) frame.points.push_back(pose.place(point));
    for (SmallCell cell : mesh.faces) {
      for (Index& corner : cell)
        if (corner != none) corner += first;
      frame.cells.push_back(cell);
    }
    std::vector<Index> points(mesh.points.size());
    std::iota(points.begin(), points.end(), first);
    add_field(frame, "obstacle " + obstacle.name, points);
  }
  for (FrameField& field : frame.point_fields) field.values.resize(frame.points.size(), 0);
}

Frame frame_of_scene(const PlotCommand& command, Diagnostics& diagnostics) {
  PluginHost host(&diagnostics, trust_of(command));
  const Scene scene = read_scene(command.what[0], command.sets, host, diagnostics);
  RestBody body(load_mesh(scene, diagnostics), scene, diagnostics);
  const CellComplex& complex = body.body.complex();
  Frame frame;
  const Column& rest = body.body.attributes().rest();
  for (Index v = 0; v < rest.size(); ++v)
    frame.points.push_back(body.frame.in_scene({rest.get(v, 0), rest.get(v, 1), rest.get(v, 2)}));
  SelectionFields fields(body, frame, diagnostics);
  add_sets(fields, body.names);
  add_selections(fields, scene);
  if (body.parts.empty())
    frame.cells = boundary_of(complex);
  else
    show_surface(frame, Embedding(body.parts, complex));
  frame.cell_fields.clear();
  add_obstacles(frame, scene.contact.obstacles);
  return frame;
}

// ------------------------------------------------------------------------------

/// Passes a frame to the program that replaces this one, as a file without a name.
fs::path hand_over(Frame frame) {
  const Folder folder = Folder::open(fs::temp_directory_path());
  const std::string name = "suture-plot-" + std::to_string(::getpid()) + ".vtu";
  OutputFile file(folder, name);
  write_frame(file, frame, FrameWriterOptions::Compression::raw);
  folder.remove(name.c_str());
  const int kept = ::dup(file.descriptor());
  if (kept < 0) fail_io(file.path(), "kept open", errno);
  return "/proc/self/fd/" + std::to_string(kept);
}

}  // namespace

int plot(const PlotCommand& command, Console& console) {
  Drawn drawn = Drawn::results;
  for (const std::string& what : command.what) {
    drawn = kind_of(what);
    if (drawn == Drawn::results) continue;
    if (command.what.size() > 1)
      throw UsageError(what + ": a mesh, a surface or a scene is drawn alone");
    break;
  }
  if (drawn == Drawn::results) return plot_results(command);
  Frame frame = drawn == Drawn::mesh      ? frame_of_mesh(command, console.diagnostics())
                : drawn == Drawn::surface ? frame_of_surface(command)
                                          : frame_of_scene(command, console.diagnostics());
  const fs::path what = command.what[0];
  fs::path picture = command.picture;
  if (picture.empty()) picture = what.stem().string() + ".png";
  return plot_surface(hand_over(std::move(frame)), what.string(), picture);
}

}  // namespace suture
