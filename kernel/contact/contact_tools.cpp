// SPDX-License-Identifier: GPL-3.0-or-later
// A step with compliant tools: the pushes are found again until tools and vertices agree.
#include <algorithm>

#include "kernel/contact/contact.hpp"

namespace suture {
namespace {

// Rounds of a tool and what it pushes, until it moves by less than this part of an element; less
// exactly where pieces meet, whose sweeps end sooner.
constexpr int max_tool_rounds = 20;
constexpr double tool_tolerance = 1e-9, tool_tolerance_among_pieces = 1e-3;

}  // namespace

/// Until each tool moves as the vertices that it pushes make it move (tool.hpp).
void Contact::settle_tools(const ContactStep& step) {
  const double tolerance =
      pieces_ && !pieces_->touches().empty() ? tool_tolerance_among_pieces : tool_tolerance;
  bool agree = false;
  for (int round = 0; round < max_tool_rounds; ++round) {
    double change = 0;
    for (std::size_t i = 0; i < tools_.size(); ++i)
      if (tools_[i]) change = std::max(change, tools_[i]->improve(answer_to(i), pushed_by(i)));
    agree = change <= tool_tolerance * shortest_edge_;
    if (change <= tolerance * shortest_edge_) break;
    for (std::size_t i = 0; i < tools_.size(); ++i)
      if (tools_[i]) placed_[i].move_end(tools_[i]->end());
    release(step);
    push(step.dt);
  }
  for (std::size_t i = 0; i < tools_.size(); ++i)
    if (tools_[i]) tools_[i]->finish(answer_to(i), agree);
}

/// Back to the step without contact.
void Contact::release(const ContactStep& step) {
  for (const Near& near : near_) {
    const std::size_t at = 4 * std::size_t{near.vertex};
    std::ranges::copy(near.free_end, attributes_.position().rows() + at);
    std::ranges::copy(near.free_velocity, attributes_.velocity().rows() + at);
  }
  for (Pushed& pushed : pushed_) pushed.change = {};
  if (pieces_) find_touching_pieces(step);
  if (!edges_) return;
  find_at_edges();
  edges_->release();
}

Tool::Impulse Contact::answer_to(std::size_t obstacle) const {
  Tool::Impulse answer;
  const Pose& end = tools_[obstacle]->end();
  const Vec3 centre = plus(end.centre, end.translation);
  for (const auto& [vertex, by, push] : pushes_) {
    if (by != obstacle || push.normal == Vec3{}) continue;
    const double mass = attributes_.mass().rows()[vertex];
    const Vec3 impulse = scaled(-mass, plus(push.normal, push.tangential));
    const Vec3 arm = minus(row(attributes_.position().rows(), vertex), centre);
    answer.linear = plus(answer.linear, impulse);
    answer.angular = plus(answer.angular, cross(arm, impulse));
  }
  return answer;
}

std::vector<Tool::Pushed> Contact::pushed_by(std::size_t obstacle) const {
  std::vector<Tool::Pushed> pushed;
  for (const auto& [vertex, by, push] : pushes_) {
    if (by != obstacle || push.normal == Vec3{}) continue;
    pushed.push_back({row(attributes_.position().rows(), vertex), attributes_.mass().rows()[vertex],
                      push, obstacles_[obstacle].friction});
  }
  return pushed;
}

}  // namespace suture
