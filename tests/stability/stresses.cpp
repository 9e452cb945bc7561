// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every model under every stress with every solver. Loads are in E and times in the period of the
// body, as in families.cpp; what is measured has no units.
#include "tests/stability/stresses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/run/simulation.hpp"
#include "tests/stability/stress_parts.hpp"

namespace suture::test {
namespace {

/// Many equilibria of one problem: what is checked is that a run has found one, or says so.
constexpr const char* springs_buckle = "springs buckle";

// ---------------------------------------------------------------- closed forms --

void hold_on_rollers(Draft& d) {
  const char* components[] = {"x", "y", "z"};
  for (std::size_t a = 0; a < 3; ++a) {
    Vec3 normal{};
    normal[a] = 1;
    d.trial.scene["constraints"].push_back(
        {{"where", {{"plane", {{"point", {0, 0, 0}}, {"normal", normal}}}}},
         {"fix", components[a]}});
  }
}

/// Newmark's steps follow an error of 1e-3, and what they excite is not damped by them.
double precision(const Pair& pair) { return pair.solver == "newmark" ? 1e-3 : 1e-5; }

/// Every element has the same stretches, which follow from the law alone.
void tension(Draft& d, const Pair& pair, const Body& body, double part, bool sudden = false) {
  hold_on_rollers(d);
  d.load("traction", {part * d.young, 0, 0}, sudden ? Json() : smooth(5 * d.period()));
  const Vec3 size = body.size;
  Material unit = pair.material;
  unit.young = 1;
  const Vec3 stretch = stretch_under(unit, edges_of(body), part);
  d.trial.check.measure = [size](Simulation& s) { return strain_at(s, size, size); };
  d.trial.check.expected = {stretch[0] - 1, stretch[1] - 1, stretch[2] - 1};
  d.trial.check.tolerance = precision(pair);
}

const Body& bar() {
  static const Body body = box({4, 2, 2}, {4, 2, 2}, 0.25);
  return body;
}

void poisson(Draft& d, double nu) {
  Pair pair = pair_of(d);
  if (!has_poisson(pair.material.name))
    return does_not_apply(d, pair, "the model's Poisson's ratio is 1/4");
  pair.material.poisson = nu;
  begin(d, pair, bar(), settling, damped);
  tension(d, pair, bar(), 0.02);
}

void aspect(Draft& d, const Body& body) {
  const Pair pair = pair_of(d);
  begin(d, pair, body, settling / 2, damped);
  tension(d, pair, body, 0.02);
  if (is_lattice(pair.material.name)) d.trial.excuse = "springs are for boxes that are near cubes";
  d.trial.check.tolerance = 1e-3;  // slow modes of flat elements last
}

void single(Draft& d) {
  const Pair pair = pair_of(d);
  const Body body = box({1, 1, 1}, {1, 1, 1});
  begin(d, pair, body, settling, damped);
  tension(d, pair, body, 0.1);
}

void squeeze(Draft& d) {
  const Pair pair = pair_of(d);
  begin(d, pair, bar(), 10 + settling, damped);
  const double left = 0.2, size = bar().length();
  d.fix(0);
  d.trial.scene["constraints"].push_back({{"where",
                                           {{"box",
                                             {{"min", {0.1 * bar().edge(0), -size, -size}},
                                              {"max", {size - 0.1 * bar().edge(0), size, size}}}}}},
                                          {"fix", "yz"}});
  d.move(1, {{"translation", {(left - 1) * size, 0, 0}}}, smooth(10 * d.period()));
  Material unit = pair.material;
  unit.young = 1;
  const double volume = bar().size[0] * bar().size[1] * bar().size[2], young = d.young;
  d.trial.check.measure = [=](Simulation& s) {
    return Values{s.energies().elastic / (young * volume),
                  s.mean_displacement(node_at({size / 2, 0, 0}))[0] / size};
  };
  d.trial.check.expected = {energy_density(unit, edges_of(bar()), {left, 1, 1}), (left - 1) / 2};
  d.trial.check.tolerance = 10 * precision(pair);
  if (pair.material.name == "damage") d.trial.check.tolerance = 5e-3;  // of the last swings
  if (pair.material.name.starts_with("tm-faure"))
    d.trial.excuse = "St Venant-Kirchhoff softens below a stretch of 0.577";
  if (pair.material.name == "mooney-rivlin")
    d.trial.excuse = "the energy is finite where an element is pressed flat";
  if (!is_lattice(pair.material.name)) return;
  d.trial.excuse = springs_buckle;
  d.trial.check = {};
}

void denormal_load(Draft& d) {
  const Pair pair = pair_of(d);
  begin(d, pair, bar(), settling, damped);
  tension(d, pair, bar(), 1e-3);
  d.trial.scene["loads"][0]["traction"] = {1e-312 * d.young, 0, 0};
  const Vec3 size = bar().size;
  d.trial.check.measure = [size](Simulation& s) {
    Values strain = strain_at(s, size, size);
    for (double& e : strain) e += 1;
    return strain;
  };
  d.trial.check.expected = {1, 1, 1};
  d.trial.check.tolerance = 1e-14;
  d.trial.excuse = "forces are below the smallest normal number";
}

void denormal_size(Draft& d) {
  const Pair pair = pair_of(d);
  const Body body = box({4, 2, 2}, {4, 2, 2}, 1e-104);
  begin(d, pair, body, settling, damped);
  tension(d, pair, body, 0.02);
  d.trial.excuse = "volumes and masses are below the smallest normal number";
}

// ------------------------------------------------------------------- scaling --

void cantilever_of(Draft& d, Pair pair, double size, double young) {
  pair.material.young = young;
  const Body body = box({4, 2, 2}, {4, 2, 2}, size / 4);
  begin(d, pair, body, 3, 0, pair.is_explicit() ? 0.01 : 0.05);
  d.fix(0);
  d.load("traction", {0, 5e-3 * young, 0}, smooth(d.period()));
  Json& solver = d.trial.scene["solver"];
  if (pair.solver == "rest") solver["tolerance"] = 1e-12;
  if (solver.contains("static")) solver["static"]["tolerance"] = 1e-12;
  d.trial.check.measure = [size](Simulation& s) { return shape_of(s, size); };
  d.trial.check.tolerance = pair.is_implicit() ? 1e-8 : 1e-12;  // that of Newton's method
}

void scaled(Draft& d, double size, double young) {
  Draft unit = d;
  cantilever_of(unit, pair_of(d), 1, 1);
  cantilever_of(d, pair_of(d), size, young);
  d.trial.check.reference = std::make_shared<Trial>(unit.trial);
}

// --------------------------------------------------------------------- steps --

/// A sudden pull: the end swings to twice its stretch at rest, and not beyond.
void step(Draft& d, double factor) {
  const Pair pair = pair_of(d);
  if (!pair.moves() && pair.solver != "rest") return does_not_apply(d, pair, "has no time step");
  begin(d, pair, bar(), settling, 0);
  tension(d, pair, bar(), 1e-3, true);
  d.trial.stable = stable_step_of(d.trial);
  Json& solver = d.trial.scene["solver"];
  solver["dt"] = factor * d.trial.stable;
  const bool is_stable = pair.is_implicit() || factor < 1;
  if (pair.moves()) {
    solver["end"] = (pair.is_implicit() ? 300 : 2000) * factor * d.trial.stable;
    d.trial.check.looks = 100;
    d.trial.check.expected = {2.4 * d.trial.check.expected[0]};
    const Vec3 size = bar().size;
    d.trial.check.measure = [size](Simulation& s) { return Values{strain_at(s, size, size)[0]}; };
  }
  if (!is_stable) d.trial.expected = factor < 1.2 ? Expected::warned : Expected::wrong;
}

/// Undamped. A million of Newmark's steps take minutes: one model makes them.
void many_steps(Draft& d, double steps) {
  const Pair pair = pair_of(d);
  if (!pair.moves()) return does_not_apply(d, pair, "has no time step");
  if (pair.solver == "newmark" && steps > 1e5 && pair.material.name != "hooke")
    return does_not_apply(d, pair, "see steps-10000");
  const Body body = box({2, 1, 1}, {2, 1, 1}, 0.5);
  begin(d, pair, body, settling, 0);
  tension(d, pair, body, 0.01, true);
  d.trial.stable = stable_step_of(d.trial);
  Json& solver = d.trial.scene["solver"];
  const double dt = (pair.is_implicit() ? 1 : 0.8) * d.trial.stable;
  if (pair.is_implicit()) solver["dt"] = dt;
  solver["end"] = steps * dt;
  solver["max_steps"] = 3 * static_cast<std::uint64_t>(steps);
  d.trial.is_conservative = true;
  d.trial.allowed_growth = 0.02 * 10'000 / steps;
  d.trial.check = {};
}

// ------------------------------------------------------ against another solver --

/// The same problem, solved in another way.
void compare_with(Draft& d, const std::string& solver, void (*make)(Draft&, const Pair&)) {
  Draft other = d;
  Pair pair = pair_of(d);
  make(d, pair);
  pair.solver = solver;
  make(other, pair);
  d.trial.check.reference = std::make_shared<Trial>(other.trial);
}

void turn_end(Draft& d, const Pair& pair) {
  const Body body = box({8, 2, 2}, {8, 2, 2}, 0.125);
  begin(d, pair, body, 10 + settling, damped);
  d.fix(0);
  d.move(1,
         {{"rotation",
           {{"axis", {1, 0, 0}},
            {"angle", 360},
            {"centre", {0, body.size[1] / 2, body.size[2] / 2}}}}},
         smooth(10 * d.period()));
  const double energy = d.young * body.size[0] * body.size[1] * body.size[2];
  const Vec3 middle{body.size[0] / 2, 0, 0};
  d.trial.check.measure = [=](Simulation& s) {
    const Vec3 u = s.mean_displacement(node_at(middle));
    return Values{s.energies().elastic / energy, u[0], u[1], u[2]};
  };
  d.trial.check.tolerance = 1e-3;
}

void full_twist(Draft& d) {
  const Pair pair = pair_of(d);
  compare_with(d, pair.solver == "quasi-static" ? "rest" : "quasi-static", turn_end);
  if (pair.material.name == "hooke") {  // linear: what does not move at the ends does not move
    d.trial.excuse = "Hooke's law is for small rotations";
    const auto measure = d.trial.check.measure;
    d.trial.check.measure = [measure](Simulation& s) {
      Values values = measure(s);
      for (double& value : values) value += 1;
      return values;
    };
    d.trial.check.reference.reset();
    d.trial.check.expected = {1, 1, 1, 1};
  }
  if (pair.material.name == "mss-baudet") {
    d.trial.excuse = springs_buckle;
    d.trial.check = {};
  }
}

void press(Draft& d, const Pair& pair) {
  const Body body = box({3, 3, 3}, {3, 3, 3}, 1.0 / 3);
  begin(d, pair, body, 10 + settling, damped);
  d.fix(0);
  d.move(1, {{"translation", {-0.8 * body.length(), 0, 0}}}, smooth(10 * d.period()));
  const double length = body.length();
  d.trial.check.measure = [length](Simulation& s) { return shape_of(s, length); };
  d.trial.check.tolerance = 1e-3;
}

void crush(Draft& d) {
  compare_with(d, pair_of(d).solver == "quasi-static" ? "static" : "quasi-static", press);
  d.trial.excuse = "corners of the clamps turn inside out";
}

// ---------------------------------------------------------------- wild starts --

/// Random positions: about half of the elements begin inside out.
void tangle(Draft& d) {
  const Pair pair = pair_of(d);
  begin(d, pair, bar(), 2 * settling, damped / 2);
  d.fix(0);
  d.trial.excuse = "an element may stay inside out";
  Random random = d.random;
  const double length = bar().length(), most = 0.7 * bar().edge(0);
  d.trial.begin = [random, most](Simulation& s) {
    s.change_motion([random, most](Attributes& all) mutable {
      for (Index v = 0; v < all.vertex_count(); ++v)
        for (int a = 0; a < 3; ++a)
          all.position().set(v, a, all.position().get(v, a) + random.between(-most, most));
    });
  };
  d.trial.check.measure = [length](Simulation& s) {
    return Values{1 + largest_displacement(s) / length};
  };
  d.trial.check.expected = {1};
  d.trial.check.tolerance = 10 * precision(pair);
}

/// Random velocities without momentum: the body vibrates.
void shake(Draft& d, double most) {
  Random random = d.random;
  d.trial.begin = [random, most](Simulation& s) {
    s.change_motion([random, most](Attributes& all) mutable {
      Vec3 momentum{};
      double total = 0;
      for (Index v = 0; v < all.vertex_count(); ++v) {
        total += all.mass().get(v, 0);
        for (int a = 0; a < 3; ++a) {
          all.velocity().set(v, a, random.between(-most, most));
          momentum[static_cast<std::size_t>(a)] += all.mass().get(v, 0) * all.velocity().get(v, a);
        }
      }
      for (Index v = 0; v < all.vertex_count(); ++v)
        for (int a = 0; a < 3; ++a)
          all.velocity().set(
              v, a, all.velocity().get(v, a) - momentum[static_cast<std::size_t>(a)] / total);
    });
  };
}

// ---------------------------------------------------------------------- cuts --

Json plane_at(const Vec3& point, const Vec3& normal) {
  return {{"plane", {{"point", point}, {"normal", normal}}}};
}

/// A free body that vibrates, in a field of gravity: internal forces, before and after cuts, leave
/// the motion of its centre of mass to gravity. In n steps it falls by g dt^2 n (n + 1) / 2 where
/// positions move with the new velocities, by g (n dt)^2 / 2 otherwise.
void fall(Draft& d, const Pair& pair, const Body& body, double end) {
  begin(d, pair, body, end, 0, pair.is_explicit() ? 0.02 : 0.05);
  const double g = 0.1 * d.young / (d.density * body.length());
  d.trial.scene["gravity"] = {0, -g, 0};
  shake(d, 0.05 * std::sqrt(d.young / d.density));
  if (!pair.moves()) {
    d.trial.excuse = "nothing holds the body";
    d.trial.begin = {};
    d.trial.check.expected = {std::numeric_limits<double>::quiet_NaN()};
    d.trial.check.measure = [](Simulation&) { return Values{0}; };
    return;
  }
  const double dt = d.trial.scene["solver"]["dt"], steps = std::round(d.end() / dt);
  const double way = g * dt * dt * steps * (steps + (pair.is_euler() ? 1 : 0)) / 2;
  const Vec3 size = body.size;
  d.trial.check.measure = [=](Simulation& s) { return drift_of(s, size, way); };
  d.trial.check.expected = {0, -1, 0};
  d.trial.check.tolerance = 1e-6;
}

void cut_in_the_air(Draft& d) {
  const Body body = box({4, 4, 4}, {4, 4, 4}, 0.25);
  fall(d, pair_of(d), body, 5);
  for (const double time : {1.0, 2.0, 2.5}) {
    Vec3 normal{};
    for (double& n : normal) n = d.random.between(-1, 1);
    d.event(time * d.period(), {{"cut", plane_at({0.5, 0.5, 0.5}, normal)}});
  }
}

void crumble(Draft& d) {
  const Body body = box({4, 1, 1}, {4, 1, 1}, 0.25);
  fall(d, pair_of(d), body, 5);
  for (const double x : {0.25, 0.5, 0.75})
    d.event(4 * x * d.period(), {{"cut", plane_at({x, 0, 0}, {1, 0, 0})}});
}

/// Discs that open about a third of the faces.
void cut_often(Draft& d, unsigned count, double begin, double end) {
  const double r = 0.12 * d.body.edge(0);
  for (unsigned i = 0; i < count; ++i) {
    Vec3 point{}, normal{};
    for (std::size_t a = 0; a < 3; ++a) {
      point[a] = d.random.between(0, d.body.size[a]);
      normal[a] = d.random.between(-1, 1);
    }
    Json disc = plane_at(point, normal);
    disc["plane"]["radius"] = r;
    d.event(d.random.between(begin, end) * d.period(), {{"cut", disc}, {"shape", "rest"}});
  }
}

/// A stretched body, and pieces that nothing holds: its equilibrium does not depend on when the
/// cuts were made. One equilibrium has all of them at its start.
void stretch_and_cut(Draft& d, const Pair& pair) {
  const Body body = box({6, 3, 3}, {6, 3, 3}, 1.0 / 6);
  begin(d, pair, body, 10, 0);
  Json& solver = d.trial.scene["solver"];
  if (solver.contains("static")) solver["static"]["free_pieces"] = "hold";
  d.fix(0);
  d.move(1, {{"translation", {0.05 * body.length(), 0, 0}}}, 10 * d.period());
  cut_often(d, 1000, 0, pair.solver == "static" ? 1e-3 : 9.4);
  const double energy = d.young * body.size[0] * body.size[1] * body.size[2];
  d.trial.check.measure = [energy](Simulation& s) { return Values{s.energies().elastic / energy}; };
  d.trial.check.tolerance = 1e-5;
}

void thousand_cuts(Draft& d) {
  const Pair pair = pair_of(d);
  if (!pair.moves())
    return compare_with(d, pair.solver == "static" ? "quasi-static" : "static", stretch_and_cut);
  fall(d, pair, box({6, 3, 3}, {6, 3, 3}, 1.0 / 6), 5);
  cut_often(d, 1000, 0, 5);
}

}  // namespace

std::string stress_trial_name(const std::string& stress, unsigned index) {
  const auto solvers = static_cast<unsigned>(solver_names().size());
  return stress + '.' + material_names()[index / solvers] + '.' + solver_names()[index % solvers];
}

std::vector<Family> stress_families() {
  const auto size = static_cast<unsigned>(material_names().size() * solver_names().size());
  std::vector<Family> list;
  const auto add = [&](const char* name, auto make, const char* what, const char* law) {
    list.push_back({name, size, make, law, what});
  };
  constexpr const char* bounded = "swings to twice the stretch at rest";
  for (const auto& [name, factor] : {std::pair{"step-0.1", 0.1},
                                     {"step-0.9", 0.9},
                                     {"step-1.05", 1.05},
                                     {"step-2", 2.0},
                                     {"step-10", 10.0}})
    add(
        name, [factor = factor](Draft& d) { step(d, factor); }, "a fixed step over the stable one",
        bounded);
  add(
      "steps-10000", [](Draft& d) { many_steps(d, 1e4); }, "undamped steps",
      "energy grows by less than 2 %");
  add(
      "steps-1000000", [](Draft& d) { many_steps(d, 1e6); }, "undamped steps",
      "energy grows by less than 2 %");
  list.back().is_long = true;
  constexpr const char* homogeneous = "stretches of the law";
  for (const auto& [name, nu] : {std::pair{"nu-0", 0.0},
                                 {"nu-0.25", 0.25},
                                 {"nu-0.4", 0.4},
                                 {"nu-0.49", 0.49},
                                 {"nu-0.499", 0.499},
                                 {"nu-0.4999", 0.4999}})
    add(
        name, [nu = nu](Draft& d) { poisson(d, nu); }, "Poisson's ratio", homogeneous);
  add(
      "needles",
      [](Draft& d) {
        aspect(d, box({4, 1e-3, 1e-3}, {4, 1, 1}, 0.25));
      },
      "elements of 1000:1:1", homogeneous);
  add(
      "plates",
      [](Draft& d) {
        aspect(d, box({2, 1e-3, 2}, {2, 1, 2}, 0.5));
      },
      "elements of 1000:1000:1", homogeneous);
  add("single", single, "one element", homogeneous);
  add("squeeze", squeeze, "to 20 % of the length, sides held", "energy of the law, positions");
  add("denormal-load", denormal_load, "a load of 1e-312 E", "no displacement but rounding");
  add("denormal-size", denormal_size, "elements of 1e-104 m", homogeneous);
  constexpr const char* scaling = "the unit scene, scaled";
  add(
      "1um", [](Draft& d) { scaled(d, 4e-6, 1); }, "elements of 1 um", scaling);
  add(
      "1km", [](Draft& d) { scaled(d, 4e3, 1); }, "elements of 1 km", scaling);
  add(
      "E-1e-3", [](Draft& d) { scaled(d, 1, 1e-3); }, "Young's modulus", scaling);
  add(
      "E-1e12", [](Draft& d) { scaled(d, 1, 1e12); }, "Young's modulus", scaling);
  constexpr const char* other = "another solver";
  add("twist-360", full_twist, "a bar of 4:1, by 360 degrees", other);
  add("crush", crush, "a cube between two clamps, to 20 %", other);
  add("tangle", tangle, "random positions, half of the elements inverted", "the shape at rest");
  constexpr const char* centre = "fall of the centre of mass";
  add("fall-cut", cut_in_the_air, "three cuts through a block that falls and vibrates", centre);
  add("crumble", crumble, "a falling bar cut into single elements", centre);
  add("cuts-1000", thousand_cuts, "1,000 cuts at random times",
      "fall of the centre of mass; cuts made first");
  return list;
}

}  // namespace suture::test
