// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "kernel/base/error.hpp"
#include "kernel/base/heap.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "kernel/mesh/own_origin.hpp"

namespace suture {
namespace {

/// What the import needed meanwhile is gone before the columns come.
Imported import_and_trim(Mesh mesh, const Scene& scene, Diagnostics& diagnostics) {
  Imported imported = import_mesh(std::move(mesh), scene.mesh.import, diagnostics);
  trim_heap();
  return imported;
}

Mesh load_mesh(const MeshSource& source, Diagnostics& diagnostics) {
  if (source.box) return make_local_box(*source.box);
  if (source.voxels) return make_local_voxels(*source.voxels);
  Mesh mesh = read_mesh(source.file, source.scale, diagnostics);
  move_to_own_origin(mesh);
  return mesh;
}

BodyFrame frame_of(const Mesh& mesh) {
  if (mesh.origin == Vec3{}) return {};
  const auto [low, high] = extent_of(mesh);
  const Vec3 size = minus(high, low);
  return {mesh.origin, std::sqrt(dot(size, size))};
}

DynamicsOptions dynamics_options(const Scene& scene) {
  DynamicsOptions options;
  options.scheme = scene.solver.integrator == SolverOptions::Integrator::velocity_verlet
                       ? DynamicsOptions::Scheme::velocity_verlet
                       : DynamicsOptions::Scheme::symplectic_euler;
  options.damping = scene.solver.damping;
  options.gravity = scene.gravity;
  options.gravity_ramp = scene.gravity_ramp;
  options.threads = scene.solver.threads;
  return options;
}

// Every element needs a model, or its vertices would have no mass.
void check_coverage(const World& world) {
  const auto& instances = world.attributes.instances();
  const Index count = world.imported.complex.element_count();
  if (std::any_of(instances.begin(), instances.end(),
                  [&](const auto& i) { return i->table(3).cells.is_all(); })) {
    return;
  }
  std::vector<char> covered(count);
  for (const auto& instance : instances) {
    for (const Index e : instance->table(3).cells.cells()) covered[e] = 1;
  }
  const auto bare = std::count(covered.begin(), covered.end(), 0);
  if (bare == 0) return;
  const auto first =
      static_cast<Index>(std::find(covered.begin(), covered.end(), 0) - covered.begin());
  throw InputError("/models: " + std::to_string(bare) + " of " + std::to_string(count) +
                   " elements have no model, the first is element " +
                   std::to_string(world.names.element_id(world.imported.user_element[first])) +
                   "; let the regions of the models cover the mesh");
}

}  // namespace

World::World(const Scene& given, Diagnostics& diagnostics, bool skip)
    : World(given, load_mesh(given.mesh, diagnostics), diagnostics, skip) {}

World::World(const Scene& given, Mesh mesh, Diagnostics& diagnostics, bool skip)
    : skips(skip),
      frame(frame_of(mesh)),
      scene(in_frame(given, frame)),
      mesh_source(mesh.source),
      names(MeshNames::of(mesh)),
      imported(import_and_trim(std::move(mesh), scene, diagnostics)),
      attributes(imported.complex, std::exchange(imported.rest, {})),
      selector(imported, names, attributes.rest(), frame),
      user_vertex(std::move(imported.user_vertex)) {
  if (names.element_ids.empty()) {
    attributes.user_element = imported.user_element.list();
  } else {
    for (Index e = 0; e < complex().element_count(); ++e)
      element_ids_.push_back(static_cast<Index>(element_name(e)));
    attributes.user_element = element_ids_;
  }
  add_models(diagnostics);
  dynamics = std::make_unique<Dynamics>(attributes, complex(), dynamics_options(scene));
  add_constraints();
  add_loads();
}

void World::add_models(Diagnostics& diagnostics) {
  if (!skips) {
    complex().require_edges();
    complex().require_faces();
  }
  for (const ModelUse& use : scene.models) {
    std::vector<Index> region;
    if (!std::holds_alternative<Selection::All>(use.region.what))
      region = selector.elements(use.region);
    attributes.add(
        std::make_unique<Instance>(*use.model, use.name, use.parameters, diagnostics, skips),
        complex(), std::move(region));
  }
  check_coverage(*this);
  attributes.initialise(complex(), diagnostics);
}

void World::add_constraints() {
  for (const Constraint& constraint : scene.constraints) {
    PrescribedMotion motion;
    if (constraint.moves) {
      motion.translation = constraint.translation;
      motion.axis = constraint.axis;
      motion.centre = constraint.centre;
      motion.angle = constraint.angle;
      motion.ramp = constraint.ramp;
    }
    const std::vector<Index> vertices = selector.vertices(constraint.where);
    if (constraint.moves) motion.reach = shortest_edge(vertices) / 10;
    dynamics->constraints().add(vertices, constraint.components, motion, attributes);
  }
}

/// At rest, of the elements around these vertices, m.
double World::shortest_edge(const std::vector<Index>& vertices) {
  double shortest = std::numeric_limits<double>::infinity();
  std::vector<Dart> star;
  for (const Index v : vertices) {
    complex().star(0, v, star);
    for (const Dart d : star)
      for (const auto& [a, b] : suture_hexahedron_edges) {
        const Hexahedron& nodes = complex().vertices_of(d / 24);
        double squared = 0;
        for (int c = 0; c < 3; ++c)
          squared +=
              std::pow(attributes.rest().get(nodes[a], c) - attributes.rest().get(nodes[b], c), 2);
        shortest = std::min(shortest, std::sqrt(squared));
      }
  }
  return shortest;
}

void World::add_loads() {
  Loads& loads = dynamics->loads();
  for (const Load& load : scene.loads) {
    switch (load.kind) {
      case Load::Kind::force:
        loads.add_force(complex(), attributes, selector.vertices(load.where), load.value,
                        load.ramp);
        break;
      case Load::Kind::traction:
        loads.add_traction(complex(), attributes, selector.boundary_faces(load.where), load.value,
                           load.ramp);
        break;
      case Load::Kind::pressure:
        loads.add_pressure(complex(), selector.boundary_faces(load.where), load.pressure,
                           load.ramp);
        break;
    }
  }
}

namespace {

std::vector<Index> sorted_once(std::vector<Index> vertices) {
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

}  // namespace

TopologyChange World::cut(const std::vector<Dart>& faces) {
  std::vector<Index> vertices;
  for (const Dart d : faces)
    for (const auto node : suture_hexahedron_faces[d % 24 / 4])
      vertices.push_back(complex().vertices_of(d / 24)[node]);
  dynamics->prepare_change(sorted_once(std::move(vertices)), true);
  TopologyChange change = complex().cut(faces);
  follow(change);
  return change;
}

TopologyChange World::pierce(const std::vector<Index>& elements) {
  std::vector<Index> vertices;
  for (const Index e : elements)
    vertices.insert(vertices.end(), complex().vertices_of(e).begin(),
                    complex().vertices_of(e).end());
  dynamics->prepare_change(sorted_once(std::move(vertices)), false);
  TopologyChange change = complex().pierce(elements);
  follow(change);
  return change;
}

/// Vertices that meet take the mean of their velocities; nothing is owed to each of them.
TopologyChange World::sew(const std::vector<Seam>& seams) {
  dynamics->prepare_change({}, false);
  TopologyChange change = complex().sew(seams);
  follow(change);
  return change;
}

void World::follow(const TopologyChange& change) {
  for (const Split& split : change.splits[0]) user_vertex.push_back(user_vertex[split.old_cell]);
  attributes.apply(complex(), change);
  dynamics->update(complex(), change);
  if (islands_) islands_->update(complex(), change);
}

std::string World::place_of(Index e) {
  Vec3 middle{};
  for (const Index v : complex().vertices_of(e))
    for (std::size_t c = 0; c < 3; ++c)
      middle[c] += attributes.rest().get(v, static_cast<int>(c)) / 8;
  return place_text(middle);
}

std::string World::place_text(const Vec3& local) const {
  const Vec3 p = frame.in_scene(local);
  std::ostringstream text;
  if (!frame.is_scene()) text.precision(10);  // the body is small beside its place
  text << '(' << p[0] << ", " << p[1] << ", " << p[2] << ") m";
  return text.str();
}

const Islands& World::islands() {
  complex().require_beta3();
  if (!islands_) islands_.emplace(complex());
  return *islands_;
}

}  // namespace suture
