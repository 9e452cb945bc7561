// SPDX-License-Identifier: GPL-3.0-or-later
// A step with compliant tools: the pushes are found again until tools and vertices agree.
#include <algorithm>

#include "kernel/contact/contact.hpp"
#include "kernel/contact/point_pushes.hpp"
#include "kernel/contact/vertex_pushes.hpp"

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
      if (tools_[i]) step_.placed[i].move_end(tools_[i]->end());
    release(step);
    push(step.dt);
  }
  for (std::size_t i = 0; i < tools_.size(); ++i)
    if (tools_[i]) tools_[i]->finish(answer_to(i), agree);
}

/// Back to the step without contact.
void Contact::release(const ContactStep& step) {
  for (const Near& near : step_.near) {
    const std::size_t at = 4 * std::size_t{near.vertex};
    std::ranges::copy(near.free_end, attributes_.position().rows() + at);
    std::ranges::copy(near.free_velocity, attributes_.velocity().rows() + at);
    if (edges_) step_.near_of_vertex[near.vertex] = none;  // pieces find theirs again
  }
  for (Pushed& pushed : step_.pushed) pushed.change = {};
  if (point_pushes_) point_pushes_->release();
  if (pieces_) vertex_pushes_->find_touching(step);
  if (!edges_) return;
  find_at_edges();
  edges_->release(step_.placed);
}

/// visit(i, push) for what an obstacle pushes, by place in those pushed.
template <class Visit>
void Contact::for_each_pushed_by(std::size_t obstacle, Visit visit) const {
  for (std::size_t i = 0; i < step_.pushed.size(); ++i)
    for (const PushBy& by :
         std::span(step_.pushes).subspan(step_.pushed[i].first, step_.pushed[i].count))
      if (by.obstacle == obstacle && by.push.normal != Vec3{}) visit(i, by.push);
}

Vec3 Contact::mass_of(std::size_t i) const {
  if (point_pushes_) return point_pushes_->mass(i);
  const double mass = attributes_.mass().rows()[step_.pushed[i].vertex];
  return {mass, mass, mass};
}

Tool::Impulse Contact::answer_to(std::size_t obstacle) const {
  Tool::Impulse answer;
  const Pose& end = tools_[obstacle]->end();
  const Vec3 centre = plus(end.centre, end.translation);
  const auto add = [&](const Vec3& place, const Vec3& impulse) {
    answer.linear = plus(answer.linear, impulse);
    answer.angular = plus(answer.angular, cross(minus(place, centre), impulse));
  };
  for_each_pushed_by(obstacle, [&](std::size_t i, const Push& push) {
    const Vec3 change = plus(push.normal, push.tangential), mass = mass_of(i);
    const Vec3 impulse{-mass[0] * change[0], -mass[1] * change[1], -mass[2] * change[2]};
    add(points_.place(step_.pushed[i].vertex), impulse);
  });
  if (!edges_) return answer;
  for (const CuttingEdges::Grip& grip : edges_->grips())
    if (edges_->obstacle(grip) == obstacle && grip.change != Vec3{})
      add(grip.mass.point().sum(attributes_.position().rows()), scaled(-1, grip.impulse()));
  return answer;
}

std::vector<Tool::Pushed> Contact::pushed_by(std::size_t obstacle) const {
  std::vector<Tool::Pushed> pushed;
  for_each_pushed_by(obstacle, [&](std::size_t i, const Push& push) {
    pushed.push_back({points_.place(step_.pushed[i].vertex), mass_of(i)[0],
                      Tool::response(push, obstacles_[obstacle].friction)});
  });
  if (edges_) edges_->add_pushed_by(obstacle, pushed);
  return pushed;
}

}  // namespace suture
