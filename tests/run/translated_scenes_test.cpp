// SPDX-License-Identifier: GPL-3.0-or-later
//
// The example scenes give the same results near 0 and 10,000 km away. The coordinates are moved in
// the text of the scenes, so that any coordinate that the kernel overlooks is noticed.
#include <gtest/gtest.h>

#include <algorithm>

#include "kernel/scene/scene_reader.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/run/csv_table.hpp"
#include "tests/run/host.hpp"
#include "tests/run/translation.hpp"

namespace suture::test {
namespace {

struct Shipped {
  const char* name;
  std::vector<std::pair<const char*, Vec3>> coordinates;  ///< all, but for the mesh
  std::vector<std::string> sets{};                        ///< to be quick
  const char* mesh = "box";
  double tolerance = 0;
};

void PrintTo(const Shipped& shipped, std::ostream* stream) { *stream << shipped.name; }

class ShippedScenes : public testing::TestWithParam<Shipped> {};

const char* const plane = "/events/0/cut/plane/point";

INSTANTIATE_TEST_SUITE_P(
    Translation, ShippedScenes,
    testing::Values(Shipped{"blade-sweep",
                            {{"/events/0/cut/blade/path/0/points/0", {-0.01, 0.045, -0.01}},
                             {"/events/0/cut/blade/path/0/points/1", {-0.01, 0.045, 0.07}},
                             {"/events/0/cut/blade/path/1/points/0", {0.08, 0.035, -0.01}},
                             {"/events/0/cut/blade/path/1/points/1", {0.08, 0.035, 0.07}}},
                            {"/mesh/box/cells=[9,9,3]"}},
                    Shipped{
                        "cut-beam",
                        {{plane, {0.5, 0, 0}}, {"/output/probes/at/0/point", {0.5, 0.125, 0.125}}},
                        {"/mesh/box/cells=[20,5,5]", "/solver/end=0.4"}},
                    Shipped{"letters",
                            {{plane, {1.2, 0.32, 0}}, {"/events/1/cut/plane/point", {0.2, 0.3, 0}}},
                            {"/solver/end=0.4", "/events/0/at=0.1", "/events/1/at=0.2"},
                            "voxels",
                            1e-6},
                    Shipped{"notched-strip",
                            {{"/events/0/cut/plane/polygon/0", {0.1, 0.04, -1}},
                             {"/events/0/cut/plane/polygon/1", {0.1, 0.07, -1}},
                             {"/events/0/cut/plane/polygon/2", {0.1, 0.07, 1}},
                             {"/events/0/cut/plane/polygon/3", {0.1, 0.04, 1}}}},
                    Shipped{"paper-beam-mss", {}, {"/mesh/box/cells=[12,3,3]", "/solver/end=0.3"}},
                    Shipped{"paper-beam-mss-tenth", {}, {"/mesh/box/cells=[12,3,3]"}},
                    Shipped{"paper-beam-tm",
                            {{"/output/probes/at/0/point", {1, 0.125, 0.125}}},
                            {"/mesh/box/cells=[12,4,4]"}},
                    Shipped{"press-and-cut",
                            {{"/events/0/cut/plane/point", {0.125, 0, 0}},
                             {"/contact/obstacles/0/half_space/point", {0, 0, 0}},
                             {"/contact/obstacles/1/sphere/centre", {0.09375, 0.125, 0.1015625}}},
                            {"/mesh/box/cells=[8,8,2]", "/solver/end=1"}},
                    Shipped{"pierce-and-suture",
                            {{"/events/0/pierce/path/0", {0.08, -1, 0.1}},
                             {"/events/0/pierce/path/1", {0.08, 1, 0.1}},
                             {"/events/1/cut/plane/polygon/0", {0.15, -1, 0.05}},
                             {"/events/1/cut/plane/polygon/1", {0.15, -1, 0.15}},
                             {"/events/1/cut/plane/polygon/2", {0.15, 1, 0.15}},
                             {"/events/1/cut/plane/polygon/3", {0.15, 1, 0.05}},
                             {"/events/2/when/where/nearest", {0.15, 0, 0.1}}}}),
    [](const auto& test) {
      std::string name = test.param.name;
      std::ranges::replace(name, '-', '_');
      return name;
    });

// A shape of cubes has the same nodes wherever it is, and these coordinates only select:
// the bits are the same. Cuts along the blade lie where the scene has rounded them.
TEST_P(ShippedScenes, HaveTheSameBitsFarAway) {
  const Shipped& shipped = GetParam();
  TemporaryFolder folder;
  const auto run = [&](const Vec3& shift, const std::string& name) {
    std::vector<std::string> sets = shipped.sets;
    sets.push_back("/output/directory=\"" + (folder / name).string() + '"');
    if (shift != Vec3{}) {
      sets.push_back(std::string("/mesh/") + shipped.mesh + "/origin=" + at({}, shift));
      for (const auto& [pointer, point] : shipped.coordinates)
        sets.push_back(pointer + ("=" + at(point, shift)));
    }
    const std::filesystem::path file =
        std::filesystem::path(SUTURE_SCENES) / (std::string(shipped.name) + ".json");
    Diagnostics diagnostics;
    Scene scene = read_scene(file, sets, host(), diagnostics);
    scene.output.every = 0;  // the first and the last frame will do
    return TranslatedRun(scene);
  };
  const TranslatedRun near = run({}, "near");
  expect_same(near, run(far_away, "far"), shipped.tolerance);
  if (!std::filesystem::exists(folder / "near/probes.csv")) return;
  const CsvTable a(folder / "near/probes.csv"), b(folder / "far/probes.csv");
  ASSERT_EQ(a.rows.size(), b.rows.size());
  for (std::size_t c = 0; c < a.columns.size(); ++c) {
    const std::size_t place = a.columns[c].find(" position ");
    const bool shifted = place != std::string::npos;  // and rounded where the scene has it
    const double shift =
        shifted ? far_away[static_cast<std::size_t>(a.columns[c][place + 10] - 'x')] : 0;
    for (std::size_t row = 0; row < a.rows.size(); ++row)
      expect_near(a.rows[row][c] + shift, b.rows[row][c], shifted ? 4e-9 : 0, a.columns[c]);
  }
}

}  // namespace
}  // namespace suture::test
