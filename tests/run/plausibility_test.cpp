// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/plausibility.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "tests/run/beam.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

std::string line_of(double young, double density, double length, double gravity) {
  Scene scene =
      beam(host(), "tm-faure", 4, 2, gravity, {{"E", young}, {"nu", 0.25}, {"rho", density}});
  scene.mesh.box->size = {length, length / 4, length / 4};
  Diagnostics diagnostics;
  BuiltScene built(scene, diagnostics);
  return describe_plausibility(built);
}

bool says(const std::string& line, const std::string& part) {
  return line.find(part) != std::string::npos;
}

// At nu = 1/4, lambda + 2 mu = 1.2 E.
TEST(Plausibility, StatesSizeMassSpeedOfWavesAndStrainUnderTheWeight) {
  const std::string line = line_of(3e5, 1000, 2, 9);
  EXPECT_TRUE(says(line, "2 x 0.5 x 0.5 m, 500 kg, 1000 kg/m^3, waves of 18.97 m/s")) << line;
  std::ostringstream strain;  // along y
  strain.precision(4);
  strain << "strained by " << 1000 * 9 * 0.5 / (1.2 * 3e5) << " under its weight";
  EXPECT_TRUE(says(line, strain.str())) << line;
  EXPECT_FALSE(says(line, "unusual")) << line;
  EXPECT_FALSE(says(line_of(3e5, 1000, 2, 0), "weight"));
}

TEST(Plausibility, NamesWhatIsUnusual) {
  const auto unusual = [](const std::string& line) {
    const std::size_t at = line.find("unusual for a solid: ");
    return at == std::string::npos ? "" : line.substr(at);
  };
  const std::string light = unusual(line_of(1e4, 1060e-9, 0.2, 0));
  EXPECT_TRUE(says(light, "density") && says(light, "wave speed") && !says(light, "size")) << light;
  const std::string soft = unusual(line_of(0.4, 1000, 0.2, 9.81));
  EXPECT_TRUE(says(soft, "wave speed") && says(soft, "weight") && !says(soft, "density")) << soft;
  const std::string large = unusual(line_of(1e9, 1000, 1000, 0));
  EXPECT_TRUE(says(large, "size") && !says(large, "weight")) << large;
  EXPECT_TRUE(says(unusual(line_of(1e4, 1060, 1000, 9.81)), "weight"));
}

}  // namespace
}  // namespace suture::test
