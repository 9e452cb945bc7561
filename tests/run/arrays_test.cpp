// SPDX-License-Identifier: GPL-3.0-or-later
//
// Parameters that differ from element to element: from arrays of the mesh and from tables.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "kernel/mesh/box.hpp"
#include "kernel/results/fields.hpp"
#include "kernel/results/stress_groups.hpp"
#include "tests/run/differing_values.hpp"
#include "tests/run/events.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test {
namespace {

/// One entry with a table: the value on the right, another elsewhere.
Scene with_table(Scene scene, const std::string& parameter, double right, double left) {
  CellValues& values = vary(scene.models[0], parameter);
  values.parts = {{right_half(), {right}}};
  values.elsewhere = {left};
  return scene;
}

/// The same by two entries with regions.
Scene with_two_models(Scene scene, const std::string& parameter, double right, double left) {
  ModelUse other = scene.models[0];
  other.name = "right";
  other.region = right_half();
  const std::uint32_t p = index_of(*other.model, parameter);
  scene.models[0].parameters[p] = left;
  other.parameters[p] = right;
  scene.models[0].region.what = Selection::HalfSpace{{0.499, 0, 0}, {-1, 0, 0}};
  scene.models[0].region.path = "/left";
  scene.models.push_back(other);
  return scene;
}

std::vector<double> corners_after(const Scene& scene, bool skip = true) {
  TestSimulation simulation(scene, skip);
  simulation.run();
  std::vector<double> corners;
  for (const Hexahedron& nodes : simulation.complex().vertices())
    for (const Index v : nodes)
      for (int c = 0; c < 3; ++c) corners.push_back(simulation.attributes().position().get(v, c));
  return corners;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

struct Varied {
  const char *name, *model, *parameter;
  double element;  ///< 0 trilinear, 1 mean-gradient; < 0: the model has none
};
void PrintTo(const Varied& varied, std::ostream* out) { *out << varied.name; }

class Arrays : public testing::TestWithParam<Varied> {
 protected:
  static Scene scene(Index n = 2) {
    std::map<std::string, double> values;
    if (GetParam().element >= 0) values["element"] = GetParam().element;
    return beam(host(), GetParam().model, 4 * n, n, 2, values);
  }
  static std::pair<double, double> values() {
    return std::string(GetParam().parameter) == "nu" ? std::pair(0.1, 0.4)
           : GetParam().parameter[0] == 'E'          ? std::pair(8e5, 3e5)
                                                     : std::pair(2000.0, 500.0);
  }
};

INSTANTIATE_TEST_SUITE_P(Run, Arrays,
                         testing::Values(Varied{"Trilinear", "tm-faure", "E", 0},
                                         Varied{"Mean", "tm-faure", "E", 1},
                                         Varied{"TrilinearNu", "tm-faure", "nu", 0},
                                         Varied{"MeanNu", "tm-faure", "nu", 1},
                                         Varied{"Mass", "tm-faure", "rho", 1},
                                         Varied{"Springs", "mss-baudet", "E", -1},
                                         Varied{"SpringMass", "mss-baudet", "rho", -1}),
                         [](const auto& test) { return test.param.name; });

// The sums at the nodes between the halves have another order.
TEST_P(Arrays, ATableGivesWhatTwoModelsGive) {
  const auto [right, left] = values();
  Scene moving = scene();
  moving.solver.end = 0.05;
  moving.events.push_back(event_of(CutPlane{{0.5, 0.125, 0.125}, {0, 1, 0}, 0.3}, 0.02));
  for (const bool is_static : {false, true}) {
    const Scene what = is_static ? statics(scene()) : moving;
    const auto one = corners_after(with_table(what, GetParam().parameter, right, left));
    const auto two = corners_after(with_two_models(what, GetParam().parameter, right, left));
    EXPECT_LT(largest_difference(one, two), is_static ? 1e-8 : 1e-10);
    EXPECT_GT(largest_difference(one, corners_after(what)), 1e-5);
    EXPECT_EQ(one, corners_after(with_table(what, GetParam().parameter, right, left)));
  }
}

/// The nodal stress of a beam whose nodes were moved, sheared and bent.
std::vector<double> nodal_stress_of(Scene scene) {
  Diagnostics diagnostics;
  BuiltScene built(scene, diagnostics);
  Attributes& attributes = built.body().attributes();
  for (Index v = 0; v < attributes.rest().size(); ++v) {
    const double x = attributes.rest().get(v, 0), y = attributes.rest().get(v, 1);
    for (const auto& [c, shift] : {std::pair(0, 0.02 * x + 0.05 * x * y), {1, 0.1 * x * x}})
      attributes.position().set(v, c, attributes.rest().get(v, c) + shift);
  }
  std::vector<FrameField> fields;
  const FieldChoice choice = field_named(all_fields(built), "nodal_stress", "");
  fill_fields({choice}, choice.on, {built, {}, 0}, fields);
  return fields.at(0).values;
}

// Stress jumps with the parameters, and a fit across the jump would be right on neither side.
TEST(NodalStressOfATable, IsThatOfTwoModelsOnBothSidesOfAJump) {
  for (const auto& [parameter, right, left] :
       {std::tuple("E", 3e5, 1e3), {"E", 1e3, 3e5}, {"E", 3e5, 2.4e5}, {"nu", 0.1, 0.4}}) {
    const Scene scene = beam(host(), "tm-faure", 8, 2, 2);
    const auto one = nodal_stress_of(with_table(scene, parameter, right, left));
    const auto two = nodal_stress_of(with_two_models(scene, parameter, right, left));
    EXPECT_LT(largest_difference(one, two), 1e-6) << parameter << ' ' << right;
  }
}

// A field that is smooth is not cut into single elements, however much it differs in all.
TEST(StressGroups, AreOneWhereParametersAreSmooth) {
  for (const double ratio : {1.05, 1.3, 1.9}) {
    Scene scene = beam(host(), "tm-faure", 8, 2, 2);
    CellValues& values = vary(scene.models[0], "E");
    for (int i = 0; i < 8; ++i) {
      Selection slab;
      slab.what = Selection::InBox{{(i - 0.01) / 8, -1, -1}, {(i + 1.01) / 8, 2, 2}};
      slab.path = "/slab";
      values.parts.push_back({slab, {1e5 * std::pow(ratio, i)}});
    }
    Diagnostics diagnostics;
    BuiltScene built(scene, diagnostics);
    const CellComplex& complex = built.body().complex();
    const std::vector<double> stress(std::size_t{6} * complex.element_count());
    for (const Index group : stress_groups(complex, built.body().attributes(), stress,
                                           ShownCells(complex.element_count())))
      EXPECT_EQ(group, 0u) << ratio;
  }
}

TEST_P(Arrays, EqualValuesGiveTheBitsOfOneNumber) {
  Scene moving = scene();
  moving.solver.end = 0.02;
  const double value =
      moving.models[0].parameters[index_of(*moving.models[0].model, GetParam().parameter)];
  const Scene table = with_table(moving, GetParam().parameter, value, value);
  EXPECT_EQ(corners_after(table), corners_after(moving));
  EXPECT_EQ(corners_after(table, false), corners_after(moving));
}

// Two springs in series, of nu = 0 and small strain.
TEST(ArraysOfMeshes, ABarOfTwoMaterialsIsTwoSpringsInSeries) {
  const TemporaryFolder folder;
  Mesh mesh = make_box({{0, 0, 0}, {1, 0.25, 0.25}, {8, 2, 2}, {1, 1, 1}});
  mesh.arrays = {{"modulus", true, 1, {}, {}}};
  for (const Hexahedron& nodes : mesh.hexahedra)
    mesh.arrays[0].values.push_back(mesh.points[nodes[0]][0] < 0.49 ? 400 : 100);
  std::mt19937 random(7);
  std::vector<std::size_t> order(mesh.hexahedra.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::shuffle(order, random);
  Mesh shuffled = mesh;
  for (std::size_t i = 0; i < order.size(); ++i) {
    shuffled.hexahedra[i] = mesh.hexahedra[order[i]];
    shuffled.arrays[0].values[i] = mesh.arrays[0].values[order[i]];
  }
  Diagnostics diagnostics;
  for (const char* name : {"m.vtu", "m.vtk", "m.msh"}) {
    write_mesh(folder / name, shuffled, diagnostics);
    Scene scene = statics(beam(host(), "tm-faure", 1, 1, 0, {{"nu", 0}}));
    scene.mesh.box.reset();
    scene.mesh.file = folder / name;
    scene.constraints[0].where.what = Selection::Plane{{0, 0, 0}, {1, 0, 0}, 1e-6};
    CellValues& values = vary(scene.models[0], "E");
    values.array = "modulus";
    values.scale = 1e3;
    Load load;
    load.value = {0.01, 0, 0};  // Pa
    load.kind = Load::Kind::traction;
    load.where.what = Selection::Plane{{1, 0, 0}, {1, 0, 0}, 1e-6};
    scene.loads.push_back(load);
    Observer nobody;
    Simulation simulation(scene, host(), diagnostics);
    simulation.run(nobody);
    const double expected = 0.01 * (0.5 / 400e3 + 0.5 / 100e3);
    EXPECT_NEAR(simulation.mean_displacement(load.where)[0], expected, 1e-5 * expected) << name;
  }
}

// Uniaxial stretch of a cube whose fibres lie along it, or across it: P = dW/dstretch.
TEST(ArraysOfMeshes, ALawReadsTheFibresOfItsElement) {
  for (const double element : {0.0, 1.0})
    for (const bool along : {true, false}) {
      Scene scene = statics(fibres(2, 2, 3e5, element));
      CellValues& fibre = vary(scene.models[0], "fibre");
      fibre.elsewhere = along ? std::vector<double>{2, 0, 0} : std::vector<double>{0, 0, 1};
      scene.constraints.clear();  // symmetry planes and walls: only the stretch along x remains
      for (int a = 0; a < 3; ++a) {
        Constraint plane;
        plane.components = static_cast<std::uint8_t>(1 << a);
        Vec3 normal{};
        normal[static_cast<std::size_t>(a)] = 1;
        plane.where.what = Selection::Plane{{0, 0, 0}, normal, 1e-6};
        scene.constraints.push_back(plane);
      }
      for (int a = 1; a < 3; ++a) {
        Constraint wall = scene.constraints[static_cast<std::size_t>(a)];
        std::get<Selection::Plane>(wall.where.what).point = {1, 0.25, 0.25};
        scene.constraints.push_back(wall);
      }
      Load load;
      load.kind = Load::Kind::traction;
      load.where.what = Selection::Plane{{1, 0, 0}, {1, 0, 0}, 1e-6};
      const double stretch = 1.1;
      // dW/ds = mu (s - 1/s) + k (s^2 - 1) s
      load.value = {
          1e5 * (stretch - 1 / stretch) + (along ? 3e5 * (stretch * stretch - 1) * stretch : 0), 0,
          0};
      scene.loads.push_back(load);
      TestSimulation simulation(scene);
      simulation.run();
      EXPECT_NEAR(simulation.mean_displacement(load.where)[0], stretch - 1, 1e-7)
          << element << ' ' << along;
    }
}

}  // namespace
}  // namespace suture::test
