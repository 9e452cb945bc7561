// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/run/contact_scenes.hpp"

#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/build/built_scene.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test {

Obstacle floor_at(double height, double friction) {
  return {"floor", "/contact/obstacles/0", HalfSpace{{0, 0, height}, {0, 0, 1}}, {}, friction};
}

Scene block_on_floor(Index n, const Vec3& gravity, double friction, double young) {
  Scene scene = beam(host(), "tm-faure", 1, 1, 0, {{"E", young}});
  scene.mesh.box = BoxOptions{{0, 0, 0}, {0.4, 0.4, 0.2}, {2 * n, 2 * n, n}, {1, 1, 1}};
  scene.constraints.clear();
  scene.gravity = gravity;
  scene.contact.obstacles = {floor_at(0, friction)};
  return scene;
}

Vec3 on_slope(double friction, double part) {
  const double angle = part * std::atan(friction);
  return {9.81 * std::sin(angle), 0, -9.81 * std::cos(angle)};
}

double sliding_speed(double friction, double part, double damping) {
  const double angle = part * std::atan(friction);
  return 9.81 * (std::sin(angle) - friction * std::cos(angle)) / damping;
}

double mean_x(Simulation& simulation) {
  Attributes& a = simulation.attributes();
  double sum = 0;
  for (Index v = 0; v < a.vertex_count(); ++v) sum += a.position().get(v, 0) - a.rest().get(v, 0);
  return sum / a.vertex_count();
}

void find_equilibrium(Scene& scene, double end) {
  scene.solver.integrator = "static";
  scene.solver.dt = scene.solver.end = end;
}

std::string error_of(Simulation& simulation) {
  Observer nobody;
  try {
    simulation.run(nobody);
  } catch (const NumericalError& error) {
    return error.what();
  }
  return "";
}

std::vector<double> position_rows(Simulation& simulation) {
  const Column& x = simulation.attributes().position();
  return {x.rows(), x.rows() + 4 * std::size_t{x.size()}};
}

std::vector<double> after_steps(Simulation& simulation, int steps, double dt) {
  Dynamics& dynamics = simulation.built().dynamics();
  const double time = dynamics.time();
  for (int i = 1; i <= steps; ++i) dynamics.step(dt, time + dt * i);
  std::vector<double> all = position_rows(simulation);
  all.push_back(simulation.contact()->friction_work());
  all.push_back(dynamics.balance().work("contact"));
  return all;
}

void use_boxes(Scene& scene, const TemporaryFolder& folder, const std::vector<BoxOptions>& boxes) {
  Mesh mesh;
  for (const BoxOptions& options : boxes) {
    const Mesh box = make_box(options);
    const auto first = static_cast<Index>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), box.points.begin(), box.points.end());
    for (Hexahedron hexahedron : box.hexahedra) {
      for (Index& node : hexahedron) node += first;
      mesh.hexahedra.push_back(hexahedron);
    }
  }
  Diagnostics diagnostics;
  scene.mesh.file = folder.path() / "boxes.vtk";
  scene.mesh.box.reset();
  write_mesh(scene.mesh.file, mesh, diagnostics);
}

Scene bent_u(bool self) {
  Scene scene = beam(host(), "tm-faure", 1, 1, 0, {{"E", 1e5}});
  scene.mesh.box.reset();
  scene.mesh.voxels =
      VoxelOptions{.size = 0.05,
                   .layers = 2,
                   .rows = {"########", "########", "##......", "########", "########"}};
  Constraint pressed;
  pressed.where.what = Selection::InBox{{0.39, 0.24, -1}, {0.41, 0.26, 1}};
  pressed.components = 2;
  pressed.translation = {0, -0.075, 0};
  pressed.ramp = {0, 0.5, true};
  pressed.moves = true;
  scene.constraints.push_back(pressed);
  scene.contact.pieces = scene.contact.self = self;
  scene.contact.obstacles.push_back(floor_at(-10, 0));
  scene.solver.damping = 5;
  scene.solver.end = 0.8;
  return scene;
}

double slot_of(const Scene& scene) {
  TestSimulation simulation(scene);
  simulation.run();
  double upper = 1, lower = -1;
  Attributes& a = simulation.attributes();
  for (Index v = 0; v < a.vertex_count(); ++v) {
    if (a.rest().get(v, 0) < 0.4 - 1e-9) continue;
    const double height = a.rest().get(v, 1);
    if (std::abs(height - 0.15) < 1e-9) upper = std::min(upper, a.position().get(v, 1));
    if (std::abs(height - 0.1) < 1e-9) lower = std::max(lower, a.position().get(v, 1));
  }
  return upper - lower;
}

Scene hertz(Index n) {
  const double radius = 0.1, E = 1e5, nu = 0.3, depth = 0.01;
  Scene scene = beam(host(), "tm-faure", 1, 1, 0, {{"E", E}, {"nu", nu}});
  scene.mesh.box = BoxOptions{
      {0, 0, -8 * radius}, {4 * radius, 4 * radius, 8 * radius}, {4 * n, 4 * n, 8 * n}, {1, 1, 1}};
  scene.constraints.clear();
  for (const auto& [side, bits] : {std::pair{"x0", 1}, {"y0", 2}, {"z0", 4}}) {
    Constraint& fix = scene.constraints.emplace_back();
    fix.where.what = Selection::Named{side};
    fix.components = static_cast<std::uint8_t>(bits);
  }
  Obstacle ball{"ball", "/contact/obstacles/0", Sphere{{0, 0, 1}, 1}};
  ball.motion.stations = {{0, {}, 0}, {0.2, {0, 0, -depth}, 0}};
  scene.contact.obstacles = {ball};
  return scene;
}

double over_hertz(const Scene& scene) {
  TestSimulation simulation(scene);
  simulation.run();
  const double hertz = 4. / 3 * 1e5 / (1 - 0.3 * 0.3) * std::pow(0.01, 1.5);
  return 4 * simulation.contact()->loads()[0].force[2] / hertz;
}

}  // namespace suture::test
