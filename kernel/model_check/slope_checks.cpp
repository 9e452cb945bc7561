// SPDX-License-Identifier: GPL-3.0-or-later
//
// Forces as functions of parameters.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernel/base/error.hpp"
#include "kernel/gradients/parameter_slopes.hpp"
#include "kernel/gradients/total_forces.hpp"
#include "kernel/model_check/checks.hpp"

namespace suture::checks {
namespace {

// What rounding leaves of forces, in a change by a step of 1e-5.
constexpr double rounding = 1e-9;

std::vector<double> random_numbers(std::mt19937_64& random, std::size_t count) {
  std::vector<double> numbers(count);
  for (double& number : numbers) number = between(random, -1, 1);
  return numbers;
}

/// How far two derivatives of L differ, relative to them and to what rounding leaves of L.
double error_of(double found, double expected, double noise) {
  if (found == expected) return 0;  // a body at rest has no drag
  return std::abs(found - expected) / std::max({std::abs(found), std::abs(expected), noise});
}

/// Checks the parameter with this name, at random multipliers and weights.
Measured slope_error(SampleBody& sample, const std::string& name, std::mt19937_64& random) {
  const auto slopes_with = [&](double step) {
    return ParameterSlopes(sample.body(), {sample.options().time}, sample.instance(), name, step);
  };
  ParameterSlopes slopes = slopes_with(ParameterSlopes::best_step);
  const std::vector<double> forces = total_forces(sample.body(), sample.options().time);
  const Multipliers multipliers{random_numbers(random, forces.size()), 0};
  std::vector<double> weights = random_numbers(random, slopes.size());
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] *= slopes.steps()[i];
  double noise = 0;
  for (std::size_t i = 0; i < forces.size(); ++i)
    noise += rounding * std::abs(multipliers.force[i] * forces[i]);
  const auto along_with = [&](double width) {
    return slopes_with(width * ParameterSlopes::best_step).along(multipliers, weights);
  };
  const double along = slopes.along(multipliers, weights), narrow = along_with(0.1);
  // Kinks of a law spoil one width or another, also the best one; what is rounded is wrong in all.
  double figure =
      std::min({error_of(along_with(100), along, noise), error_of(along_with(10), along, noise),
                error_of(narrow, along, noise), error_of(along_with(0.3), narrow, noise)});
  const std::vector<double> each = slopes.each(multipliers);
  const double sum = std::inner_product(each.begin(), each.end(), weights.begin(), 0.0);
  figure = std::max(figure, error_of(sum, along, noise));
  return {figure, "parameter '" + name + "'"};
}

}  // namespace

/// Parameters at the end of their range, and those that switch functors, are left out.
Result slopes(const BodyCase& of) {
  of.sample.stop();
  std::mt19937_64 random(of.sample.options().seed);
  const suture_model& model = of.sample.model();
  Result worst;
  for (const suture_parameter& p : std::span(model.parameters, model.parameter_count)) {
    if (p.type != SUTURE_NUMBER) continue;
    try {
      const Measured found = slope_error(of.sample, p.name, random);
      if (!worst || !(found.figure <= worst->figure)) worst = found;
    } catch (const InputError&) {
    }
  }
  return worst;
}

}  // namespace suture::checks
