// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/build/built_scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>
#include <utility>

#include "kernel/attributes/lips.hpp"
#include "kernel/base/box.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/heap.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/build/add_fields.hpp"
#include "kernel/build/cell_values.hpp"
#include "kernel/build/check_constraints.hpp"
#include "kernel/build/check_obstacles.hpp"
#include "kernel/build/check_parts.hpp"
#include "kernel/build/check_selections.hpp"
#include "kernel/build/initial_motion.hpp"
#include "kernel/build/model_regions.hpp"
#include "kernel/contact/contact.hpp"
#include "kernel/contact/multiplier_forces.hpp"
#include "kernel/contact/penalty_forces.hpp"
#include "kernel/forces/dead_loads.hpp"
#include "kernel/forces/enclosed_volumes.hpp"
#include "kernel/forces/foundations.hpp"
#include "kernel/forces/gravity.hpp"
#include "kernel/forces/pressures.hpp"
#include "kernel/geometry/centroid.hpp"
#include "kernel/geometry/surface_file.hpp"
#include "kernel/mesh/coincident_points.hpp"
#include "kernel/mesh/file_text.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "kernel/mesh/own_origin.hpp"
#include "kernel/parts/align_axes.hpp"
#include "kernel/parts/fill_labels.hpp"
#include "kernel/parts/fill_shape.hpp"
#include "kernel/parts/lattice.hpp"
#include "kernel/parts/part_materials.hpp"
#include "kernel/topology/bad_elements.hpp"
#include "kernel/topology/rest_shape.hpp"

namespace suture {
namespace {

/// What the import needed meanwhile is gone before the columns come.
Imported import_and_trim(Mesh mesh, const Scene& scene, Diagnostics& diagnostics) {
  if (scene.divides_elements() && mesh.parts.empty()) align_axes(mesh.hexahedra);
  Imported imported = import_mesh(std::move(mesh), scene.mesh.import, diagnostics);
  trim_heap();
  return imported;
}

Mesh fill(const MeshSource& source, const WantsArray& wants, Diagnostics& diagnostics) {
  const FilledBody& filled = *source.filled;
  constexpr const char* repair_option = "\"repair\": true in /mesh";
  const double scale = source.scale.value_or(1);
  if (!filled.labels.empty())
    return fill_labels(
        read_labels(filled.file, {.names = filled.labels, .scale = source.scale}, diagnostics),
        filled.size, diagnostics);
  if (filled.is_shape)
    return fill_shape(read_shape(filled.file, scale, diagnostics, wants), filled.size,
                      filled.repair, diagnostics, repair_option);
  try {
    return fill_surface(
        close_surface(read_soup(filled.file, scale), filled.repair, diagnostics, repair_option),
        filled.size, diagnostics);
  } catch (const InputError& error) {
    throw InputError(std::string("/mesh/surface: ") + error.what());
  }
}

Mesh read(const MeshSource& source, const std::set<std::string>& arrays, Diagnostics& diagnostics) {
  if (source.given) return *source.given;
  const auto wants = [&](const std::string& name) { return arrays.contains(name); };
  if (source.filled) return fill(source, wants, diagnostics);
  return read_mesh(source.file, source.scale.value_or(1), diagnostics, wants);
}

Mesh make_mesh(const MeshSource& source, const std::set<std::string>& arrays,
               Diagnostics& diagnostics) {
  if (source.box) return make_local_box(*source.box);
  if (source.voxels) return make_local_voxels(*source.voxels);
  Mesh mesh = read(source, arrays, diagnostics);
  move_to_own_origin(mesh);
  return mesh;
}

}  // namespace

std::shared_ptr<const Mesh> read_mesh_of(const Scene& scene, Diagnostics& diagnostics) {
  const MeshSource& source = scene.mesh;
  if (source.box || source.voxels || source.given) return nullptr;
  return std::make_shared<const Mesh>(read(source, arrays_of(scene), diagnostics));
}

Mesh load_mesh(const Scene& scene, Diagnostics& diagnostics) {
  const MeshSource& source = scene.mesh;
  Mesh mesh = make_mesh(source, arrays_of(scene), diagnostics);
  if (source.merge > 0)
    if (const std::size_t merged = merge_points(mesh, source.merge); merged > 0)
      diagnostics.note(mesh.source + ": merged " + grouped(merged) +
                       (merged == 1 ? " node" : " nodes") + " with another one in the same place");
  if (source.drop_bad_elements)
    drop_bad_elements(mesh, source.import.allow_inverted_rest, diagnostics);
  return mesh;
}

BodyFrame frame_of(const Mesh& mesh) {
  if (mesh.origin == Vec3{}) return {};
  const auto [low, high] = box_of(mesh);
  const Vec3 size = minus(high, low);
  return {mesh.origin, std::sqrt(dot(size, size))};
}

namespace {

/// Nodes of different islands in one place look like one body, but nothing holds them together.
void warn_of_unjoined_nodes(const Scene& scene, Body& body, Diagnostics& diagnostics) {
  const CellComplex& complex = body.complex();
  Index islands = 0;
  const std::vector<Index> island_of = complex.islands(&islands);
  if (islands < 2 || scene.contact.pieces) return;
  const Column& rest = body.attributes().rest();
  std::vector<Vec3> places;
  std::vector<Index> island(rest.size(), none);
  Box box = no_box;
  for (Index v = 0; v < rest.size(); ++v) {
    places.push_back({rest.get(v, 0), rest.get(v, 1), rest.get(v, 2)});
    include(box, places.back());
  }
  for (Index e = 0; e < complex.element_count(); ++e)
    if (complex.exists(3, e))
      for (const Index v : complex.vertices_of(e)) island[v] = island_of[e];
  const double size = std::max({box.length(0), box.length(1), box.length(2)});
  const std::vector<Index> first = first_in_place(places, 1e-9 * size);
  std::size_t pairs = 0;
  const std::vector<Index>& point = body.user_vertex();  // the import may split one
  for (Index v = 0; v < first.size(); ++v)
    pairs += island[v] != island[first[v]] && point[v] != point[first[v]] ? 1 : 0;
  if (pairs == 0) return;
  char tolerance[32];
  std::snprintf(tolerance, sizeof tolerance, "%.1g", 1e-6 * size);
  diagnostics.warn(
      "the mesh consists of " + grouped(islands) + " islands with " + grouped(pairs) +
      (pairs == 1 ? " pair" : " pairs") +
      " of nodes in one place, which nothing holds together; give \"merge\": " + tolerance +
      " in /mesh to join them, or \"pieces\": true in /contact to let " + "them touch");
}

bool stops_on_inversion(const Scene& scene, const ModelUse& use) {
  for (const OnInversion choice : {use.on_inversion, scene.solver.on_inversion})
    if (choice != OnInversion::by_model) return choice == OnInversion::stop;
  return (use.model->flags & SUTURE_CONTINUUM) != 0;
}

}  // namespace

BuiltScene::BuiltScene(const Scene& given, Diagnostics& diagnostics, bool skip)
    : BuiltScene(given, load_mesh(given, diagnostics), diagnostics, skip) {}

BuiltScene::BuiltScene(const Scene& given, Mesh mesh, Diagnostics& diagnostics, bool skip)
    : skips_(skip),
      frame_(frame_of(mesh)),
      scene_(in_frame(given, frame_)),
      mesh_source_(mesh.source),
      names_(MeshNames::of(mesh)),
      parts_(mesh.parts),
      body_(import_and_trim(std::move(mesh), scene_, diagnostics)),
      selector_(body_.imported(), names_, body_.attributes().rest(), frame_, parts_.parts(),
                scene_.sets) {
  parts_.renumber(body_.imported().element_of);
  check_parts(scene_, parts());
  if (scene_.divides_elements()) let_parts_grow();
  if (is_embedded()) body_.add_follower(parts_);
  if (!scene_.mesh.file.empty() && !scene_.mesh.filled)
    warn_of_unjoined_nodes(scene_, body_, diagnostics);
  check_selections(scene_, selector_);
  name_elements();
  add_models(diagnostics);
  const DynamicsOptions options{
      scene_.solver.integrator,
      scene_.solver.damping,
      {scene_.solver.step_tolerance, stops_on_inversion(), scene_.solver.hold_free_pieces,
       scene_.solver.follow_path, scene_.solver.budget, scene_.solver.compensate}};
  dynamics_ = std::make_unique<Dynamics>(body_, options);
  limits_ = std::make_unique<StepLimits>(body_);
  add_constraints();
  for (const InitialMotion& motion : scene_.initial_motion)
    add_initial_motion(motion, selector_.vertices(motion.where), body_.attributes());
  add_terms();
  add_fields(scene_, selector_, body_, [&](Index v) { return node_text(v); });
  add_contact(diagnostics);
  open_lips();
}

/// Before the models, which must allow it.
void BuiltScene::let_parts_grow() {
  const auto event = std::ranges::find_if(scene_.events, &Event::is_along_blade);
  const std::string path =
      event != scene_.events.end() ? event->path + "/cut/along: " : "/divisible: ";
  if (const Index e = first_off_lattice(body_.complex()); e != none)
    throw InputError(
        path + "element " + std::to_string(element_name(e)) +
        " and a neighbour do not lie along the same axes, as around an inner edge with three or "
        "five elements; a blade may divide meshes of mapped blocks only. Cut along \"faces\" "
        "instead");
  const RestPlaces rest = body_.attributes().rest_places(body_.complex());
  for (Index e = 0; e < body_.complex().element_count(); ++e)
    if (body_.complex().exists(3, e) && rest_shape(rest.of(e)).inverted)
      throw InputError(path + "element " + std::to_string(element_name(e)) +
                       " has a corner Jacobian <= 0, so that a part of it could have a negative "
                       "mass; a blade may divide elements with positive Jacobians only. Mend the "
                       "mesh, or cut along \"faces\" instead");
  body_.attributes().let_parts_grow(body_.complex());
  parts_.let_grow(body_.complex());
}

std::vector<bool> BuiltScene::stops_on_inversion() const {
  std::vector<bool> stops;
  for (const ModelUse& use : scene_.models)
    stops.push_back(suture::stops_on_inversion(scene_, use));
  return stops;
}

void BuiltScene::name_elements() {
  if (names_.element_ids.empty()) return;
  std::vector<Index> names;
  for (Index e = 0; e < body_.complex().element_count(); ++e)
    names.push_back(static_cast<Index>(element_name(e)));
  body_.name_elements(std::move(names));
}

void BuiltScene::add_models(Diagnostics& diagnostics) {
  CellComplex& complex = body_.complex();
  if (!skips_) {
    complex.require_edges();
    complex.require_faces();
  }
  std::vector<std::vector<GivenColumn>> given = read_values();
  std::vector<std::vector<Index>> regions =
      model_regions(scene_, selector_, body_.attributes().rest_places(complex));
  for (std::size_t i = 0; i < scene_.models.size(); ++i) {
    const ModelUse& use = scene_.models[i];
    auto instance = std::make_unique<Instance>(*use.model, use.name, use.parameters, diagnostics,
                                               skips_, std::move(given[i]));
    if (use.between) regions[i] = add_lips(*instance, use);
    body_.attributes().add(std::move(instance), complex, std::move(regions[i]));
  }
  body_.compile(diagnostics, scene_.solver.threads);
}

/// The faces between two regions. Returns the elements of the first that have some.
std::vector<Index> BuiltScene::add_lips(Instance& instance, const ModelUse& use) {
  const std::string path = use.path + "/between: ";
  if (scene_.solver.sleep_acceleration > 0)
    throw InputError(path + "needs a run without sleep; remove \"sleep\" in /solver");
  const std::vector<Index> one = selector_.elements((*use.between)[0]);
  std::vector<bool> is_other(body_.complex().element_count());
  for (const Index e : selector_.elements((*use.between)[1])) is_other[e] = true;
  const auto common = std::ranges::find_if(one, [&](Index e) { return is_other[e]; });
  if (common != one.end())
    throw InputError(path + "element " + std::to_string(element_name(*common)) +
                     " is in both regions, which must have no element in common");
  instance.lips = faces_between(body_.complex(), one, is_other);
  if (instance.lips.empty())
    throw InputError(path + "no element of one region has a face in the other");
  std::vector<Index> region;
  for (const Seam& lips : instance.lips) region.push_back(element_of(lips.one));
  sort_unique(region);
  return region;
}

/// Everything that is there follows this cut, as it does one of an event.
void BuiltScene::open_lips() {
  const std::vector<Dart> faces = faces_to_open(body_.attributes());
  if (!faces.empty()) body_.cut(faces);
}

/// What the scene gives to columns of its models; the values of arrays are not needed after that.
std::vector<std::vector<GivenColumn>> BuiltScene::read_values() {
  const Column& rest = body_.attributes().rest();
  const auto place = [&](int dimension, Index cell) {
    if (dimension == 3) return place_of(cell);
    return place_text({rest.get(cell, 0), rest.get(cell, 1), rest.get(cell, 2)});
  };
  auto given = given_columns(scene_, selector_, body_, names_, place);
  for (MeshArray& array : names_.arrays) std::vector<double>().swap(array.values);
  return given;
}

void BuiltScene::add_constraints() {
  std::vector<PlacedConstraint> placed;
  for (const Constraint& constraint : scene_.constraints) {
    placed.push_back({"/constraints/" + std::to_string(placed.size()), constraint.components,
                      motion_of(constraint), selector_.vertices(constraint.where)});
  }
  check_constraints(placed, body_.attributes().rest(), [&](Index v) { return node_text(v); });
  for (std::size_t i = 0; i < placed.size(); ++i) {
    PlacedConstraint& constraint = placed[i];
    if (constraint.motion.moves())
      constraint.motion.reach = shortest_edge(constraint.vertices) / 10;
    body_.constraints().add(constraint.vertices, constraint.components, constraint.motion,
                            body_.attributes(), scene_.constraints[i].name);
  }
}

std::string BuiltScene::node_text(Index v) {
  const Column& rest = body_.attributes().rest();
  return "node " + std::to_string(names_.point_id(body_.user_vertex()[v])) + " at " +
         place_text({rest.get(v, 0), rest.get(v, 1), rest.get(v, 2)});
}

/// At rest, of the elements around these vertices, m.
double BuiltScene::shortest_edge(const std::vector<Index>& vertices) {
  double shortest = std::numeric_limits<double>::infinity();
  std::vector<Dart> star;
  for (const Index v : vertices) {
    body_.complex().star(0, v, star);
    for (const Dart d : star)
      for (const auto& [a, b] : suture_hexahedron_edges) {
        const Hexahedron& nodes = body_.complex().vertices_of(element_of(d));
        double squared = 0;
        for (int c = 0; c < 3; ++c)
          squared += std::pow(body_.attributes().rest().get(nodes[a], c) -
                                  body_.attributes().rest().get(nodes[b], c),
                              2);
        shortest = std::min(shortest, std::sqrt(squared));
      }
  }
  return shortest;
}

void BuiltScene::add_terms() {
  Attributes& attributes = body_.attributes();
  const CellComplex& complex = body_.complex();
  gravity_ = &body_.add(std::make_unique<Gravity>(attributes, scene_.gravity, scene_.gravity_ramp));
  const auto faces = [&](const Load& load) { return selector_.boundary_faces(load.where); };
  const auto triangles = [&](const Load& load) { return selector_.surface_triangles(load.where); };
  auto& dead = body_.add(std::make_unique<DeadLoads>(attributes));
  for (const Load& load : scene_.loads) {
    if (load.kind == Load::Kind::force)
      dead.add_force(complex, selector_.vertices(load.where), load.value, load.ramp);
    else if (load.kind == Load::Kind::traction && !is_embedded())
      dead.add_traction(complex, faces(load), load.value, load.ramp, load.profile);
    else if (load.kind == Load::Kind::traction)
      dead.add_surface_traction(complex, triangles(load), load.value, load.ramp, load.profile);
  }
  const auto add_pressures = [&](auto pressures, const auto& where) {
    auto& added = body_.add(std::move(pressures));
    for (const Load& load : scene_.loads)
      if (load.kind == Load::Kind::pressure)
        added.add(complex, where(load), load.pressure, load.ramp, load.profile);
  };
  if (is_embedded())
    add_pressures(std::make_unique<SurfacePressures>(attributes), triangles);
  else
    add_pressures(std::make_unique<Pressures>(attributes), faces);
  add_volumes();
  add_foundations();
}

void BuiltScene::add_foundations() {
  if (scene_.foundations.empty()) return;
  auto& foundations = body_.add(std::make_unique<Foundations>(body_.attributes()));
  for (const Foundation& given : scene_.foundations) {
    const FoundationLaw law{given.normal, given.tangential, given.damping};
    if (is_embedded())
      foundations.add(body_.complex(), selector_.surface_triangles(given.where), law);
    else
      foundations.add(body_.complex(), selector_.boundary_faces(given.where), law);
  }
}

void BuiltScene::add_volumes() {
  EnclosedVolumes* volumes = nullptr;
  for (const Load& load : scene_.loads) {
    if (load.kind != Load::Kind::volume) continue;
    if (is_embedded())
      throw InputError(load.where.path +
                       ": a \"volume\" needs whole faces of elements around it; choose a mesh, and "
                       "cuts that do not divide elements");
    if (scene_.solver.integrator == "xpbd")
      throw InputError(load.where.path +
                       ": \"xpbd\" knows stiffness of models only; choose another integrator for a "
                       "\"volume\"");
    if (volumes == nullptr)
      volumes = &body_.add(std::make_unique<EnclosedVolumes>(body_.attributes(), body_.complex()));
    volumes->add(selector_.boundary_faces(load.where), load.pressure, load.ramp, load.where.path);
  }
}

void BuiltScene::add_contact(Diagnostics& diagnostics) {
  if (!scene_.contact.is_wanted()) return;
  for (const Event& event : scene_.events)  // their obstacles would push what they cut
    if (const auto* cut = std::get_if<CutBlade>(&event.what);
        cut && cut->carried && cut->along_blade)
      scene_.contact.obstacles[cut->carried->obstacle].pushes = false;
  const ContactOptions& options = scene_.contact;
  SurfacePoints::Source embedded;  // not embedding(), which is not made again when a run resumes
  if (is_embedded())
    embedded = [this, made = Embedding()]() mutable -> const Embedding& {
      return made = Embedding(parts(), body_.complex());
    };
  Contact& contact = body_.add_contact(options.obstacles, options.thickness, std::move(embedded));
  if (options.pieces) contact.touch_pieces({options.friction, options.self});
  add_edges(contact);
  if (dynamics_->newton())
    body_.add(std::make_unique<MultiplierForces>(contact, body_.attributes(), body_.models(),
                                                 dynamics_->is_static()));
  else if (options.penalty)
    body_.add(std::make_unique<PenaltyForces>(contact, body_.attributes(), body_.models()));
  check_obstacles(*this, contact, diagnostics);
  check_pieces(*this, contact, diagnostics);
}

/// Adds the edges of the blades that the tissue resists.
void BuiltScene::add_edges(Contact& contact) {
  for (const Event& event : scene_.events) {
    const auto* blade = std::get_if<CutBlade>(&event.what);
    if (!blade || !blade->resistance) continue;
    const CutBlade::Resistance& resistance = *blade->resistance;
    CuttingEdges::HasMaterial has_material;
    if (blade->along_blade)
      has_material = [this](Index e, const Vec3& at) {
        return suture::has_material(parts(), e, at);
      };
    const CuttingEdges::Edge edge{
        blade->carried->obstacle, blade->carried->points, element_values(resistance.toughness),
        resistance.stress * resistance.thickness, std::move(has_material)};
    try {
      contact.add_edge(edge);
    } catch (const InputError& error) {
      throw InputError(event.path + "/cut/blade/points: " + error.what());
    }
  }
}

/// Returns the values of a table by element.
std::vector<double> BuiltScene::element_values(const CellValues& table) const {
  constexpr double missing = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> values(body_.complex().element_count(),
                             table.elsewhere.empty() ? missing : table.elsewhere[0]);
  for (const CellValues::Part& part : table.parts)
    for (const Index e : selector_.elements(part.region)) values[e] = part.value[0];
  const auto none_given = std::ranges::find_if(values, [](double v) { return std::isnan(v); });
  if (none_given != values.end())
    throw InputError(table.path + ": has no value for element " +
                     std::to_string(element_name(Index(none_given - values.begin()))) +
                     "; add \"elsewhere\"");
  return values;
}

std::string BuiltScene::place_of(Index e) {
  return place_text(centroid(body_.complex().vertices_of(e), body_.attributes().rest().rows(), 4));
}

std::string BuiltScene::place_text(const Vec3& local) const {
  const Vec3 p = frame_.in_scene(local);
  std::ostringstream text;
  if (!frame_.is_scene()) text.precision(10);  // the body is small beside its place
  text << '(' << p[0] << ", " << p[1] << ", " << p[2] << ") m";
  return text.str();
}

}  // namespace suture
