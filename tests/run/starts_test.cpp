// SPDX-License-Identifier: GPL-3.0-or-later
//
// Attributes that start from numbers, tables and arrays, and contributions of elements whose
// parameters differ.
#include <fstream>
#include <limits>
#include <map>

#include "kernel/base/error.hpp"
#include "kernel/scene/scene_reader.hpp"
#include "tests/run/differing_values.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

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
        << more << R"("output": false})";
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

}  // namespace
}  // namespace suture::test
