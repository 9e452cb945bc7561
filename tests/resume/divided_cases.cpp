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

Json models(Random& random) {
  const Json solid{{"model", "tm-faure"}, {"parameters", {{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}}}};
  const Json springs{{"model", "mss-baudet"},
                     {"parameters", {{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}}}};
  return random.pick(std::vector<Json>{{solid}, {solid}, {springs}, {solid, springs}});
}

Json moved_side(Random& random, double end) {
  return {{"where", {{"set", "x1"}}},
          {"move",
           {{"path",
             {{{"at", random.between(0, 0.5) * end}},
              {{"at", random.between(0.6, 2) * end},
               {"translation", {random.between(-0.1, 0.1), random.between(-0.1, 0.1), 0}}}}}}}};
}

}  // namespace

Case divided(Random& random, unsigned index) {
  const double end = random.between(0.1, 0.3);
  Case result{"divided-" + std::to_string(index),
              {{"suture", 2},
               {"mesh", {{"box", {{"size", {1, 1, 1}}, {"cells", Json::array()}}}}},
               {"models", models(random)},
               {"gravity", {0, random.chance(0.1) ? -1e3 : -random.between(0, 10), 0}},
               {"constraints", {{{"where", {{"set", "x0"}}}, {"fix", "xyz"}}}},
               {"solver", {{"end", end}}}}};
  Json& scene = result.scene;
  for (int axis = 0; axis < 3; ++axis)
    scene["mesh"]["box"]["cells"].push_back(static_cast<int>(random.between(15, 25)));
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
  if (random.chance(0.2))
    scene["loads"] = {{{"where", {{"set", "y1"}}}, {"pressure", random.between(10, 1000)}}};
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
  if (random.chance(0.15)) {
    const Json floor{{"name", "floor"},
                     {"half_space", {{"point", {0, -0.01, 0}}, {"normal", {0, 1, 0}}}}};
    scene["contact"] = {{"obstacles", {floor}}};
  }
  result.skips = random.chance(0.7);
  add_output(scene, random);
  scene["checkpoint"] = {{"every_steps", static_cast<int>(random.between(10, 60))}, {"keep", 3}};
  return result;
}

}  // namespace suture::test
