// SPDX-License-Identifier: GPL-3.0-or-later
//
// Derivatives of equilibria, beside differences of whole equilibria. tests/python/gradients_test.py
// has all models and all that is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "kernel/gradients/equilibrium_slopes.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/sag.hpp"

namespace suture::test {
namespace {

/// A beam of 4 x 2 x 2 elements that sags.
class Sagging {
 public:
  explicit Sagging(const std::string& model) : simulation_(scene(model), tree_plugins(), known_) {
    simulation_.run(observer_);
  }

  double objective() { return sag_of(attributes()); }
  ObjectiveSlopes slopes() { return sag_slopes(attributes()); }
  Adjoint adjoint() {
    return EquilibriumSlopes(simulation_.built().dynamics()).adjoint(slopes(), 1e-10);
  }
  ParameterSlopes by(const std::string& parameter) {
    return {simulation_.built().body(), {simulation_.time()}, instance(), parameter};
  }
  /// J with a parameter of all elements.
  double objective_with(std::size_t parameter, double value) {
    std::vector<double> values(instance().parameters().begin(), instance().parameters().end());
    values[parameter] = value;
    simulation_.set_parameters(instance(), values);
    simulation_.equilibrate(observer_);
    return objective();
  }
  Instance& instance() { return *attributes().instances()[0]; }
  Attributes& attributes() { return simulation_.attributes(); }
  Simulation& simulation() { return simulation_; }

 private:
  static Scene scene(const std::string& model) {
    Scene scene = beam(tree_plugins(), model, 4, 2, 1);
    scene.solver.integrator = "static";
    scene.solver.end = scene.solver.dt = 1;
    scene.solver.step_tolerance = 1e-12;
    return scene;
  }

  Diagnostics known_;
  Observer observer_;
  Simulation simulation_;
};

class Gradients : public testing::TestWithParam<const char*> {};

TEST_P(Gradients, AgreeWithDifferencesOfEquilibria) {
  Sagging beam(GetParam());
  const Adjoint adjoint = beam.adjoint();
  ParameterSlopes by_young = beam.by("E");
  const std::vector<double> each = by_young.each(adjoint.multipliers);
  const std::vector<double> ones(each.size(), 1);
  const double sum = std::accumulate(each.begin(), each.end(), 0.0);
  EXPECT_EQ(each.size(), 16u);
  EXPECT_NEAR(by_young.along(adjoint.multipliers, ones), sum, 1e-8 * std::abs(sum));
  const double young = beam.instance().parameters()[0], h = 1e-3 * young;
  std::vector<double> values;
  for (const double steps : {-2, -1, 1, 2})
    values.push_back(beam.objective_with(0, young + steps * h));
  const double expected = (8 * (values[2] - values[1]) - (values[3] - values[0])) / (12 * h);
  EXPECT_NEAR(sum, expected, 1e-6 * std::abs(expected));
}

TEST_P(Gradients, LeaveTheBodyAsItWas) {
  Sagging asked(GetParam()), plain(GetParam());
  Column& mass = asked.attributes().mass();
  const double* const address = mass.rows();
  const Adjoint adjoint = asked.adjoint();
  asked.by("rho").each(adjoint.multipliers);
  const std::vector<double> direction(adjoint.motion.size(), 1);
  EquilibriumSlopes(asked.simulation().built().dynamics())
      .along_rest(asked.slopes(), adjoint, direction);
  EXPECT_EQ(mass.rows(), address);
  EXPECT_TRUE(std::equal(address, address + mass.size(), plain.attributes().mass().rows()));
  EXPECT_EQ(asked.objective_with(0, 3e5), plain.objective_with(0, 3e5));
}

INSTANTIATE_TEST_SUITE_P(Models, Gradients, testing::Values("tm-faure", "mss-golec"),
                         [](const auto& test) { return std::string(test.param).substr(0, 2); });

}  // namespace
}  // namespace suture::test
