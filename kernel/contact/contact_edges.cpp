// SPDX-License-Identifier: GPL-3.0-or-later
// A step in which blades meet tissue that resists their edges.
#include "kernel/contact/contact.hpp"
#include "kernel/contact/contact_books.hpp"

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
  std::vector<Index>& near_of_vertex = step_.near_of_vertex;
  near_of_vertex.resize(attributes_.vertex_count(), none);
  for (std::size_t i = 0; i < step_.near.size(); ++i)
    near_of_vertex[step_.near[i].vertex] = static_cast<Index>(i);
  for (const Index v : edges_->vertices()) {
    if (near_of_vertex[v] != none) continue;
    near_of_vertex[v] = static_cast<Index>(step_.near.size());
    step_.add_near(attributes_, v);
  }
}

/// Reports the vertices that have moved to the pieces. Returns the largest change of a velocity,
/// m/s.
double Contact::sweep_edges(double dt) {
  if (!pieces_) return edges_->sweep(dt);
  const std::span<const Index> vertices = edges_->vertices();
  const auto velocity = [&](Index v) { return row(attributes_.velocity().rows(), v); };
  std::vector<Vec3>& before = step_.before_edges;
  before.clear();
  for (const Index v : vertices) before.push_back(velocity(v));
  const double largest = edges_->sweep(dt);
  for (std::size_t i = 0; i < vertices.size(); ++i)
    pieces_->disturb(vertices[i], dt * norm(minus(velocity(vertices[i]), before[i])));
  return largest;
}

/// The work of the forces on vertices is booked; here, what cutting takes is found in it, as that
/// of friction is.
void Contact::book_edges(ContactBooks& books) {
  edges_->finish();
  for (const CuttingEdges::Grip& grip : edges_->grips())
    if (grip.change != Vec3{})
      books.cutting(grip.mass.point(), static_cast<Index>(edges_->obstacle(grip)), grip.impulse(),
                    edges_->velocity(grip));
}

}  // namespace suture
