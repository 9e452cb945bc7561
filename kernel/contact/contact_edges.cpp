// SPDX-License-Identifier: GPL-3.0-or-later
// A step in which blades meet tissue that resists their edges.
#include "kernel/contact/contact.hpp"

namespace suture {

void Contact::add_edge(const CuttingEdges::Edge& edge) {
  if (!edges_) edges_.emplace(complex_, attributes_, mean_edge_);
  edges_->add(edge);
  if (std::optional<Tool>& tool = tools_[edge.obstacle])
    for (const Vec3& point : edge.points) tool->include(point);
  cuts_ = true;
}

/// Adds the vertices at the edges to those that the step may push.
void Contact::find_at_edges() {
  near_of_vertex_.resize(attributes_.vertex_count(), none);
  for (std::size_t i = 0; i < near_.size(); ++i)
    near_of_vertex_[near_[i].vertex] = static_cast<Index>(i);
  for (const Index v : edges_->vertices()) {
    if (near_of_vertex_[v] != none) continue;
    near_of_vertex_[v] = static_cast<Index>(near_.size());
    add_near(v);
  }
}

/// Reports the vertices that have moved to the pieces. Returns the largest change of a velocity,
/// m/s.
double Contact::sweep_edges(double dt) {
  if (!pieces_) return edges_->sweep(dt);
  const std::span<const Index> vertices = edges_->vertices();
  const auto velocity = [&](Index v) { return row(attributes_.velocity().rows(), v); };
  before_edges_.clear();
  for (const Index v : vertices) before_edges_.push_back(velocity(v));
  const double largest = edges_->sweep(dt);
  for (std::size_t i = 0; i < vertices.size(); ++i)
    pieces_->disturb(vertices[i], dt * norm(minus(velocity(vertices[i]), before_edges_[i])));
  return largest;
}

/// The work of the forces on vertices is booked; here, what cutting takes is found in it, as that
/// of friction is.
void Contact::book_edges(const ContactStep& step) {
  edges_->finish();
  for (const CuttingEdges::Grip& grip : edges_->grips()) {
    if (grip.change == Vec3{}) continue;
    const ContactPoint& point = grip.mass.point();
    const Vec3 impulse = grip.impulse();
    const double taken =
        -step.work_gain * dot(impulse, minus(mean_velocity(point, step), edges_->velocity(grip)));
    work_ += taken;
    cutting_work_ -= taken;
    const Vec3 on = scaled(1 / step.whole_gain, impulse);
    for (std::size_t j = 0; j < point.vertices.size(); ++j)
      obstacle_forces_.push_back({point.vertices[j], static_cast<Index>(edges_->obstacle(grip)),
                                  scaled(point.weights[j], on)});
  }
}

}  // namespace suture
