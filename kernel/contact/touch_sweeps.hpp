// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/contact/boundary_surface.hpp"

namespace suture {

/// A vertex and a face that touch, or two edges, with the impulse between them.
struct PieceTouch {
  std::array<Index, 5> vertices;   ///< the vertex, and the corners of the face; or the ends of
                                   ///< the edges, the last one twice
  std::array<Index, 5> places{};   ///< of the vertices among those that touch: by TouchSweeps
  std::array<double, 5> weights;   ///< of the one point, and minus those of the other one
  std::array<double, 5> response;  ///< of velocities to an impulse: weight over mass, 1/kg
  std::array<char, 5> fixed;       ///< components that do not respond
  Vec3 normal;                     ///< out of the face or the second edge
  double before;                   ///< the gap before the step, m
  double speed;                    ///< along the normal that the end of the step needs, m/s
  double mass;                     ///< that an impulse along the normal moves, kg
  double impulse = 0;              ///< on the vertex or the first edge, N s
  Vec3 friction{};
  double seen = -1;  ///< what the ways of its vertices were when it was last improved, m
};

/// Of a contact between pieces with these vertices.
inline bool is_between_edges(const std::array<Index, 5>& vertices) {
  return vertices[3] == vertices[4];
}
/// In the order in which contacts are found: those of edges after those of vertices and faces.
inline bool is_found_before(const std::array<Index, 5>& a, const std::array<Index, 5>& b) {
  const bool a_is_edges = is_between_edges(a), b_is_edges = is_between_edges(b);
  return a_is_edges != b_is_edges ? b_is_edges : a[0] < b[0];
}

/// Projected Gauss-Seidel over the contacts of a step. Every vertex counts how far impulses have
/// taken it; a sweep skips contacts whose gap others cannot have changed by more than `negligible`
/// since they were last improved, and whole groups of which no vertex has gone anywhere.
class TouchSweeps {
 public:
  /// Call when a step begins: numbers the vertices.
  void begin(std::span<PieceTouch> touches);
  const DenseSet& vertices() const { return vertices_; }

  /// Changes impulses, and velocities (rows of 4) by them. `negligible`: m. Returns the largest
  /// change of a gap, m.
  double sweep(std::span<PieceTouch> touches, double* velocities, double friction, double dt,
               double negligible);
  /// Applies an impulse that contacts begin with.
  void apply(const PieceTouch& touch, const Vec3& impulse, double* velocities) const;
  /// Something else has moved a vertex, m.
  void disturb(Index vertex, double way) {
    if (!vertices_.contains(vertex)) return;
    ways_[vertices_.place(vertex)] += way;
    due_ |= groups_[vertices_.place(vertex)];
  }

 private:
  DenseSet vertices_;                  ///< that touch
  std::vector<double> ways_;           ///< by place, m
  std::vector<std::uint64_t> groups_;  ///< by place: a bit for each group of contacts it is in
  std::uint64_t due_ = 0;              ///< groups that the next sweep visits
};

}  // namespace suture
