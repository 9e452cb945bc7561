// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/stress_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace suture::test {
namespace {

std::string percent(double fraction) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %%", 100 * fraction);
  return text;
}

/// The warning that what follows is not what was asked for, or nothing.
std::string warning_of(const Result& result) {
  constexpr const char* words[] = {"invert",      "unstable",           "hourglass",
                                   "unexplained", "negative stiffness", "edge ratio",
                                   "/solver/dt"};
  for (const std::string& message : result.messages)
    for (const char* word : words)
      if (message.find(word) != std::string::npos) return message;
  return "";
}

bool is_within(const Trial& trial, const Result& result) {
  return result.difference <= trial.check.tolerance && result.growth <= trial.allowed_growth &&
         std::isfinite(result.growth) && std::isfinite(result.balance);
}

}  // namespace

Values run_and_measure(const Check& check, Simulation& simulation, Observer& observer,
                       RunSummary& summary) {
  Values largest;
  const double end = simulation.built().scene().solver.end.value_or(0);
  for (unsigned look = 1; look <= check.looks; ++look) {
    simulation.run_to(end * look / check.looks, observer);
    const Values values = check.measure(simulation);
    largest.resize(values.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!(std::abs(values[i]) <= largest[i])) largest[i] = std::abs(values[i]);
  }
  summary = simulation.run(observer);
  if (check.looks > 0 || !check.measure) return largest;
  return check.measure(simulation);
}

double difference_to(const Check& check, const Values& expected, const Values& values) {
  if (values.size() != expected.size()) return std::numeric_limits<double>::infinity();
  double difference = 0, scale = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) return std::numeric_limits<double>::infinity();
    const double beyond = values[i] - expected[i];
    difference = std::max(difference, check.looks > 0 ? beyond : std::abs(beyond));
    scale = std::max(scale, std::abs(expected[i]));
  }
  return difference / scale;
}

void judge_stress(const Trial& trial, Result& result) {
  const auto set = [&](Verdict verdict, const std::string& reason) {
    result.verdict = verdict;
    result.reason = reason;
  };
  const bool may_end = !trial.excuse.empty() || trial.expected != Expected::right;
  if (result.outcome == "InputError" || result.outcome == "PluginError")
    return set(may_end ? Verdict::refused : Verdict::not_run, result.error);
  if (!result.error.empty()) return set(may_end ? Verdict::ended : Verdict::stopped, result.error);
  if (result.outcome == "unstable equilibrium")
    return set(may_end ? Verdict::ended : Verdict::stopped, "an unstable equilibrium");
  const std::string warning = warning_of(result);
  const bool must_say = trial.expected == Expected::wrong || trial.expected == Expected::warned;
  const bool is_checked = trial.check.measure || trial.excuse.empty();
  if (!must_say && is_within(trial, result) && (is_checked || warning.empty())) return;
  if (!warning.empty()) return set(Verdict::warned, warning);
  set(must_say ? Verdict::finished_wrong : Verdict::inaccurate,
      "differs by " + percent(result.difference) + ", energy grew by " + percent(result.growth));
}

}  // namespace suture::test
