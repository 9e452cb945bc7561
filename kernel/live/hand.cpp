// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/live/hand.hpp"

#include <algorithm>

#include "kernel/base/vec3.hpp"
#include "kernel/live/json_text.hpp"

namespace suture {

using Json = nlohmann::json;

Vec3 Hand::place(double time) const {
  const double part = std::min((time - start) / duration, 1.0);
  return plus(from, scaled(part, minus(to, from)));
}

Hand Hand::led(const Vec3& target, double time, double in) const {
  return {tool, offset, place(time), target, time, in};
}

std::string Hand::input() const {
  if (!tool.empty())
    return json_text(Json{
        {"steer", {{"obstacle", tool}, {"translation", plus(to, offset)}, {"during", duration}}}});
  return json_text(Json{
      {"move", {{"grasp", hand_name}, {"translation", minus(to, from)}, {"during", duration}}}});
}

std::string hold_input(const Vec3& at, double radius) {
  const Json sphere{{"centre", at}, {"radius", radius}};
  return json_text(Json{{"grasp", {{"name", hand_name}, {"where", {{"sphere", sphere}}}}}});
}

std::string release_input(const std::string& grasp) { return json_text(Json{{"release", grasp}}); }

}  // namespace suture
