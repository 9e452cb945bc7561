// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/mesh/vtk_files.hpp"

namespace suture {
namespace {

// A box with coordinates of all sizes, sets that overlap, and ids with gaps.
Mesh random_mesh(std::mt19937_64& random) {
  Mesh mesh = make_box({.cells = {3, 4, 5}});
  std::normal_distribution<double> normal;
  for (Vec3& x : mesh.points) x = {normal(random), 1e-300 * normal(random), 1e17 * normal(random)};
  for (Index e = 0; e < 60; ++e) {
    if (e % 2 == 0) mesh.element_sets["even ones"].push_back(e);
    if (e >= 30) mesh.element_sets["100 % upper \"half\""].push_back(e);
  }
  for (std::uint64_t i = 0; i < mesh.points.size(); ++i) mesh.point_ids.push_back(1000 + 3 * i);
  for (std::uint64_t e = 0; e < 60; ++e) mesh.element_ids.push_back(7'000'000'000 + e * e);
  mesh.arrays = {
      {"modulus", true, 1, {}, {}}, {"fibre 100 %", true, 3, {}, {}}, {"u", false, 3, {}, {}}};
  for (MeshArray& array : mesh.arrays) {
    array.values.resize(array.components * (array.of_elements ? 60 : mesh.points.size()));
    for (double& x : array.values) x = normal(random) * 1e200;
  }
  return mesh;
}

/// Name -> values, by the ids of points and elements.
std::map<std::string, std::map<std::uint64_t, std::vector<double>>> arrays_of(const Mesh& mesh) {
  std::map<std::string, std::map<std::uint64_t, std::vector<double>>> result;
  for (const MeshArray& array : mesh.arrays) {
    const auto& ids = array.of_elements ? mesh.element_ids : mesh.point_ids;
    auto& values = result[(array.of_elements ? "elements " : "points ") + array.name];
    for (std::size_t i = 0; i < array.values.size() / array.components; ++i)
      values[ids[i]].assign(&array.values[array.components * i],
                            &array.values[array.components * i] + array.components);
  }
  return result;
}

class RoundTrip : public testing::Test {
 protected:
  RoundTrip() : seed_(std::random_device{}()), random_(seed_), mesh_(random_mesh(random_)) {
    RecordProperty("seed", std::to_string(seed_));
  }
  Mesh back(const std::string& name) {
    write_mesh(folder_ / name, mesh_, diagnostics_);
    return read_mesh(folder_ / name, 1, diagnostics_, all_arrays);
  }
  const unsigned seed_;
  std::mt19937_64 random_;
  Mesh mesh_;
  const TemporaryFolder folder_;
  Diagnostics diagnostics_;
};

TEST_F(RoundTrip, VtkFormatsKeepEverything) {
  for (const char* name : {"m.vtu", "m.vtk"}) {
    SCOPED_TRACE(std::string(name) + ", seed " + std::to_string(seed_));
    const Mesh read = back(name);
    EXPECT_EQ(read.points, mesh_.points);
    EXPECT_EQ(read.hexahedra, mesh_.hexahedra);
    EXPECT_EQ(read.point_sets, mesh_.point_sets);
    EXPECT_EQ(read.element_sets, mesh_.element_sets);
    EXPECT_EQ(read.point_ids, mesh_.point_ids);
    EXPECT_EQ(read.element_ids, mesh_.element_ids);
    EXPECT_EQ(arrays_of(read), arrays_of(mesh_));
    EXPECT_TRUE(diagnostics_.warnings().empty());
  }
}

// Frames of a run hold many, and nan.
TEST_F(RoundTrip, ArraysAreListedAndReadOnlyIfWanted) {
  mesh_.arrays[0].values[7] = std::numeric_limits<double>::quiet_NaN();
  for (const char* name : {"m.vtu", "m.vtk", "m.msh"}) {
    SCOPED_TRACE(name);
    write_mesh(folder_ / name, mesh_, diagnostics_);
    const Mesh read = read_mesh(folder_ / name, 1, diagnostics_,
                                [](const std::string& array) { return array == "modulus"; });
    ASSERT_EQ(read.arrays.size(), 3u);
    for (const MeshArray& array : read.arrays) {
      const bool wanted = array.name == "modulus";
      EXPECT_EQ(array.values.size(), wanted ? 60u : 0u) << array.name;
      EXPECT_EQ(array.components, wanted ? 1u : 3u) << array.name;
      EXPECT_EQ(array.of_elements, array.name != "u");
      EXPECT_EQ(std::ranges::count_if(array.values, [](double x) { return std::isnan(x); }),
                wanted ? 1 : 0);
    }
  }
}

TEST_F(RoundTrip, GmshKeepsSetsAndIds) {
  SCOPED_TRACE("seed " + std::to_string(seed_));
  const Mesh read = back("m.msh");
  EXPECT_EQ(read.points, mesh_.points);
  EXPECT_EQ(read.point_ids, mesh_.point_ids);
  EXPECT_EQ(read.point_sets, mesh_.point_sets);
  // One volume per combination of sets: the elements come in another order.
  std::map<std::uint64_t, Hexahedron> expected, found;
  for (std::size_t e = 0; e < 60; ++e) {
    expected[mesh_.element_ids[e]] = mesh_.hexahedra[e];
    found[read.element_ids[e]] = read.hexahedra[e];
  }
  EXPECT_EQ(found, expected);
  EXPECT_EQ(arrays_of(read), arrays_of(mesh_));
  const auto ids_of = [](const Mesh& mesh, const std::string& set) {
    std::vector<std::uint64_t> ids;
    for (const Index e : mesh.element_sets.at(set)) ids.push_back(mesh.element_ids[e]);
    std::sort(ids.begin(), ids.end());
    return ids;
  };
  EXPECT_EQ(ids_of(read, "even ones"), ids_of(mesh_, "even ones"));
  EXPECT_EQ(ids_of(read, "100 % upper 'half'"), ids_of(mesh_, "100 % upper \"half\""));
}

// Gmsh refuses a file in which two elements have one tag.
TEST_F(RoundTrip, GmshElementsHaveTagsOfTheirOwn) {
  write_mesh(folder_ / "m.msh", mesh_, diagnostics_);
  std::istringstream text(read_text(folder_ / "m.msh"));
  std::string line;
  while (std::getline(text, line) && line != "$Elements") {
  }
  std::size_t blocks = 0, count = 0, least = 0, most = 0;
  text >> blocks >> count >> least >> most;
  std::set<std::size_t> tags;
  for (std::size_t b = 0; b < blocks; ++b) {
    std::size_t dimension = 0, entity = 0, type = 0, n = 0;
    text >> dimension >> entity >> type >> n;
    for (std::size_t i = 0; i < n; ++i) {
      std::size_t tag = 0, node = 0;
      text >> tag;
      for (int k = type == 5 ? 8 : 1; k > 0; --k) text >> node;
      EXPECT_TRUE(tags.insert(tag).second) << "tag " << tag;
    }
  }
  EXPECT_EQ(tags.size(), count);
  EXPECT_GT(count, 60u);
  EXPECT_EQ(*tags.begin(), least);
  EXPECT_EQ(*tags.rbegin(), most);
}

TEST_F(RoundTrip, MeditKeepsOneSetEachAndWarns) {
  SCOPED_TRACE("seed " + std::to_string(seed_));
  mesh_.point_sets = {{"ref 9", {0, 1}}, {"tip", {5}}, {"touches tip", {4, 5}}};
  mesh_.element_sets = {{"lower", {0, 1, 2}}};
  const Mesh read = back("m.mesh");
  EXPECT_EQ(read.points, mesh_.points);
  EXPECT_EQ(read.hexahedra, mesh_.hexahedra);
  using Sets = std::map<std::string, std::vector<Index>>;
  EXPECT_EQ(read.point_sets, (Sets{{"ref 9", {0, 1}}, {"ref 1", {5}}}));
  EXPECT_EQ(read.element_sets, (Sets{{"ref 1", {0, 1, 2}}}));
  ASSERT_EQ(diagnostics_.warnings().size(), 2u);
  EXPECT_NE(diagnostics_.warnings()[0].find("'modulus', 'fibre 100 %', 'u'"), std::string::npos);
  EXPECT_NE(diagnostics_.warnings()[1].find("'touches tip'"), std::string::npos);
}

TEST_F(RoundTrip, ArraysThatAreLostAreNamed) {
  mesh_.arrays[0].components = 10;
  mesh_.arrays[0].values.resize(mesh_.points.size() * 100);
  mesh_.arrays[1].values.clear();
  mesh_.arrays[1].unreadable = "it is damaged";
  write_mesh(folder_ / "m.msh", mesh_, diagnostics_);
  EXPECT_EQ(diagnostics_.warnings(),
            (std::vector<std::string>{"array '" + mesh_.arrays[1].name +
                                          "' is lost: it cannot be read from " + mesh_.source +
                                          ": it is damaged",
                                      "array '" + mesh_.arrays[0].name +
                                          "' is lost: it has 10 components, and Gmsh stores at "
                                          "most 9; write .vtu or .vtk to keep it"}));
}

TEST_F(RoundTrip, VtkReadsWhatWeWrite) {
  for (const char* name : {"m.vtu", "m.vtk"}) {
    SCOPED_TRACE(std::string(name) + ", seed " + std::to_string(seed_));
    write_mesh(folder_ / name, mesh_, diagnostics_);
    const Mesh read = read_mesh_with_vtk(folder_ / name);
    EXPECT_EQ(read.points, mesh_.points);
    EXPECT_EQ(read.hexahedra, mesh_.hexahedra);
    EXPECT_EQ(read.point_sets, mesh_.point_sets);
    EXPECT_EQ(read.element_sets, mesh_.element_sets);
  }
}

TEST_F(RoundTrip, WeReadWhatVtkWrites) {
  mesh_.element_sets.erase("100 % upper \"half\"");  // VTK forgets to escape the quotes
  for (const VtkEncoding encoding : vtk_encodings) {
    SCOPED_TRACE("encoding " + std::to_string(int(encoding)) + ", seed " + std::to_string(seed_));
    const bool legacy =
        encoding == VtkEncoding::legacy_text || encoding == VtkEncoding::legacy_binary;
    const auto path = folder_ / (legacy ? "m.vtk" : "m.vtu");
    write_with_vtk(path, mesh_, encoding);
    const Mesh read = read_mesh(path, 1, diagnostics_);
    EXPECT_EQ(read.hexahedra, mesh_.hexahedra);
    EXPECT_EQ(read.element_sets, mesh_.element_sets);
    EXPECT_EQ(read.point_ids, mesh_.point_ids);
    ASSERT_EQ(read.points.size(), mesh_.points.size());
    for (std::size_t i = 0; i < read.points.size(); ++i) {
      // VTK writes 6 significant digits into legacy text, and 11 into XML text.
      const double relative = legacy ? 1e-5 : 1e-10;
      const bool text = encoding == VtkEncoding::legacy_text || encoding == VtkEncoding::text;
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(read.points[i][c], mesh_.points[i][c],
                    text ? relative * std::abs(mesh_.points[i][c]) : 0);
      }
    }
  }
}

TEST_F(RoundTrip, ReportsWhatCannotBeWritten) {
  EXPECT_THROW(write_mesh(folder_ / "m.stl", mesh_, diagnostics_), UsageError);
  for (const char* name : {"m.vtu", "m.vtk", "m.mesh", "m.msh"}) {
    EXPECT_THROW(write_mesh(folder_ / "missing" / name, mesh_, diagnostics_), IoError);
  }
}

}  // namespace
}  // namespace suture
