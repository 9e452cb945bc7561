// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/stress_parts.hpp"

#include <cmath>

namespace suture::test {
namespace {

constexpr std::uint64_t most_steps = 2'000'000, most_solves = 20'000;  // then a run is stopped

}  // namespace

const std::vector<std::string>& solver_names() {
  static const std::vector<std::string> names{"symplectic-euler",
                                              "velocity-verlet",
                                              "implicit-euler",
                                              "newmark",
                                              "static",
                                              "quasi-static",
                                              "rest"};
  return names;
}

Pair pair_of(const Draft& d) {
  Pair pair;
  const auto solvers = static_cast<unsigned>(solver_names().size());
  pair.material.name = material_names()[d.index / solvers];
  if (!has_poisson(pair.material.name)) pair.material.poisson = 0.25;
  pair.solver = solver_names()[d.index % solvers];
  return pair;
}

Body box(const Vec3& size, const std::array<int, 3>& cells, double scale) {
  Body body;
  for (std::size_t a = 0; a < 3; ++a) body.size[a] = scale * size[a];
  body.cells = cells;
  body.scale = scale;
  body.mesh["box"] = {{"size", body.size}, {"cells", body.cells}};
  return body;
}

Vec3 edges_of(const Body& body) { return {body.edge(0), body.edge(1), body.edge(2)}; }

void begin(Draft& d, Pair pair, const Body& body, double end, double damping, double dt) {
  pair.material.period = period_of(body, pair.material.young, pair.material.density);
  d.start(body, pair.material, end);
  d.trial.model = pair.material.name;
  d.trial.solver = pair.solver;
  d.trial.is_conservative = false;  // judged by the check
  Json& solver = d.trial.scene["solver"];
  if (pair.moves()) {
    solver["integrator"] = pair.solver;
    if (dt > 0)
      solver["dt"] = dt * d.period();
    else if (pair.solver == "implicit-euler")
      solver["dt"] = d.period() / 20;
    if (damping > 0) solver["damping"] = damping / d.period();
    solver["end"] = d.end();
  } else if (pair.solver == "rest") {
    solver["until"] = "rest";
    solver["tolerance"] = 1e-8;
  } else {
    solver["static"] = {{"frames", pair.solver == "static" ? 1 : 20}};
    solver["end"] = d.end();
  }
  solver["threads"] = 1;
  if (pair.is_implicit()) solver["max_steps"] = most_solves;
  if (pair.is_explicit() || pair.solver == "rest") solver["max_steps"] = most_steps;
}

void does_not_apply(Draft& d, const Pair& pair, const char* why) {
  d.trial.model = pair.material.name;
  d.trial.solver = pair.solver;
  d.trial.title = why;
}

Json smooth(double to) { return {{"from", 0}, {"to", to}, {"shape", "smooth"}}; }

// ------------------------------------------------------------------ measures --

Selection node_at(const Vec3& point) {
  Selection selection;
  selection.what = Selection::Nearest{point};
  return selection;
}

Values strain_at(Simulation& simulation, const Vec3& node, const Vec3& size) {
  const Vec3 u = simulation.mean_displacement(node_at(node));
  return {u[0] / size[0], u[1] / size[1], u[2] / size[2]};
}

Values shape_of(Simulation& simulation, double length) {
  Values values;
  const Column& x = simulation.attributes().position();
  for (Index v = 0; v < simulation.attributes().vertex_count(); ++v)
    for (int a = 0; a < 3; ++a) values.push_back(x.get(v, a) / length);
  return values;
}

double largest_displacement(Simulation& simulation) {
  Attributes& all = simulation.attributes();
  double largest = 0;
  for (Index v = 0; v < all.vertex_count(); ++v)
    for (int a = 0; a < 3; ++a) {
      const double u = std::abs(all.position().get(v, a) - all.rest().get(v, a));
      if (!(u <= largest)) largest = u;
    }
  return largest;
}

Values drift_of(Simulation& simulation, const Vec3& size, double length) {
  Attributes& all = simulation.attributes();
  Values sum(3);
  double total = 0;
  for (Index v = 0; v < all.vertex_count(); ++v) {
    const double mass = all.mass().get(v, 0);
    total += mass;
    for (int a = 0; a < 3; ++a) sum[static_cast<std::size_t>(a)] += mass * all.position().get(v, a);
  }
  for (std::size_t a = 0; a < 3; ++a) sum[a] = (sum[a] / total - size[a] / 2) / length;
  return sum;
}

}  // namespace suture::test
