// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bodies at rest before a motion begins, numbers that are not finite, and balances that do not
// close: what a run says of them, and how many steps it makes.
#include <cmath>

#include "kernel/run/simulation.hpp"
#include "tests/stability/draft.hpp"
#include "tests/stability/stress_parts.hpp"

namespace suture::test {

std::vector<Family> quiet_families();

namespace {

// ------------------------------------------------------------- bodies at rest --

/// naive_laws.cpp
const std::vector<std::string> naive_laws{"naive-neo-hookean", "naive-yeoh", "naive-fung"};

std::vector<std::string> all_laws() {
  std::vector<std::string> names = material_names();
  names.insert(names.end(), naive_laws.begin(), naive_laws.end());
  return names;
}
bool is_naive(const Material& m) { return m.name.starts_with("naive-"); }

Json naive_entry(const Material& m) {
  const double mu = m.young / (2 * (1 + m.poisson)),
               lambda = 2 * mu * m.poisson / (1 - 2 * m.poisson);
  return {{"model", m.name}, {"parameters", {{"mu", mu}, {"lambda", lambda}, {"rho", m.density}}}};
}

Pair pair_at_rest(Draft& d) {
  const std::vector<std::string> laws = all_laws();
  Pair pair;
  Material& m = pair.material;
  m.name = laws[d.index % laws.size()];
  m.young = d.random.pick(std::vector<double>{1, 1e3, 1e4, 1e6, 1e9});
  m.poisson = d.random.pick(std::vector<double>{0, 0.3, 0.45, 0.49});
  m.density = d.random.pick(std::vector<double>{1000, 1060, 1});
  if (!has_poisson(m.name)) m.poisson = 0.25;
  pair.solver = solver_names()[d.index / laws.size() % solver_names().size()];
  return pair;
}

/// Nothing moves for 5 to 50 periods, then the far end does.
void still(Draft& d) {
  const Pair pair = pair_at_rest(d);
  std::vector<std::string> bodies{"bar", "block", "slab"};
  if (!is_lattice(pair.material.name))
    bodies.insert(bodies.end(), {"sheared", "general", "graded", "corner"});
  const double scale = d.random.pick(std::vector<double>{1, 0.1, 0.3, 1e-3, 1e3});
  const Body body = make_body(d.random.pick(bodies), scale, d.random);
  const double wait = d.random.decades(5, 50), moving = d.random.between(5, 10);
  begin(d, pair, body, wait + moving + 1, 0);
  d.trial.mesh = body.file;
  if (is_naive(pair.material)) d.trial.scene["models"] = Json::array({naive_entry(pair.material)});
  d.trial.title = pair.material.name + " " + pair.solver + " " + body.name;
  d.trial.model.clear();  // judged as a load
  d.trial.solver.clear();
  d.trial.expected = Expected::quiet;
  d.fix(0);
  const double begins = wait * d.period();
  d.move(1, {{"translation", {d.random.between(-0.02, 0.05) * body.length(), 0, 0}}},
         {{"from", begins}, {"to", begins + moving * d.period()}, {"shape", "smooth"}});
  d.trial.stable = stable_step_of(d.trial);
  if (!pair.moves() && pair.solver != "rest") return;
  d.trial.quiet = 0.98 * begins;
  const Json& solver = d.trial.scene["solver"];
  const double dt = solver.contains("dt") ? solver["dt"].get<double>() : 0.8 * d.trial.stable;
  d.trial.quiet_steps = 2 + 1.05 * d.trial.quiet / dt;
}

// ------------------------------------------------- numbers that are not finite --

void choose_solver(Draft& d) {
  Json& solver = d.trial.scene["solver"];
  const double steps = d.random.between(200, 600), step = d.trial.stable;
  solver["end"] = 0.5 * steps * step;
  switch (static_cast<int>(d.random.between(0, 4))) {
    case 0:
      solver["integrator"] = "implicit-euler";
      solver["dt"] = 5 * step;
      break;
    case 1:
      if (d.random.chance(0.5)) {
        solver.erase("integrator");
        solver.erase("dt");
        solver["static"] = {{"frames", 4}};
      }
      break;
    default:
      break;  // explicit, with a fixed dt or "auto"
  }
}

/// One force, energy, field or state is not finite, for a while or to the end; most are forces on
/// held nodes.
void not_finite(Draft& d) {
  d.choose({"bar", "block", "slab", "corner", "graded", "sheared", "general"}, {0, 0.25, 0.3, 0.45},
           true);
  choose_solver(d);
  d.fix(0);
  const double end = d.trial.scene["solver"]["end"];
  if (d.random.chance(0.5))
    d.move(1, {{"translation", {0.01 * d.body.length(), 0, 0}}}, end);
  else
    d.gravity(0, 0.01, false);
  const std::vector<std::string> places{"force", "force", "force", "energy", "field", "state"};
  const std::vector<std::string> values{"nan", "inf", "-inf"};
  const bool is_first = d.random.chance(0.7);  // at x = 0
  const int elements = d.body.cells[0] * d.body.cells[1] * d.body.cells[2] / 2,
            lowest = d.body.file.empty() ? 0 : 1,  // its number
      element = lowest + (is_first ? 0 : static_cast<int>(d.random.between(0, elements)));
  const std::string place = d.random.pick(places), value = d.random.pick(values);
  // The last step of a fixed length may end before; states are those of its start.
  const bool is_last =
      d.random.chance(0.2) && place != "state" && !d.trial.scene["solver"].contains("dt");
  const Json& solver = d.trial.scene["solver"];
  const bool is_brief = place == "force" && !solver.contains("static") && d.random.chance(0.9);
  const double lasts = is_brief ? 2 * solver.value("dt", d.trial.stable) : 2 * end;
  d.trial.scene["models"].push_back(
      {{"model", "not-finite"},
       {"parameters",
        {{"what", place},
         {"element", element},
         {"node", static_cast<int>(d.random.between(0, 4)) * (is_first ? 2 : 1)},
         {"component", static_cast<int>(d.random.between(0, 3))},
         {"from", (is_last ? 0.999 : d.random.between(0.1, 0.95)) * end},
         {"lasts", lasts},
         {"value", value}}}});
  d.trial.expected = Expected::wrong;
  d.note(place + " " + value);
  if ((place == "force" || place == "energy") && d.random.chance(0.8)) return;  // no output
  d.trial.scene["output"] = {
      {"directory", "out/" + d.trial.name},
      {"frames", false},
      {"energies", {{"every_steps", 3}}},
      {"probes",
       {{"every_steps", 5},
        {"at", {{{"name", "all"}, {"where", "all"}, {"fields", {"reaction", "mark", "age"}}}}}}}};
}

// --------------------------------------------------- balances that do not close --

/// A cube between rollers, pulled at once: the oscillator m x'' = f - k x.
struct Oscillator {
  double m, k, f, x = 0, v = 0;

  void step(const std::string& integrator, double h) {
    const double a = (f - k * x) / m;
    if (integrator == "implicit-euler") {
      v = (v + h * a) / (1 + h * h * k / m);
      x += h * v;
    } else {  // Newmark's with beta 1/4
      const double next = (f - k * (x + h * v + h * h / 4 * a)) / (m + h * h / 4 * k);
      x += h * v + h * h / 4 * (a + next);
      v += h / 2 * (a + next);
    }
  }
  double energy() const { return (m * v * v + k * x * x) / 2 - f * x; }
};

void swing(Draft& d) {
  const double young = d.random.decades(1e3, 1e6), density = 1000,
               size = d.random.decades(0.01, 10);
  Material material;
  material.name = "hooke";
  material.young = young;
  material.poisson = 0;
  material.density = density;
  d.start(box({1, 1, 1}, {1, 1, 1}, size), material, 1);
  Oscillator o{density * size * size * size / 2, young * size, 0.01 * young * size * size};
  const std::string integrator = d.random.chance(0.7) ? "implicit-euler" : "newmark";
  const double h = d.random.decades(3e-3, 1) * std::sqrt(o.m / o.k);
  const int steps = static_cast<int>(d.random.decades(5, 500));
  d.trial.scene["constraints"] = {{{"fix", "x"}, {"where", {{"set", "x0"}}}},
                                  {{"fix", "yz"}, {"where", "all"}}};
  d.load("traction", {0.01 * young, 0, 0});
  d.trial.scene["solver"] = {
      {"integrator", integrator}, {"dt", h}, {"end", h * steps}, {"threads", 1}};
  for (int i = 0; i < steps; ++i) o.step(integrator, h);
  const double scale = o.f * o.f / o.k;
  d.trial.check.measure = [scale](Simulation& s) {
    return Values{1 + s.built().dynamics().balance().balance / scale};
  };
  d.trial.check.expected = {1 + o.energy() / scale};
  d.trial.check.tolerance = 1e-6;
  d.trial.is_conservative = false;  // judged by the check
  d.trial.title = integrator + ", h omega " + std::to_string(h * std::sqrt(o.k / o.m)) + ", " +
                  std::to_string(steps) + " steps";
}

}  // namespace

std::vector<Family> quiet_families() {
  const auto pairs = static_cast<unsigned>(all_laws().size() * solver_names().size());
  std::vector<Family> list{
      {"still", 2 * pairs, still}, {"not-finite", 80, not_finite}, {"swing", 40, swing}};
  for (std::size_t i = 0; i < 2; ++i) list[i].needs_test_plugins = true;
  return list;
}

}  // namespace suture::test
