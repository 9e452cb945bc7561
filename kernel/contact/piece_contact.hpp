// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/contact/near_pairs.hpp"
#include "kernel/topology/islands.hpp"

namespace suture {

/// Contact between separate pieces: vertices of one with faces of another. In every step a vertex
/// touches at most one face of each other piece, the nearest; impulses along its normal, with
/// friction, by Gauss-Seidel sweeps over all contacts.
///
/// Two rules keep flush surfaces apart that meet at edges: a vertex whose own surface looks the
/// same way as a face (n_v . n_f > 0.2) is on the far side of that face and does not touch it; nor
/// does a vertex beside a face, where another face is nearer or none is.
///
/// Contacts depend on positions alone, not on when the list of near pairs was made.
class PieceContact {
 public:
  /// `edge`: a typical edge of the surface, m.
  PieceContact(const CellComplex& complex, const BoundarySurface& surface, Attributes& attributes,
               double friction, double edge);

  /// Makes the list of near pairs again if anything has moved by half of the skin. `ends`: rows of
  /// 4, where vertices will be at the end of the free step, at which contacts are found.
  void update(const double* ends);
  /// The vertices of near pairs: no others are changed in the step.
  std::span<const Index> vertices() const { return vertices_; }

  /// A vertex and a face, with the impulse between them.
  struct Touch {
    std::array<Index, 5> vertices;  ///< the vertex, and the corners of the face
    std::array<double, 5> weights;  ///< 1, and minus those of the nearest point of the face
    Vec3 normal;                    ///< out of the face
    double target;                  ///< of the gap at the end of the step, m
    double mass;                    ///< that an impulse along the normal moves, kg
    double impulse = 0;             ///< on the vertex, N s
    Vec3 friction{};
  };
  /// Finds the contacts at the end of a free step, without impulses.
  void begin(double dt);
  std::span<const Touch> touches() const { return touches_; }
  /// Improves the impulses, and changes positions and velocities by them. True if some gap changed
  /// by more than a thousandth of an edge.
  bool sweep();

  void follow(const TopologyChange& change);
  void state(Archive& archive);

 private:
  bool has_moved(const double* ends) const;
  void rebuild(const double* ends);
  void find_normals(const double* positions);
  void add_nearest(std::span<const NearPair> pairs_of_vertex);
  Touch touch_of(Index vertex, const BoundarySurface::Corners& corners,
                 const std::array<double, 4>& weights, const Vec3& normal) const;
  Vec3 sum(const Touch& touch, const double* rows) const;
  double improve(Touch& touch);
  void apply(const Touch& touch, const Vec3& impulse);

  const CellComplex& complex_;
  const BoundarySurface& surface_;
  Attributes& attributes_;
  double friction_, edge_, dt_ = 0;
  Islands islands_;
  bool is_stale_ = true;
  // Of the last rebuild.
  std::vector<Index> piece_of_;  ///< by vertex
  std::vector<NearPair> pairs_;
  std::vector<Index> vertices_;
  std::vector<Index> near_faces_;  ///< that have one of these vertices
  std::vector<Vec3> built_at_;     ///< in the order of the vertices of the surface
  std::vector<Vec3> normals_;      ///< by vertex
  // Of the step in progress.
  std::vector<Touch> touches_;
};

}  // namespace suture
