// SPDX-License-Identifier: GPL-3.0-or-later
//
// exp, expm1, log, log1p, sin, cos, tanh, cbrt and pow of packs against long double, called through
// a plugin for every instruction set: random numbers of ordinary size, random bits, and the places
// where functions or their evaluation change.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <random>

#include "suture/single.h"
#include "tests/plugins/plugin_batch.hpp"

namespace {

using namespace suture::test;
using Exact = std::function<long double(long double)>;

struct Case {
  const char* name;
  double function, exponent;
  Exact exact;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> list = [] {
    std::vector<Case> all{{"exp", 0, 1, [](long double x) { return std::exp(x); }},
                          {"log", 1, 1, [](long double x) { return std::log(x); }},
                          {"sin", 2, 1, [](long double x) { return std::sin(x); }},
                          {"cos", 3, 1, [](long double x) { return std::cos(x); }},
                          {"tanh", 4, 1, [](long double x) { return std::tanh(x); }},
                          {"cbrt", 5, 1, [](long double x) { return std::cbrt(x); }},
                          {"log1p", 7, 1, [](long double x) { return std::log1p(x); }},
                          {"expm1", 8, 1, [](long double x) { return std::expm1(x); }}};
    for (const double y : {-2 / 3.0, 0.5, 2.0, -3.0, 101.3, -1e3, 1e300, 0.0, HUGE_VAL})
      all.push_back(
          {"pow", 6, y, [y](long double x) { return std::pow(x, static_cast<long double>(y)); }});
    return all;
  }();
  return list;
}

/// In units in the last place of the exact value; infinite where a special value is wrong.
template <class E>
double error(E value, long double exact) {
  const E rounded = static_cast<E>(exact);
  if (std::isnan(rounded) || std::isnan(value))
    return std::isnan(rounded) && std::isnan(value) ? 0 : HUGE_VAL;
  if (std::isinf(rounded) || std::isinf(value)) return rounded == value ? 0 : HUGE_VAL;
  int exponent;
  std::frexp(exact, &exponent);
  exponent = std::max(exponent, std::numeric_limits<E>::min_exponent);
  return static_cast<double>(std::abs(value - exact) /
                             std::ldexp(1.0L, exponent - std::numeric_limits<E>::digits));
}

template <class E>
const std::vector<E>& special_arguments() {
  static const std::vector<E> list = [] {
    using limits = std::numeric_limits<E>;
    std::vector<E> all{0,
                       limits::infinity(),
                       limits::quiet_NaN(),
                       limits::denorm_min(),
                       limits::min(),
                       limits::min() / 3,
                       limits::max()};
    for (const double x : {0.5,
                           0.6,
                           0.625,
                           1.0,
                           2.0,
                           8.0,
                           27.0,
                           0.70710678118654752,
                           0.34657359,
                           88.72,
                           88.73,
                           87.33,
                           103.2,
                           104.0,
                           709.78,
                           709.79,
                           708.39,
                           745.13,
                           745.14,
                           746.0,
                           999999.0,
                           1e6,
                           1000001.0,
                           1e15,
                           1.5707963267948966,
                           355.0,
                           1e22,
                           1e30})
      for (const E y : {E(x), std::nextafter(E(x), E(0)), std::nextafter(E(x), E(1e38))})
        all.push_back(y);
    const std::size_t half = all.size();
    for (std::size_t i = 0; i < half; ++i) all.push_back(-all[i]);
    return all;
  }();
  return list;
}

/// Arguments of all kinds, 24 or 48 at a time.
template <class E>
E argument(std::mt19937_64& engine, int kind) {
  const auto& special = special_arguments<E>();
  const auto uniform = [&](double a, double b) {
    return static_cast<E>(std::uniform_real_distribution<>(a, b)(engine));
  };
  if (kind == 0) return special[engine() % special.size()];
  if (kind == 1) return uniform(0.2, 5);
  if (kind == 2) return uniform(-20, 20);
  if (kind == 3) return uniform(-750, 750);
  if (kind == 4)
    return static_cast<E>((engine() % 2 ? 1 : -1) *
                          std::exp(static_cast<double>(uniform(-100, 100))));
  E x;
  const std::uint64_t bits = engine();
  std::memcpy(&x, &bits, sizeof x);
  return std::isnan(x) ? special[2] : x;  // pow(x, 0) of a signalling NaN is not 1
}

class ElementaryFunctions : public testing::TestWithParam<std::string> {
 protected:
  const suture_model& model() {
    return load_plugin(SUTURE_PLUGIN_FOLDER, "elementary", GetParam()).models[0];
  }
  std::mt19937_64 engine{11};
};

TEST_P(ElementaryFunctions, OfDoublesAreGoodToTwoUnitsInTheLastPlace) {
  for (const Case& c : cases()) {
    ModelInstance instance(model(), {c.function, c.exponent});
    const auto& table =
        ModelInstance::extension<suture_output_1>(model().functors[0], SUTURE_OUTPUT_1);
    alignas(64) double x[24], y[24];
    suture_batch batch{};
    batch.size = sizeof batch;
    batch.lanes = batch.valid = 8;
    batch.nodes = 1;
    batch.rest = batch.position = x;
    double* const out[] = {y};
    for (int round = 0; round < 3000; ++round) {
      for (double& a : x) a = argument<double>(engine, round % 6);
      ASSERT_EQ(table.compute(instance.context(), &batch, out), SUTURE_OK);
      for (int i = 0; i < 24; ++i)
        ASSERT_LE(error(y[i], c.exact(x[i])), 2)
            << c.name << " " << c.exponent << " of " << x[i] << " gave " << y[i];
    }
  }
}

TEST_P(ElementaryFunctions, OfFloatsAreGoodToTwoUnitsInTheLastPlace) {
  for (const Case& c : cases()) {
    ModelInstance instance(model(), {c.function, c.exponent});
    const auto& tangent = ModelInstance::extension<suture_tangent_single_1>(
        model().functors[0], SUTURE_TANGENT_SINGLE_1);
    alignas(64) float x[48], y[48], one[48], zero[48] = {};
    std::fill(one, one + 48, 1.0F);
    suture_single_batch batch{};
    batch.size = sizeof batch;
    batch.lanes = SUTURE_SINGLE_LANES;
    batch.nodes = 1;
    batch.rest = x;
    batch.position = zero;
    for (int round = 0; round < 1500; ++round) {
      for (float& a : x) a = argument<float>(engine, round % 6);
      ASSERT_EQ(tangent.apply(instance.context(), &batch, one, zero, y), SUTURE_OK);
      for (int i = 0; i < 48; ++i)
        ASSERT_LE(error(y[i], c.exact(x[i])), 2)
            << c.name << " " << c.exponent << " of " << x[i] << " gave " << y[i];
    }
  }
}

TEST_P(ElementaryFunctions, OfALaneDependOnItsArgumentAlone) {
  for (const Case& c : cases()) {
    ModelInstance instance(model(), {c.function, c.exponent});
    const auto& table =
        ModelInstance::extension<suture_output_1>(model().functors[0], SUTURE_OUTPUT_1);
    alignas(64) double x[24], y[24];
    suture_batch batch{};
    batch.size = sizeof batch;
    batch.lanes = batch.valid = 8;
    batch.nodes = 1;
    batch.rest = batch.position = x;
    double* const out[] = {y};
    for (int round = 0; round < 100; ++round) {
      const double chosen = argument<double>(engine, round % 6);
      double first = 0;
      for (int place = 0; place < 24; ++place) {
        for (double& a : x) a = argument<double>(engine, place % 6);
        x[place] = chosen;
        ASSERT_EQ(table.compute(instance.context(), &batch, out), SUTURE_OK);
        if (place == 0) first = y[0];
        ASSERT_EQ(std::memcmp(&y[place], &first, sizeof first), 0) << c.name << " of " << chosen;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Isa, ElementaryFunctions, testing::ValuesIn(runnable_isas()),
                         [](const auto& isa) { return isa.param; });

}  // namespace
