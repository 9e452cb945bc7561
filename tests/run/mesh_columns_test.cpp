// SPDX-License-Identifier: GPL-3.0-or-later
//
// Columns of parameters from the arrays of a mesh file.
#include <limits>

#include "kernel/base/error.hpp"
#include "tests/run/differing_values.hpp"

namespace suture::test {
namespace {

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
  Instance& instance = *built.body().attributes().instances()[0];
  const std::vector<double> found = values_of(instance, "mu", 3);
  ASSERT_EQ(found.size(), 3u);
  for (Index row = 0; row < 3; ++row)
    EXPECT_EQ(found[row],
              1.0 + static_cast<double>(built.element_name(instance.table(3).cells.cell(row))));
}

/// Two materials, of which elements 1 and 2 hold both; only material 0 has the set "a".
Mixtures two_materials() {
  return {.shares = {{1, 0, 0.75}, {1, 1, 0.25}, {2, 0, 0.25}, {2, 1, 0.75}},
          .materials = {{"a", {0}}, {"b", {1}}}};
}

TEST_F(ColumnsOfMeshes, MixturesTakeTheMeanByVolume) {
  mesh_.element_sets = {{"a", {0, 1}}, {"b", {2, 3}}};
  mesh_.mixtures = two_materials();
  CellValues& mu = use_array("mu", "");
  mu.parts = {{{Selection::Named{"a"}, ""}, {100}}, {{Selection::Named{"b"}, ""}, {200}}};
  const auto values = [&] {
    scene_.mesh.given = std::make_shared<Mesh>(mesh_);
    BuiltScene built(scene_, diagnostics_);
    return values_of(*built.body().attributes().instances()[0], "mu", 3);
  };
  EXPECT_EQ(values(), (std::vector<double>{100, 125, 175, 200}));
  mu.parts.pop_back();
  mu.elsewhere = {1000};
  EXPECT_EQ(values(), (std::vector<double>{100, 325, 775, 1000}));
  // What selects elements by place counts for all that they hold.
  mu.parts.push_back({{Selection::HalfSpace{{2, 0, 0}, {1, 0, 0}}, ""}, {500}});
  EXPECT_EQ(values(), (std::vector<double>{100, 325, 500, 500}));
  // A region may fill most of no element.
  mesh_.element_sets = {{"a", {0, 1, 2, 3}}, {"b", {}}};
  mu.parts = {{{Selection::Named{"a"}, ""}, {100}}, {{Selection::Named{"b"}, ""}, {200}}};
  EXPECT_EQ(values(), (std::vector<double>{100, 125, 175, 100}));
}

TEST_F(ColumnsOfMeshes, AModelOfOneRegionTakesTheValuesOfThisRegion) {
  mesh_.element_sets = {{"a", {0, 1}}, {"b", {2, 3}}};
  mesh_.mixtures = two_materials();
  scene_.models[0].region.what = Selection::Named{"a"};
  scene_.models.push_back(scene_.models[0]);
  scene_.models[1].name = "other";
  scene_.models[1].region.what = Selection::Named{"b"};
  CellValues& mu = use_array("mu", "");
  mu.parts = {{{Selection::Named{"a"}, ""}, {100}}};
  mu.elsewhere = {1000};
  scene_.mesh.given = std::make_shared<Mesh>(mesh_);
  BuiltScene built(scene_, diagnostics_);
  EXPECT_EQ(values_of(*built.body().attributes().instances()[0], "mu", 3),
            (std::vector<double>{100, 100}));
  mesh_.element_sets = {{"a", {0, 1, 2, 3}}, {"b", {}}};
  scene_.mesh.given = std::make_shared<Mesh>(mesh_);
  try {
    BuiltScene bad(scene_, diagnostics_);
    FAIL() << "an empty region";
  } catch (const InputError& error) {
    EXPECT_NE(
        std::string(error.what())
            .find("no element belongs to the set 'b'; it fills most of no element: use more cells"),
        std::string::npos)
        << error.what();
  }
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

}  // namespace
}  // namespace suture::test
