// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/contact/boundary_surface.hpp"

// Sweeps over the contacts of a step
// ==================================
//
// Projected Gauss-Seidel with accumulated impulses: each contact in turn takes its own gap to
// zero. Sweeps end when no gap changes by more than 1e-4 of an edge, nor by more than 0.3 of its
// change in the first sweep. There are at most 32 sweeps, and obstacles have the last word in
// each. A contact is skipped if others cannot have changed its gap by a tenth of the tolerance
// since it was last improved. In packed blocks this is true of most. The contacts form 64 groups,
// and a group is skipped as a whole if none of its vertices has moved.
//
// What lets a pile come to rest. With all three, 76 of 80 searches succeed (4 scenes, 10 starts,
// damping "auto" and 1/s, tolerance 1e-4); without them, 45.
// - Contacts are found where the forces of the last step lead. Where the step ends without
//   contact, pressed pieces are in each other by 5 % of an edge. Feet and normals there depend on
//   the step and on its damping, so each change of the damping was a kick.
// - Sweeps begin with the forces of the last step, not with its impulses, which change with the
//   damping. A vertex must touch in the same direction (cosine 0.95). These forces belong to the
//   state of a run.
// - An error of the sweeps as large as the change from step to step acts as a force that lags by a
//   step, and feeds the fast modes. A tolerance alone, of 1e-4 or 1e-6 of an edge, leaves a
//   vibration of that size.
// The remaining failures are stacks whose sweeps end at the limit of 32.
//
// What was tried without gain:
// - A compliance of 0.3 to 3 % of contacts: sweeps converge faster, but depths depend on the
//   damping again.
// - Nonlinear conjugate gradients over the contacts (Silcowitz, Niebe and Erleben 2009): 12 sweeps
//   instead of 17 in a settling pile. Each sweep changes every contact, so none can be skipped:
//   37,000 visits instead of 34,000.
// - Over-relaxation by 1.4: 21 sweeps instead of 28 in a pile that lies, but 30 of 40 searches for
//   rest succeed instead of 36.
// - Sweeps in alternating directions: no fewer. Sweeps in several interleaved streams: no gain.
//
// Cost of a step with contact over one without (suture-bench contact, four runs):
//   20 letters of 1,000 elements, falling; lying in a pile after 0.5 and 1 s    1.5-1.6; 2.2-2.7
//   20 blocks of 1,000 elements in turned layers, 4,100 vertices touching       5.2-5.5
//   the same packed face to face, 3,000 vertices touching                       3.7-4.0
//   19,652 elements on a plate under a sliding sphere, 1,240 touching           1.17-1.24

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

/// Whether a contact between pieces with these vertices is one of two edges.
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
