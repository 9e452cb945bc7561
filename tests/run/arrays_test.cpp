// SPDX-License-Identifier: GPL-3.0-or-later
//
// Parameters that differ from element to element: from arrays of the mesh and from tables.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <random>

#include "kernel/base/error.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "kernel/scene/built_scene.hpp"
#include "kernel/scene/scene_reader.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/run/beam.hpp"

namespace suture::test {
namespace {

PluginHost& host() {
  static PluginHost plugins;
  static const bool added = (plugins.add_file(TEST_PLUGINS "/fibres-of-test.so"), true);
  EXPECT_TRUE(added);
  return plugins;
}

Selection right_half() {
  Selection half;
  half.what = Selection::HalfSpace{{0.5, 0, 0}, {1, 0, 0}};
  half.path = "/right";
  return half;
}

std::uint32_t index_of(const suture_model& model, const std::string& parameter) {
  for (std::uint32_t p = 0; p < model.parameter_count; ++p)
    if (model.parameters[p].name == parameter) return p;
  throw std::logic_error("no parameter " + parameter);
}

/// Lets the model's parameter differ.
CellValues& vary(ModelUse& use, const std::string& parameter) {
  const std::uint32_t p = index_of(*use.model, parameter);
  use.parameters[p] = std::numeric_limits<double>::quiet_NaN();
  CellValues values;
  values.parameter = &use.model->parameters[p];
  values.path = "/models/0/parameters/" + parameter;
  while (use.model->attributes[values.attribute].name != parameter) ++values.attribute;
  return use.values.emplace_back(values);
}

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

/// The beam without gravity, of mu = 100 kPa; the direction of its fibres is still to be given.
Scene fibres(Index nx, Index n, double k, double element = 1) {
  Scene scene = beam(host(), "tm-faure", nx, n, 0);
  ModelUse& use = scene.models[0];
  use.model = &host().model("fibres-of-test");
  use.parameters =
      parameters(*use.model, {{"mu", 1e5}, {"k", k}, {"rho", 1000}, {"element", element}});
  return scene;
}

Scene statics(Scene scene) {
  scene.solver.integrator = "static";
  scene.solver.end = scene.solver.dt = 1;
  return scene;
}

std::vector<double> corners_after(const Scene& scene, bool skip = true) {
  Diagnostics diagnostics;
  Observer nobody;
  Simulation simulation(scene, host(), diagnostics, skip);
  simulation.run(nobody);
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
  Event cut;
  cut.at = 0.02;
  cut.what = CutPlane{{0.5, 0.125, 0.125}, {0, 1, 0}, 0.3};
  cut.path = "/events/0";
  moving.events.push_back(cut);
  for (const bool is_static : {false, true}) {
    const Scene what = is_static ? statics(scene()) : moving;
    const auto one = corners_after(with_table(what, GetParam().parameter, right, left));
    const auto two = corners_after(with_two_models(what, GetParam().parameter, right, left));
    EXPECT_LT(largest_difference(one, two), is_static ? 1e-8 : 1e-10);
    EXPECT_GT(largest_difference(one, corners_after(what)), 1e-5);
    EXPECT_EQ(one, corners_after(with_table(what, GetParam().parameter, right, left)));
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

/// A scene of a mesh file with arrays; the values of a column of its only model.
class ColumnsOfMeshes : public testing::Test {
 protected:
  ColumnsOfMeshes() : mesh_(make_box({.size = {4, 1, 1}, .cells = {4, 1, 1}})) {
    scene_ = fibres(1, 1, 0);
    scene_.mesh.box.reset();
    scene_.mesh.file = folder_ / "m.vtu";
    scene_.constraints[0].where.what = Selection::Plane{{0, 0, 0}, {1, 0, 0}, 1e-6};
    CellValues& fibre = vary(scene_.models[0], "fibre");
    fibre.elsewhere = {0, 3, 4};
  }
  void add(const std::string& name, bool of_elements, std::size_t components,
           const std::function<double(const Vec3&, std::size_t)>& value) {
    MeshArray array{name, of_elements, components, {}, {}};
    for (std::size_t i = 0; i < (of_elements ? mesh_.hexahedra.size() : mesh_.points.size()); ++i)
      for (std::size_t c = 0; c < components; ++c)
        array.values.push_back(value(mesh_.points[of_elements ? mesh_.hexahedra[i][0] : i], c));
    mesh_.arrays.push_back(array);
  }
  CellValues& use_array(const std::string& parameter, const std::string& array) {
    auto& uses = scene_.models[0].values;
    if (parameter == "fibre") uses.clear();
    CellValues& values = vary(scene_.models[0], parameter);
    values.array = array;
    return values;
  }
  std::vector<double> column(const std::string& name, int dimension = 3) {
    write_mesh(scene_.mesh.file, mesh_, diagnostics_);
    BuiltScene built(scene_, diagnostics_);
    return values_of(*built.body().attributes().instances()[0], name, dimension);
  }
  /// By element, node or edge of the complex.
  static std::vector<double> values_of(Instance& instance, const std::string& name, int dimension) {
    const Column& found = *instance.table(dimension).find(name);
    const CellSet& cells = instance.table(dimension).cells;
    std::vector<double> values;
    for (Index cell = 0; cell < cells.size(); ++cell)
      for (int c = 0; c < found.spec().components; ++c)
        values.push_back(found.get(cells.row(cell), c));
    return values;
  }
  std::string error() {
    try {
      column("mu");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  const TemporaryFolder folder_;
  Diagnostics diagnostics_;
  Mesh mesh_;
  Scene scene_;
};

TEST_F(ColumnsOfMeshes, PointsGiveTheMeanOfTheirElement) {
  add("m", false, 1, [](const Vec3& x, std::size_t) { return 1 + x[0]; });
  use_array("mu", "m").scale = 10;
  EXPECT_EQ(column("mu"), (std::vector<double>{15, 25, 35, 45}));
}

TEST_F(ColumnsOfMeshes, DirectionsHaveLengthOne) {
  EXPECT_EQ(column("fibre"), (std::vector<double>{0, .6, .8, 0, .6, .8, 0, .6, .8, 0, .6, .8}));
  add("f", true, 3, [](const Vec3& x, std::size_t c) { return c == 2 ? -1 - x[0] : 0.0; });
  use_array("fibre", "f");
  EXPECT_EQ(column("fibre"), (std::vector<double>{0, 0, -1, 0, 0, -1, 0, 0, -1, 0, 0, -1}));
}

TEST_F(ColumnsOfMeshes, ElementsLeftOutTakeTheirValuesWithThem) {
  add("m", true, 1, [](const Vec3& x, std::size_t) { return 1 + x[0]; });
  use_array("mu", "m");
  scene_.mesh.drop_bad_elements = true;
  mesh_.hexahedra[3][1] = mesh_.hexahedra[3][0];
  write_mesh(scene_.mesh.file, mesh_, diagnostics_);
  BuiltScene built(scene_, diagnostics_);
  const Instance& instance = *built.body().attributes().instances()[0];
  ASSERT_EQ(instance.table(3).cells.size(), 3u);
  for (Index row = 0; row < 3; ++row)
    EXPECT_EQ(instance.column(instance.model().attribute_count - 4)->get(row, 0),
              1.0 + static_cast<double>(built.element_name(instance.table(3).cells.cell(row))));
}

TEST_F(ColumnsOfMeshes, MistakesNameTheirPlace) {
  add("modulus", true, 1, [](const Vec3& x, std::size_t) { return x[0] - 1; });
  add("hole", true, 1, [](const Vec3& x, std::size_t) {
    return x[0] == 2 ? std::numeric_limits<double>::quiet_NaN() : 1;
  });
  add("u", false, 3, [](const Vec3&, std::size_t) { return 0.0; });
  const std::string path = "/models/0/parameters/mu: ";
  CellValues& mu = use_array("mu", "modulu");
  EXPECT_EQ(error(), path +
                         "the mesh has no array 'modulu' (did you mean 'modulus'?); it has 'u' "
                         "(points, 3 components), 'modulus' (elements), 'hole' (elements)");
  mu.array = "u";
  EXPECT_EQ(error(),
            path + "array 'u' has 3 components, but 'mu' has 1; save an array with that many");
  mu.array = "modulus";
  EXPECT_EQ(error(), path +
                         "array 'modulus': element 0 at (0.5, 0.5, 0.5) m has the value -1 Pa; it "
                         "must be > 0 Pa (2 elements in all)");
  mu.array = "hole";
  EXPECT_EQ(error(),
            path +
                "array 'hole': element 2 at (2.5, 0.5, 0.5) m has no value (nan); a finite "
                "number is expected");
  mu.array.clear();
  mu.parts = {{right_half(), {1e5}}};
  mu.parts[0].region.what = Selection::HalfSpace{{3, 0, 0}, {1, 0, 0}};
  EXPECT_EQ(error(), path +
                         "element 0 at (0.5, 0.5, 0.5) m is in no region; add one, or give the "
                         "value \"elsewhere\" (3 elements in all)");
  mu.elsewhere = {1e5};
  EXPECT_EQ(error(), "");
  use_array("fibre", "u");
  scene_.models[0].parameters[0] = 1e5;
  EXPECT_EQ(error(),
            "/models/0/parameters/fibre: array 'u': element 0 at (0.5, 0.5, 0.5) m has a "
            "direction of length 0; a vector of any other length is expected (4 elements in "
            "all)");
  mesh_.arrays.clear();
  EXPECT_EQ(error(),
            "/models/0/parameters/fibre: there is no array 'u': the mesh has no arrays; use a "
            ".vtu, .vtk or .msh file that has them, or a table {\"regions\": ...}");
}

// --------------------------------------------------------- starts, contributions --

/// The bed of springs of fibres.cpp on the mesh of four elements, from the text of a scene.
class Beds : public ColumnsOfMeshes {
 protected:
  /// `use`: members of the model besides its id, `more`: members of the scene.
  Scene bed(const std::string& use, const std::string& more = "") {
    write_mesh(folder_ / "m.vtu", mesh_, diagnostics_);
    std::ofstream(folder_ / "s.json")
        << R"({"suture": 1, "mesh": {"file": "m.vtu"}, "gravity": [0, 0, 0],
               "models": [{"model": "tm-faure", "parameters": {"E": 1, "nu": 0, "rho": 8}},
                          {"model": "bed-of-test", )"
        << use << R"(}], "solver": {"integrator": "symplectic-euler", "dt": 0.125, "end": 0.5}, )"
        << more << R"("output": {"directory": "out"}})";
    return read_scene(folder_ / "s.json", {}, host(), diagnostics_);
  }
  /// By element, edge or point of the mesh.
  std::vector<double> start(const std::string& use, const std::string& name, int dimension) {
    BuiltScene built(bed(R"("parameters": {"b": 8, "rate": 0}, "start": )" + use), diagnostics_);
    auto values = values_of(*built.body().attributes().instances()[1], name, dimension);
    if (dimension != 0) return values;
    const std::vector<double> by_vertex = values;
    const std::size_t n = values.size() / mesh_.points.size();
    for (std::size_t i = 0; i < values.size(); ++i)
      values[built.body().user_vertex()[i / n] * n + i % n] = by_vertex[i];
    return values;
  }
  std::string mistake(const std::string& use) {
    try {
      start(use, "charge", 0);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(Beds, AttributesStartFromNumbersTablesAndArrays) {
  add("m", true, 1, [](const Vec3& x, std::size_t) { return 10 + x[0]; });
  add("q", false, 1, [](const Vec3& x, std::size_t) { return x[0] - 1; });
  add("p", false, 3, [](const Vec3& x, std::size_t c) { return c == 1 ? x[0] : 0; });
  using Values = std::vector<double>;
  EXPECT_EQ(start("{}", "wear", 3), Values(4, 0.5));
  EXPECT_EQ(start(R"({"wear": 2})", "wear", 3), Values(4, 2));
  EXPECT_EQ(start(R"({"wear": {"array": "m", "scale": 2}})", "wear", 3), (Values{20, 22, 24, 26}));
  EXPECT_EQ(start(R"({"wear": {"array": "q"}})", "wear", 3), (Values{-0.5, 0.5, 1.5, 2.5}));
  const char* const two = R"({"wear": {"regions": [{"region": {"ids": [1, 2]}, "value": 7},
                                                   {"region": {"ids": [2]}, "value": 8}],
                                       "elsewhere": 1}})";
  EXPECT_EQ(start(two, "wear", 3), (Values{1, 7, 8, 1}));
  EXPECT_EQ(start(R"({"flaw": -3})", "flaw", 1), Values(36, -3));
  EXPECT_EQ(start("{}", "charge", 0), Values(20, 0));
  for (std::size_t v = 0; const double q : start(R"({"charge": {"array": "q"}})", "charge", 0))
    EXPECT_EQ(q, double(v++ % 5) - 1);
  for (std::size_t i = 0; const double p : start(R"({"push": {"array": "p"}})", "push", 0)) {
    EXPECT_EQ(p, i % 3 == 1 ? double(i / 3 % 5) : 0);
    ++i;
  }
  const char* const side = R"({"charge": {"regions": [{"region": {"plane": {"point": [4, 0, 0],
                               "normal": [1, 0, 0]}}, "value": 3}], "elsewhere": 0}})";
  for (std::size_t v = 0; const double q : start(side, "charge", 0))
    EXPECT_EQ(q, v++ % 5 == 4 ? 3 : 0);
}

TEST_F(Beds, MistakesInStartsNameTheirPlace) {
  add("m", true, 1, [](const Vec3& x, std::size_t) { return x[0]; });
  add("hole", false, 1, [](const Vec3& x, std::size_t) {
    return x[0] == 2 ? std::numeric_limits<double>::quiet_NaN() : 1;
  });
  const std::string path = "/models/1/start/";
  EXPECT_EQ(mistake(R"({"charge": {"array": "m"}})"),
            path +
                "charge: array 'm' belongs to elements, but 'charge' belongs to nodes; save it as "
                "point data");
  EXPECT_EQ(mistake(R"({"push": {"array": "hole"}})"),
            path +
                "push: array 'hole' has 1 component, but 'push' has 3; save an array with that "
                "many");
  EXPECT_EQ(mistake(R"({"charge": {"array": "hole"}})"),
            path +
                "charge: array 'hole': node 2 at (2, 0, 0) m has no value (nan); a finite number "
                "is expected (4 nodes in all)");
  const auto says = [&](const char* use, const char* words) {
    EXPECT_NE(mistake(use).find(words), std::string::npos) << mistake(use);
  };
  says(R"({"flaw": {"array": "m"}})",
       "/models/1/start/flaw: must be one value: arrays and regions are of nodes and elements");
  says(R"({"push": 3})", "/models/1/start/push: must be 3 numbers [...], is the number 3");
  says(R"({"bed": 3})", "/models/1/start/bed: unknown key");
  says(R"({"wera": 3})", "did you mean 'wear'?");
}

// The state goes on from its start, at the rate of each element.
TEST_F(Beds, AStateGoesOnFromItsStart) {
  add("m", true, 1, [](const Vec3& x, std::size_t) { return 10 + x[0]; });
  Observer nobody;
  Simulation simulation(bed(R"("parameters": {"b": 8, "rate": {"regions": [
                              {"region": {"ids": [3]}, "value": 4}], "elsewhere": 0}},
                              "start": {"wear": {"array": "m"}})"),
                        host(), diagnostics_);
  simulation.run(nobody);
  EXPECT_EQ(values_of(*simulation.attributes().instances()[1], "wear", 3),
            (std::vector<double>{10, 11, 12, 15}));
}

// b V / 8 from each element around a node, before and after a cut between the second and the third.
TEST_F(Beds, ContributionsReadTheParametersOfTheirElement) {
  add("b", true, 1, [](const Vec3& x, std::size_t) { return 8 * (1 + x[0]); });
  EXPECT_EQ(start("{}", "bed", 0).front(), 1);
  const char* const of_array = R"("parameters": {"b": {"array": "b"}, "rate": 0})";
  for (const bool cut : {false, true}) {
    Observer nobody;
    Simulation simulation(
        bed(of_array, cut ? R"("events": [{"at": 0.25, "cut": {"plane": {"point": [2, 0.5, 0.5],
                               "normal": [1, 0, 0]}}}], )"
                          : ""),
        host(), diagnostics_);
    simulation.run(nobody);
    std::map<double, std::size_t> count;
    for (const double b : values_of(*simulation.attributes().instances()[1], "bed", 0)) ++count[b];
    const std::map<double, std::size_t> whole{{1, 4}, {3, 4}, {5, 4}, {7, 4}, {4, 4}};
    const std::map<double, std::size_t> parted{{1, 4}, {3, 8}, {2, 4}, {4, 4}, {7, 4}};
    EXPECT_EQ(count, cut ? parted : whole) << cut;
  }
}

// ------------------------------------------------------------------------ fibres --

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
      Diagnostics diagnostics;
      Observer nobody;
      Simulation simulation(scene, host(), diagnostics);
      simulation.run(nobody);
      EXPECT_NEAR(simulation.mean_displacement(load.where)[0], stretch - 1, 1e-7)
          << element << ' ' << along;
    }
}

}  // namespace
}  // namespace suture::test
