// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/cantilever.hpp"

#include <algorithm>
#include <iterator>

#include "kernel/base/error.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/implicit/newton.hpp"

namespace suture::bench {
namespace {

constexpr Index reference_meshes[3] = {5, 10, 20};

const Cantilever known_cases[] = {
    {"A", 9.8, 0.3, {-0.4992912006326, -0.5077616632536, -0.5108246881083}, unknown, false},
    {"A0.25", 2.45, 0.3, {-0.1467450383566, -0.1498008516107, -0.1507273288824}, -0.1511616184928},
    {"B",
     9.8e-3,
     0.3,
     {-5.949547683863e-4, -6.076141441195e-4, -6.114394687855e-4},
     -6.1321068507931e-4},
    {"H0.49", 9.8e-3, 0.49, {unknown, unknown, unknown}, -5.943e-4},
    {"H0.499",
     9.8e-3,
     0.499,
     {-2.798677062031e-4, -3.904269704535e-4, -4.884584510637e-4},
     -5.936278505847e-4},
    {"H0.499 full",
     9.8,
     0.499,
     {-0.2661230347329, -0.3554526719730, -0.4276178708982},
     -0.5013062444400,
     false},
};

/// The number of the choice `name` of a parameter. Throws UsageError.
double choice_of(const suture_parameter& parameter, const std::string& name) {
  const std::vector<std::string> choices(parameter.choices,
                                         parameter.choices + parameter.choice_count);
  const auto found = std::ranges::find(choices, name);
  if (found == choices.end())
    throw UsageError("no " + std::string(parameter.name) + " is called '" + name + "'" +
                     did_you_mean(name, choices));
  return static_cast<double>(found - choices.begin());
}

}  // namespace

double Cantilever::discrete_tip(Index across) const {
  const auto* found = std::ranges::find(reference_meshes, across);
  return found == std::end(reference_meshes) ? unknown : discrete[found - reference_meshes];
}

std::span<const Cantilever> cantilevers() { return known_cases; }

const Cantilever& cantilever(std::string_view name) {
  std::vector<std::string> names;
  for (const Cantilever& known : known_cases) {
    if (known.name == name) return known;
    names.push_back(known.name);
  }
  throw UsageError("no case is called '" + std::string(name) + "'" + did_you_mean(name, names));
}

BodyOptions options_of(const Cantilever& what, const suture_model& model,
                       const CantileverMesh& mesh) {
  const Index n = mesh.across;
  BodyOptions options{.model = model.id,
                      .parameters = {{"nu", what.nu}},
                      .cells = {n, n, 4 * n},
                      .distorted = mesh.distorted,
                      .cell = 0.25 / n,
                      .gravity = {0, -what.gravity, 0},
                      .held = mesh.distorted ? 0.11 * 0.25 / n : 0,
                      .integrator = "static",
                      .dt = 1};
  for (const suture_parameter& p : std::span(model.parameters, model.parameter_count))
    if (!mesh.element.empty() && std::string_view(p.name) == "element")
      options.parameters["element"] = choice_of(p, mesh.element);
  return options;
}

double tip_of(BenchBody& body, Index across) {
  const double cell = 0.25 / across;
  const Column &rest = body.attributes().rest(), &position = body.attributes().position();
  // Distorted meshes: nodes are up to a tenth of a cell from their places.
  const auto is_near = [&](Index v, int c, double x) {
    return std::abs(rest.get(v, c) - x) < 0.65 * cell;
  };
  double sum = 0;
  int count = 0;
  for (Index v = 0; v < body.attributes().vertex_count(); ++v) {
    if (!is_near(v, 0, 0.125) || !is_near(v, 1, 0.125) || !is_near(v, 2, 1)) continue;
    sum += position.get(v, 1) - rest.get(v, 1);
    ++count;
  }
  return sum / count;
}

Work::Work(Dynamics& dynamics) : dynamics_(dynamics) {
  dynamics.newton()->on_iteration = [this](const Newton::Iteration& i) {
    ++(i.coarse_nodes > 0 ? coarse : newton);
    krylov += i.linear_iterations;
  };
}

Work::~Work() { dynamics_.newton()->on_iteration = nullptr; }

}  // namespace suture::bench
