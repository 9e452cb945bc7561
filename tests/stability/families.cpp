// SPDX-License-Identifier: GPL-3.0-or-later
//
// Loads in E and times in the body's own period, so that strains stay where St
// Venant-Kirchhoff is a law (formulas.md, 6.3: stretches of 0.58 to sqrt(1 + 1/nu)) and the
// outcome is known for every size and stiffness.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/stability/draft.hpp"
#include "tests/stability/stresses.hpp"

namespace suture::test {

std::vector<Family> trial_families();  // trials.cpp
std::vector<Family> quiet_families();  // quiet.cpp

namespace {

constexpr double pi = 3.14159265358979323846;
const std::vector<std::string> slender{"bar", "thick-bar", "graded", "sheared", "corner"};
const std::vector<std::string> straight{"bar",     "thick-bar", "block", "graded",
                                        "sheared", "general",   "single"};
const std::vector<double> moderate_nus{0, 0.1, 0.25, 0.3, 0.45};

void say(Draft& d, const char* what, double value) {
  char text[80];
  std::snprintf(text, sizeof text, "%s %.3g", what, value);
  d.note(text);
}

/// A run at a quarter of the step is compared after 1.5 periods, where several elements carry the
/// motion: the phase of a mode is behind by (h w)^2/24 per radian.
void compare_early(Draft& d) {
  if (d.body.cells[0] >= 5) d.trial.compare = std::min(1.5 * d.period(), 0.1 * d.end());
}

// --------------------------------------------------------------- soft tissue --

void hang(Draft& d) {
  d.choose();
  d.fix(0);
  d.gravity(0, d.bearable(d.random.decades(0.02, 0.3)), d.random.chance(0.5));
  compare_early(d);
}

void stand(Draft& d) {
  d.choose({"block", "single", "bar", "general", "corner", "sheared", "thick-bar"});
  d.fix(0);
  const double stocky = std::pow(d.body.height() / d.body.length(), 2);
  const double bears = std::min(0.05, 0.25 * stocky);
  d.gravity(0, -d.bearable(d.random.between(0.2, 1) * bears), d.random.chance(0.5));
  compare_early(d);
}

void cantilever(Draft& d) {
  d.choose();
  d.fix(0);
  const double slenderness = d.body.height() / d.body.length();
  const double bears = std::min(0.2 * slenderness * slenderness, 0.05);
  d.gravity(1, -d.bearable(d.random.between(0.1, 1) * bears), d.random.chance(0.5));
  compare_early(d);
}

// ------------------------------------------------------------- dead tractions --

/// P / E of a bar in uniaxial stretch s.
double stress(double s) { return s * (s * s - 1) / 2; }

void traction(Draft& d) {
  d.choose(straight, {0, 0.1, 0.25, 0.3, 0.45, 0.49});
  const bool sudden = d.index % 4 < 2;
  const double nu = d.poisson;
  const double most = sudden ? (nu > 0.3 ? 1.15 : 1.25) : (nu > 0.3 ? 1.25 : 1.4);
  const double stretch = 1 + d.bearable(d.random.between(0.05, most - 1));
  d.fix(0);
  d.load("traction", {d.young * stress(stretch), 0, 0}, sudden ? Json() : d.slow_ramp());
  say(d, sudden ? "sudden stretch" : "ramped stretch", stretch);
  compare_early(d);
}

void compression(Draft& d) {
  d.choose({"block", "single", "general", "sheared", "bar"}, {0, 0.1, 0.25, 0.3, 0.45, 0.49});
  const double stocky = std::pow(d.body.height() / d.body.length(), 2);
  const bool sudden = d.random.chance(0.5);
  const double bears = std::min(0.05, (sudden ? 0.08 : 0.14) * stocky);  // Euler's: 0.2 stocky
  const double part = d.bearable(d.random.between(0.2, 1) * bears);
  d.fix(0);
  d.load("traction", {-d.young * part, 0, 0}, sudden ? Json() : d.slow_ramp());
  say(d, sudden ? "sudden p/E" : "ramped p/E", part);
  compare_early(d);
}

void axial(Draft& d) {  // waves in a bar without lateral motion
  d.choose({"bar", "thick-bar", "graded", "block", "single"}, {0, 0, 0.25});
  const double stocky = std::min(0.5, std::pow(d.body.height() / d.body.length(), 2));
  const double part = d.random.chance(0.5) ? d.bearable(d.random.between(0.02, 0.2))
                                           : -d.bearable(d.random.between(0.02, 0.08) * stocky);
  d.fix(0, d.random.chance(0.5) ? "xyz" : "x");
  d.load("force", {part * d.young * d.body.size[1] * d.body.size[2], 0, 0});
  say(d, "sudden p/E", part);
  compare_early(d);
}

void shear_load(Draft& d) {
  d.choose({"block", "general", "single", "bar", "sheared"}, moderate_nus);
  const double stocky = std::min(1.0, std::pow(d.body.height() / d.body.length(), 2));
  const double part = d.bearable(d.random.between(0.02, 0.06)) * stocky;
  const bool sudden = d.random.chance(0.5);
  d.fix(0);
  d.load("traction", {0, d.young * part, 0}, sudden ? Json() : d.slow_ramp());
  say(d, sudden ? "sudden t/E" : "ramped t/E", part);
  compare_early(d);
}

void pressure(Draft& d) {
  d.choose({"block", "bar", "general", "single", "sheared", "graded"}, moderate_nus);
  const bool sudden = d.random.chance(0.5), around = d.random.chance(0.4);
  const double stocky = std::min(1.0, std::pow(d.body.height() / d.body.length(), 2));
  const double part =
      d.bearable(around ? d.random.between(0.01, 0.08) : d.random.between(-0.1, 0.05 * stocky));
  const Json ramp = sudden ? Json() : d.slow_ramp();
  if (around)
    d.load_on("all", "pressure", part * d.young, ramp);
  else
    d.load("pressure", part * d.young, ramp);
  if (!around || d.random.chance(0.5)) d.fix(0);
  say(d, around ? "pressure around p/E" : "pressure p/E", part);
  compare_early(d);
}

// ----------------------------------------------------------- prescribed motion --

void stretch(Draft& d) {
  d.choose({"bar", "thick-bar", "block", "graded", "sheared", "general"});
  const double most = d.poisson > 0.45 ? 0.15 : d.poisson > 0.3 ? 0.3 : 0.6;
  const double part = d.bearable(d.random.between(0.1, 1) * most);
  const Json ramp = d.slow_ramp();
  d.fix(0);
  d.move(1, {{"translation", {part * d.body.length(), 0, 0}}}, ramp);
  say(d, "stretch", 1 + part);
  if (d.body.cells[0] >= 5) d.trial.compare = std::min(d.trial.settled, 0.1 * d.end());
}

void twist(Draft& d) {
  d.choose(slender);
  const double radius = 0.7 * d.body.height();
  const double strain = d.bearable(d.random.between(0.03, 0.3));
  const double angle = std::min(strain * d.body.length() / radius * 180 / pi, 170.0);
  d.fix(0);
  d.move(1,
         {{"rotation",
           {{"axis", {1, 0, 0}},
            {"angle", angle},
            {"centre", {0, d.body.size[1] / 2, d.body.size[2] / 2}}}}},
         d.slow_ramp());
  say(d, "twist in degrees", angle);
  if (d.body.cells[0] >= 5) d.trial.compare = std::min(d.trial.settled, 0.1 * d.end());
}

void bend(Draft& d) {
  d.choose({"bar", "thick-bar", "graded", "sheared", "flat"}, moderate_nus);
  const double strain = d.bearable(d.random.between(0.03, 0.15));
  const double angle = std::min(2 * strain * d.body.length() / d.body.height() * 180 / pi, 60.0);
  d.fix(0);
  d.move(1,
         {{"rotation",
           {{"axis", {0, 0, 1}},
            {"angle", angle},
            {"centre", {d.body.length() / 2, d.body.size[1] / 2, 0}}}}},
         d.slow_ramp());
  say(d, "bend in degrees", angle);
  if (d.body.cells[0] >= 5) d.trial.compare = std::min(d.trial.settled, 0.1 * d.end());
}

/// Ramps from a thousandth of a step to ten steps: a blow.
void blow(Draft& d) {
  d.choose({"bar", "block", "thick-bar", "corner", "sheared"});
  const double steps = d.random.decades(1e-3, 10), part = d.bearable(d.random.between(0.01, 0.1));
  d.fix(0);
  std::array<double, 3> way{};
  way[static_cast<std::size_t>(d.random.between(0, 3))] =
      (d.random.chance(0.5) ? 1 : -1) * part * d.body.edge(0);
  const double to = steps * d.trial.stable;
  d.move(1, {{"translation", way}},
         d.random.chance(0.5) ? Json(to) : Json{{"from", 0}, {"to", to}, {"shape", "smooth"}});
  say(d, "steps of the ramp", steps);
  say(d, "way per edge", part);
}

// ---------------------------------------------------------------- free bodies --

/// Turned by its end, then let loose.
void spin(Draft& d) {
  d.choose({"bar", "thick-bar", "sheared"}, {0, 0.1, 0.25, 0.3, 0.45, 0.49});
  const double speed = d.random.between(0.03, 0.2) * (d.is_springs() ? 0.4 : 1);
  const double turning = std::min(0.2 * d.end(), 10 * d.period());
  const bool smooth = d.random.chance(0.5);
  const double angle = speed / d.period() * turning / (smooth ? 1.5 : 1) * 180 / pi;
  Json ramp = turning;
  if (smooth) ramp = {{"from", 0}, {"to", turning}, {"shape", "smooth"}};
  d.move(0,
         {{"rotation",
           {{"axis", {0.1, 0.3, 1}},
            {"angle", angle},
            {"centre", {0.6 * d.body.length(), d.body.size[1] / 2, d.body.size[2] / 2}}}}},
         ramp);
  const double size = 10 * d.body.length();
  d.event((smooth ? 0.5 : 0.9) * turning,
          {{"pierce",
            {{"where",
              {{"box",
                {{"min", {-size, -size, -size}}, {"max", {1.01 * d.body.edge(0), size, size}}}}}}}},
           {"shape", "rest"}});
  say(d, "speed of the end over c", speed);
}

void fall(Draft& d) {
  d.choose();
  d.gravity(1, -d.bearable(d.random.decades(1e-4, 0.05)), d.random.chance(0.5));
  if (d.random.chance(0.5))
    d.load("force", {d.bearable(0.05) * d.young * d.body.size[1] * d.body.size[2], 0, 0});
  compare_early(d);
}

// --------------------------------------------------------------------- ratios --

void ratio(Draft& d) {
  d.choose({"bar", "block", "thick-bar", "corner"}, moderate_nus);
  const double factor =
      std::pow(10, (d.random.chance(0.5) ? 1 : -1) * (2 + static_cast<int>(d.index) % 5));
  const bool density = d.random.chance(0.5);
  Json& models = d.trial.scene["models"];
  Json other = models[0];
  const char* key = density ? "rho" : "E";
  other["parameters"][key] = factor * other["parameters"][key].get<double>();
  const auto side = [&](int sign) {
    return Json{
        {"half_space", {{"point", {0.5001 * d.body.length(), 0, 0}}, {"normal", {sign, 0, 0}}}}};
  };
  models[0]["region"] = side(-1);
  other["region"] = side(1);
  models.push_back(other);
  d.find_stable_step();
  d.fix(0);
  // The softer half bears the weight of the heavier one.
  const double bears = 0.03 / (density ? std::max(1.0, factor) : std::max(1.0, 1 / factor));
  d.gravity(static_cast<int>(d.random.between(0, 2)), d.bearable(0.3 * bears),
            d.random.chance(0.5));
  say(d, density ? "density ratio" : "stiffness ratio", factor);
  compare_early(d);
}

// --------------------------------------------------------------------- events --

/// Moves, moderately.
void stir(Draft& d) {
  d.fix(0);
  const double slenderness = std::min(1.0, d.body.height() / d.body.length());
  switch (static_cast<int>(d.random.between(0, 3))) {
    case 0:
      return d.gravity(0, d.bearable(d.random.between(0.01, 0.05)), d.random.chance(0.5));
    case 1:
      return d.gravity(1, -d.bearable(0.04 * slenderness * slenderness), d.random.chance(0.5));
    default:
      d.move(1, {{"translation", {d.bearable(0.08) * d.body.length(), 0, 0}}}, d.slow_ramp());
  }
}

double some_time(Draft& d) { return d.random.between(0.02, 0.4) * d.end(); }

Json some_plane(Draft& d) {
  std::array<double, 3> point{}, normal{};
  for (std::size_t a = 0; a < 3; ++a) {
    point[a] = d.random.between(0.2, 0.8) * d.body.size[a];
    normal[a] = d.random.between(-1, 1);
  }
  return {{"point", point}, {"normal", normal}};
}

const std::vector<std::string> cuttable{"bar",    "block",   "thick-bar", "slab", "corner",
                                        "graded", "sheared", "general",   "flat"};

void cut(Draft& d) {
  d.choose(cuttable, {0, 0.1, 0.25, 0.3, 0.45, 0.49});
  stir(d);
  const int count = 1 + static_cast<int>(d.random.between(0, 5));
  for (int i = 0; i < count; ++i) d.event(some_time(d), {{"cut", {{"plane", some_plane(d)}}}});
  say(d, "cuts", count);
}

void pierce(Draft& d) {
  d.choose(cuttable, {0, 0.1, 0.25, 0.3, 0.45, 0.49});
  stir(d);
  const int count = 1 + static_cast<int>(d.random.between(0, 3));
  for (int i = 0; i < count; ++i) {
    const double y = d.random.between(0.2, 0.8) * d.body.size[1];
    const double x = d.random.between(0.2, 0.8) * d.body.size[0];
    d.event(some_time(d), {{"pierce",
                            {{"path", {{x, y, -d.body.length()}, {x, y, 2 * d.body.length()}}},
                             {"radius", 0.6 * d.body.edge(0)}}}});
  }
  say(d, "needles", count);
}

/// Half of them torn where the recoil turns some elements inside out, which these scenes admit.
void tear(Draft& d) {
  d.choose({"bar", "block", "thick-bar", "graded", "sheared", "general"}, moderate_nus);
  const bool violent = d.random.chance(0.5);
  const double part =
      d.bearable(violent ? d.random.between(0.1, 0.25) : d.random.between(0.03, 0.1));
  if (violent) d.trial.scene["solver"]["on_inversion"] = "warn";
  d.fix(0);
  d.move(1, {{"translation", {part * d.body.length(), 0, 0}}}, d.slow_ramp());
  d.trial.scene["events"] = {{{"every", 1 + static_cast<int>(d.random.between(0, 8))},
                              {"tear",
                               {{"by", d.random.chance(0.5) ? "principal-strain" : "elongation"},
                                {"above", d.random.between(0.6, 1.2) * part},
                                {"most", 1}}}}};
  d.trial.is_smooth = false;
  say(d, "stretch", 1 + part);
}

void sew(Draft& d) {
  d.choose(cuttable, moderate_nus);
  d.fix(0);
  d.fix(1);
  const double slenderness = std::min(1.0, d.body.height() / d.body.length());
  d.gravity(1, -d.bearable(0.01 * slenderness * slenderness), d.random.chance(0.5));
  const double first = some_time(d), between = d.random.decades(0.1, 3) * d.period();
  d.event(first, {{"cut", {{"plane", some_plane(d)}}}});
  Json all = Json::object();
  if (d.random.chance(0.5)) all = {{"between", {"all", "all"}}, {"gap", 0.3 * d.body.edge(0)}};
  d.event(std::min(first + between, 0.5 * d.end()), {{"suture", all}});
}

void blade(Draft& d) {
  d.choose(cuttable, {0, 0.1, 0.25, 0.3, 0.45, 0.49});
  stir(d);
  const double begin = some_time(d), speed = d.random.decades(0.01, 0.3);
  const double length = d.body.length(), top = 1.2 * d.body.height() + 0.01 * length;
  const double finish = std::min(begin + 2 * top / length / speed * d.period(), 0.6 * d.end());
  const double x = d.random.between(0.2, 0.8) * length,
               slope = d.random.between(-0.2, 0.2) * length;
  const auto station = [&](double at, double y) {
    return Json{{"at", at}, {"points", {{x - slope, y, -length}, {x + slope, y, 2 * length}}}};
  };
  d.trial.scene["events"] = {
      {{"cut", {{"blade", {{"path", {station(begin, top), station(finish, -0.2 * top)}}}}}}}};
  d.settle(finish);
  d.trial.is_smooth = false;
  say(d, "blade speed over c", speed);
}

// ----------------------------------------------------------------------- rest --

void rest(Draft& d) {
  d.choose({"bar", "thick-bar", "block", "graded", "sheared", "general"}, moderate_nus);
  Json& solver = d.trial.scene["solver"];
  solver.erase("end");
  solver["until"] = "rest";
  solver["tolerance"] = d.random.pick(std::vector<double>{1e-6, 1e-4});
  d.fix(0);
  const double slenderness = std::min(1.0, d.body.height() / d.body.length());
  switch (d.index % 4) {
    case 0:
      return d.gravity(0, d.bearable(d.random.decades(0.01, 0.2)), d.random.chance(0.5));
    case 1:
      return d.gravity(1, -d.bearable(0.1 * slenderness * slenderness), d.random.chance(0.5));
    case 2:
      return d.load("traction",
                    {d.young * stress(1 + d.bearable(d.random.between(0.02, 0.3))), 0, 0});
    default: {
      const double most = d.poisson > 0.3 ? 0.1 : 0.4;  // corners of a clamp soften at 0.17
      const double part = d.bearable(d.random.between(0.02, most));
      say(d, "stretch", 1 + part);
      d.move(1, {{"translation", {part * d.body.length(), 0, 0}}},
             d.random.between(1, 20) * d.period());
    }
  }
}

// ---------------------------------------------------------------------- wrong --

/// A fixed step above the stable one.
void coarse(Draft& d) {
  d.choose();
  const double factor = std::vector<double>{1.05, 1.5, 2, 10}[d.index % 4];
  d.fix(0);
  d.trial.stable = stable_step_of(d.trial);  // a held end may be the one that limits it
  Json& solver = d.trial.scene["solver"];
  solver["dt"] = factor * d.trial.stable;
  solver["end"] = 2000 * factor * d.trial.stable;
  const double slenderness = std::min(1.0, d.body.height() / d.body.length());
  if (d.random.chance(0.5))
    d.gravity(0, d.bearable(0.05), d.random.chance(0.7));
  else
    d.gravity(1, -d.bearable(0.1 * slenderness * slenderness), d.random.chance(0.7));
  if (d.index % 8 >= 4) d.trial.scene["output"] = Json{{"directory", "out"}};
  d.trial.expected = factor < 1.2 ? Expected::warned : Expected::wrong;
  say(d, "dt over stable", factor);
}

/// Loads that the law does not bear.
void overload(Draft& d) {
  d.choose({"bar", "block", "general", "single", "sheared"}, moderate_nus, true);
  d.trial.scene["solver"]["end"] = 0.2 * d.end();
  d.trial.expected = Expected::wrong;
  d.fix(0);
  const double area = d.body.size[1] * d.body.size[2];
  switch (d.index % 6) {
    case 0:
      d.load("force", {1e300, 0, 0});
      return d.note("1e300 N");
    case 1:
      d.load("force", {0, d.random.decades(1e3, 1e30) * d.young * area, 0});
      return d.note("a huge force");
    case 2:
      d.load("traction", {-d.random.between(0.3, 1) * d.young, 0, 0});
      return d.note("compression beyond the law");
    case 3:
      return d.gravity(0, -d.random.between(1.5, 10), true);
    case 4:
      d.load_on("all", "pressure", d.random.between(1, 5) * d.young);
      return d.note("crushed from all sides");
    default:
      d.load("pressure", d.random.between(0.5, 5) * d.young);
      return d.note("crushed");
  }
}

}  // namespace

const std::vector<Family>& families() {
  static const std::vector<Family> all = [] {
    std::vector<Family> list{{"hang", 80, hang},
                             {"stand", 60, stand},
                             {"cantilever", 80, cantilever},
                             {"traction", 80, traction},
                             {"compression", 60, compression},
                             {"axial", 60, axial},
                             {"shear", 40, shear_load},
                             {"pressure", 60, pressure},
                             {"stretch", 80, stretch},
                             {"twist", 80, twist},
                             {"bend", 60, bend},
                             {"blow", 80, blow},
                             {"spin", 60, spin},
                             {"fall", 40, fall},
                             {"ratio", 60, ratio},
                             {"cut", 80, cut},
                             {"pierce", 60, pierce},
                             {"tear", 60, tear},
                             {"sew", 60, sew},
                             {"blade", 60, blade},
                             {"rest", 60, rest},
                             {"coarse", 80, coarse},
                             {"overload", 60, overload}};
    for (const Family& family : quiet_families()) list.push_back(family);
    for (const Family& family : trial_families()) list.push_back(family);
    for (const Family& family : stress_families()) list.push_back(family);
    return list;
  }();
  return all;
}

std::string trial_name(const Family& family, unsigned index) {
  if (family.is_stress()) return stress_trial_name(family.name, index);
  char number[8];
  std::snprintf(number, sizeof number, "-%03u", index);
  return family.name + number;
}

Trial make_trial(const Family& family, unsigned index, std::uint64_t seed) {
  Draft draft(family, index, seed);
  family.make(draft);
  draft.trial.law = family.law;
  if (family.is_stress() && draft.trial.title.empty()) draft.trial.title = family.what;
  return draft.trial;
}

}  // namespace suture::test
