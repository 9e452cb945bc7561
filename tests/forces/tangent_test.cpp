// SPDX-License-Identifier: GPL-3.0-or-later
//
// Products with the tangents of the plugins, in double and in single precision.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>

#include "kernel/plugin_host/plugin_host.hpp"
#include "suture/single.h"
#include "tests/base/variable.hpp"
#include "tests/forces/spring_model.hpp"

namespace suture {
namespace {

struct Case {
  const char* name;
  const char* model;
  std::map<std::string, double> parameters;
  bool distorted;
  bool is_single;  ///< computed in single precision, not only rounded
};

const Case cases[] = {
    {"Boxes", "tm-faure", {}, false, true},
    {"BoxesExact", "tm-faure", {{"quadrature", 1}}, false, true},
    {"General", "tm-faure", {}, true, true},
    {"GeneralRecomputed", "tm-faure", {{"geometry", 1}}, true, true},
    {"GeneralExact", "tm-faure", {{"quadrature", 1}}, true, true},
    {"Springs", "mss-baudet", {}, false, false},
    {"ViscousSprings", "mss-baudet", {{"viscosity", 0.1}}, false, false},
    {"CorrectedSprings", "mss-baudet", {{"viscosity", 0.1}, {"correction", 1}}, true, false},
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

std::vector<double> values_of(const suture_model& model,
                              const std::map<std::string, double>& chosen) {
  const std::map<std::string, double> material{{"E", 1000}, {"nu", 0.3}, {"rho", 1000}};
  std::vector<double> values;
  for (const suture_parameter& p : std::span(model.parameters, model.parameter_count)) {
    const auto own = chosen.find(p.name), common = material.find(p.name);
    values.push_back(own != chosen.end()        ? own->second
                     : common != material.end() ? common->second
                                                : p.default_value);
  }
  return values;
}

/// A block of the case's model, cut and moved at random.
struct Block : spring_model::Body {
  explicit Block(const Case& c, Index cells = 4, unsigned threads = 1)
      : spring_model::Body(spring_model::box(cells, cells, cells + 1), c.distorted) {
    const suture_model& model = plugins.model(c.model);
    attributes().add(
        std::make_unique<Instance>(model, "tissue", values_of(model, c.parameters), diagnostics),
        complex(), {});
    compile(threads);
    cut_random(cells * cells / 2, 3);
    shake(0.01, 5);
  }

  std::size_t size() { return std::size_t{attributes().vertex_count()} * 3; }
  std::vector<double> direction(double phase) {
    std::vector<double> d(size());
    for (std::size_t i = 0; i < d.size(); ++i) d[i] = std::sin(static_cast<double>(i) + phase);
    return d;
  }
  template <class Real>
  std::vector<Real> product(const std::vector<double>& d, double dx, double dv) {
    constexpr std::size_t row = std::is_same_v<Real, float> ? 4 : 3;
    AlignedVector<Real> rows(d.size() / 3 * row), images(rows.size());
    for (std::size_t i = 0; i < d.size(); ++i) rows[i / 3 * row + i % 3] = static_cast<Real>(d[i]);
    models().add_tangent(rows.data(), dx, dv, 0, images.data());
    std::vector<Real> image(d.size());
    for (std::size_t i = 0; i < d.size(); ++i) image[i] = images[i / 3 * row + i % 3];
    return image;
  }
  /// Moves positions by `dx` and velocities by `dv` times the direction.
  void move(const std::vector<double>& d, double dx, double dv) {
    for (std::size_t i = 0; i < d.size(); ++i) {
      const auto v = static_cast<Index>(i / 3);
      const auto c = static_cast<int>(i % 3);
      attributes().position().set(v, c, attributes().position().get(v, c) + dx * d[i]);
      attributes().velocity().set(v, c, attributes().velocity().get(v, c) + dv * d[i]);
    }
  }

  PluginHost plugins;
};

/// The largest difference of a component, over the largest of the second.
template <class A, class B>
double difference(const std::vector<A>& a, const std::vector<B>& b) {
  double worst = 0, largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    worst = std::max(worst, std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i])));
    largest = std::max(largest, std::abs(static_cast<double>(b[i])));
  }
  return worst / largest;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

class Product : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Plugins, Product, testing::ValuesIn(cases),
                         [](const auto& of) { return of.param.name; });

TEST_P(Product, IsTheDerivativeOfTheForces) {
  Block body(GetParam());
  const std::vector<double> d = body.direction(0);
  const std::vector<double> product = body.product<double>(d, 2, 0.3);
  const double h = 1e-6;
  body.move(d, 2 * h, 0.3 * h);
  const std::vector<double> above = spring_model::forces_of(body, body.models());
  body.move(d, -4 * h, -0.6 * h);
  const std::vector<double> below = spring_model::forces_of(body, body.models());
  std::vector<double> quotient(d.size());
  for (std::size_t i = 0; i < d.size(); ++i)
    quotient[i] = (above[i / 3 * 4 + i % 3] - below[i / 3 * 4 + i % 3]) / (2 * h);
  EXPECT_LT(difference(product, quotient), 1e-6);
}

TEST_P(Product, OfPositionsIsSymmetric) {
  Block body(GetParam());
  for (Index v = 0; v < body.attributes().vertex_count(); ++v)
    for (int c = 0; c < 3; ++c) body.attributes().velocity().set(v, c, 0);
  const std::vector<double> a = body.direction(0), b = body.direction(1);
  const double ab = dot(a, body.product<double>(b, 1, 0));
  EXPECT_NEAR(ab, dot(b, body.product<double>(a, 1, 0)), 1e-12 * std::abs(ab));
}

TEST_P(Product, OfFloatsHasFiveDigitsFarFromTheOrigin) {
  Block body(GetParam());
  const std::vector<double> d = body.direction(0);
  const std::vector<double> expected = body.product<double>(d, 2, 0.3);
  EXPECT_LT(difference(body.product<float>(d, 2, 0.3), expected), 1e-5);
  body.move(std::vector<double>(d.size(), 1), 1000, 0);
  EXPECT_LT(difference(body.product<float>(d, 2, 0.3), expected), 1e-5);
  EXPECT_LT(difference(body.product<double>(d, 2, 0.3), expected), 1e-9);
}

TEST_P(Product, SameBitsForAnyNumberOfThreads) {
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
  Block one(GetParam(), 22), many(GetParam(), 22, 3);
  ASSERT_EQ(many.models().threads(), 3u);
  const std::vector<double> d = one.direction(0);
  const auto a = one.product<double>(d, 2, 0.3), b = many.product<double>(d, 2, 0.3);
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(double)), 0);
  const auto c = one.product<float>(d, 2, 0.3), e = many.product<float>(d, 2, 0.3);
  EXPECT_EQ(std::memcmp(c.data(), e.data(), c.size() * sizeof(float)), 0);
}

TEST_P(Product, IsTheSameOnEveryInstructionSet) {
  Block best(GetParam());
  const std::vector<double> d = best.direction(0);
  const std::vector<double> expected = best.product<double>(d, 2, 0.3);
  for (const char* isa : {"base", "avx2"}) {
    const suture::test::Variable chosen("SUTURE_ISA", isa);
    Block body(GetParam());
    EXPECT_LT(difference(body.product<double>(d, 2, 0.3), expected), 1e-12) << isa;
    EXPECT_LT(difference(body.product<float>(d, 2, 0.3), expected), 1e-5) << isa;
  }
}

// A product that computes in double and rounds its result would pass all of the above.
TEST_P(Product, OfFloatsIsComputedInSinglePrecisionWhereOffered) {
  Block body(GetParam());
  bool offered = false;
  const suture_model& model = body.plugins.model(GetParam().model);
  for (std::uint32_t i = 0; i < model.functor_count; ++i)
    offered |= model.functors[i].extension(SUTURE_TANGENT_SINGLE_1) != nullptr;
  EXPECT_EQ(offered, GetParam().is_single);
}

// Every call is checked, and nothing is found.
TEST_P(Product, StaysTheSameInARunThatChecksPlugins) {
  Block body(GetParam());
  const std::vector<double> d = body.direction(0);
  const auto doubles = body.product<double>(d, 2, 0.3);
  const auto floats = body.product<float>(d, 2, 0.3);
  body.models().check_plugins();
  EXPECT_EQ(body.product<double>(d, 2, 0.3), doubles);
  EXPECT_EQ(body.product<float>(d, 2, 0.3), floats);
  auto broken = d;
  broken[7] = std::nan("");
  EXPECT_THROW(body.product<double>(broken, 1, 0), PluginError);
  EXPECT_THROW(body.product<float>(broken, 1, 0), PluginError);
}

}  // namespace
}  // namespace suture
