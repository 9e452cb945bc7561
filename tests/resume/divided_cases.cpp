// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bodies that are large enough for several processes to step vertices of their own: these come in
// blocks of 4096.
#include "tests/resume/cases.hpp"

namespace suture::test {
namespace {

/// Through the middle part of a cube of 1 m.
Json plane(Random& random) {
  Json result{{"point", {random.between(0.2, 0.8), 0.5, random.between(0.3, 0.7)}},
              {"normal", {1, random.between(-0.5, 0.5), random.between(-0.5, 0.5)}}};
  if (random.chance(0.5)) result["radius"] = random.between(0.1, 0.5);
  return result;
}

Json operation(Random& random) {
  const double kind = random.number();
  if (kind < 0.5) return {{"cut", {{"plane", plane(random)}, {"along", "faces"}}}};
  if (kind < 0.7) return {{"cut", {{"plane", plane(random)}, {"along", "blade"}}}};
  if (kind < 0.85) {
    const double x = random.between(0.1, 0.9), z = random.between(0.1, 0.9);
    return {{"pierce", {{"path", {{x, -2, z}, {x, 2, z}}}, {"radius", 0.1}}}};
  }
  return {{"suture", Json::object()}};
}

/// Parallel cuts one after the other, whose new vertices make whole blocks.
void add_many_cuts(Json& events, Random& random, double end) {
  const int number = static_cast<int>(random.between(8, 20));
  const double slope = random.between(-0.3, 0.3);
  for (int i = 0; i < number; ++i)
    events.push_back({{"at", random.between(0, 0.7) * end},
                      {"cut",
                       {{"plane",
                         {{"point", {(i + 0.6) / (number + 0.2), 0.5, 0.5}},
                          {"normal", {1, slope, random.between(-0.1, 0.1)}}}},
                        {"along", "faces"}}}});
}

/// Holds nodes of several processes, and may release them.
void add_grasp(Json& events, Random& random, double end) {
  const double at = random.between(0, 0.6) * end;
  const Json motion{{"path",
                     {{{"at", 0}},
                      {{"at", random.between(0.2, 1) * end},
                       {"translation", {random.between(-0.1, 0.1), 0.05, 0}}}}}};
  const double from = random.between(0.3, 0.8);
  Json grasp{{"name", "hand"},
             {"where", {{"box", {{"min", {from, -100, -100}}, {"max", {100, 100, 100}}}}}}};
  if (random.chance(0.7)) grasp["move"] = motion;
  events.push_back({{"at", at}, {"grasp", grasp}});
  if (random.chance(0.6))
    events.push_back({{"at", at + random.between(0.1, 0.4) * end}, {"release", "hand"}});
}

Json models(Random& random) {
  const Json solid{{"model", "tm-faure"}, {"parameters", {{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}}}};
  const Json springs{{"model", "mss-baudet"},
                     {"parameters", {{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}}}};
  const Json one = Json::array({solid}), other = Json::array({springs}), both = {solid, springs};
  return random.pick(std::vector<Json>{one, one, other, both});
}

Json moved_side(Random& random, double end) {
  return {{"where", {{"set", "x1"}}},
          {"move",
           {{"path",
             {{{"at", random.between(0, 0.5) * end}},
              {{"at", random.between(0.6, 2) * end},
               {"translation", {random.between(-0.1, 0.1), random.between(-0.1, 0.1), 0}}}}}}}};
}

/// A volume needs whole elements.
Json load(Random& random, bool divides) {
  std::vector<Json> loads{
      {{"pressure", random.between(10, 1000)}, {"where", {{"set", "y1"}}}},
      {{"traction", {random.between(-300, 300), 0, 100}}, {"where", {{"set", "x1"}}}},
      {{"force", {0, random.between(-300, 300), 0}}, {"where", {{"set", "z0"}}}}};
  if (!divides) loads.push_back({{"volume", random.between(1e3, 1e4)}, {"where", "all"}});
  Json result = random.pick(loads);
  if (random.chance(0.3)) result["ramp"] = random.between(0.01, 0.1);
  return result;
}

/// A floor below, and a ball that is pushed into the upper side.
Json contact(Random& random, double end) {
  const Json floor{{"name", "floor"},
                   {"half_space", {{"point", {0, -0.01, 0}}, {"normal", {0, 1, 0}}}}};
  Json ball{{"name", "ball"},
            {"sphere", {{"centre", {0.5, 1.21, 0.5}}, {"radius", 0.2}}},
            {"path", {{{"at", 0}}, {{"at", end}, {"translation", {0.05, -0.1, 0}}}}}};
  if (random.chance(0.3))
    ball["coupling"] = {{"mass", random.decades(1, 100)}, {"stiffness", random.decades(1e3, 1e5)}};
  Json result{{"friction", random.between(0, 0.5)},
              {"pieces", random.chance(0.5)},
              {"obstacles", {floor, ball}}};
  if (result["pieces"]) result["self"] = random.chance(0.3);
  return result;
}

}  // namespace

Case divided(Random& random, unsigned index) {
  const double end = random.between(0.05, 0.15);
  Case result{"divided-" + std::to_string(index),
              {{"suture", 2},
               {"mesh", {{"box", {{"size", {1, 1, 1}}, {"cells", Json::array()}}}}},
               {"models", models(random)},
               {"gravity", {0, random.chance(0.1) ? -1e3 : -random.between(0, 10), 0}},
               {"constraints", {{{"where", {{"set", "x0"}}}, {"fix", "xyz"}}}},
               {"solver", {{"end", end}}}}};
  Json& scene = result.scene;
  for (int axis = 0; axis < 3; ++axis)
    scene["mesh"]["box"]["cells"].push_back(static_cast<int>(random.between(15, 23)));
  if (random.chance(0.3))
    scene["gravity"] = {{"value", scene["gravity"]},
                        {"ramp", {{"to", random.between(0, 1) * end}}}};
  if (random.chance(0.3)) scene["constraints"].erase(0);
  if (random.chance(0.5))
    scene["constraints"].push_back(moved_side(random, end));
  else if (random.chance(0.5))
    scene["constraints"].push_back(
        {{"where", {{"set", "y0"}}}, {"fix", random.chance(0.5) ? "y" : "xz"}});
  Json& solver = scene["solver"];
  if (random.chance(0.4)) solver["integrator"] = "velocity-verlet";
  if (random.chance(0.3)) solver["dt"] = random.decades(5e-4, 6e-3);  // not always stable
  if (random.chance(0.4)) solver["damping"] = random.between(1, 20);
  if (random.chance(0.15)) solver["sleep"] = {{"acceleration", 0.1}, {"velocity", 0.01}};
  scene["events"] = Json::array();
  for (int i = static_cast<int>(random.between(0, 5)); i > 0; --i) {
    Json event{{"at", random.between(0, 1) * end}};
    event.update(operation(random));
    scene["events"].push_back(event);
  }
  if (random.chance(0.2))
    scene["events"].push_back(
        {{"every", 5},
         {"tear", {{"by", "principal-strain"}, {"above", random.between(0.01, 0.1)}}}});
  if (random.chance(0.2)) add_many_cuts(scene["events"], random, end);
  if (random.chance(0.2))
    scene["foundations"] = {{{"where", {{"set", random.chance(0.5) ? "y0" : "x1"}}},
                             {"normal", random.decades(1e3, 1e6)},
                             {"tangential", 1e4},
                             {"damping", random.chance(0.5) ? 100 : 0}}};
  if (random.chance(0.25)) add_grasp(scene["events"], random, end);
  if (index % 3 == 0) scene["debris"] = {{"below", 0.7}};
  if (index % 4 == 0)  // is skipped
    scene["events"].push_back(
        {{"every", 9}, {"remove_islands", {{"below", 100000}}}, {"on_failure", "skip"}});
  const bool divides = scene["events"].dump().find("blade") != std::string::npos;
  for (int i = static_cast<int>(random.between(0, 2.5)); i > 0; --i)
    scene["loads"].push_back(load(random, divides));
  if (random.chance(0.3)) scene["contact"] = contact(random, end);
  result.skips = random.chance(0.7);
  add_output(scene, random);
  if (random.chance(0.8)) {
    const int steps = random.chance(0.5) ? random.pick(std::vector{4, 8, 16, 32})
                                         : static_cast<int>(random.between(10, 60));
    scene["checkpoint"] = {{"every_steps", steps}, {"keep", 3}};
  }
  return result;
}

}  // namespace suture::test
