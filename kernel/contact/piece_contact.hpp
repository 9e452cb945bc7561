// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/contact/near_pairs.hpp"
#include "kernel/contact/patch.hpp"
#include "kernel/topology/islands.hpp"

namespace suture {

/// Contact between pieces and between the lips of cuts: vertices of one with faces of another. In
/// every step a vertex touches the nearest face of each piece, and in an inner corner the nearest
/// ones of its sides; impulses along their normals, with friction, by Gauss-Seidel sweeps over all
/// contacts.
///
/// Lips are the faces that were inside when the object was made. They coincide when they are made:
/// their gap is 0, so they do not repel. With itself a piece touches only there, unless `self`.
///
/// Two rules keep flush surfaces apart that meet at edges: a vertex whose own surface looks the
/// same way as a face (n_v . n_f > 0.2) is on the far side of that face and does not touch it; nor
/// does a vertex beside a face, where another face is nearer or none is.
///
/// Contacts depend on positions alone, not on when the list of near pairs was made.
class PieceContact {
 public:
  struct Options {
    double friction = 0;
    bool self = false;  ///< all of a piece touches all of it
  };
  /// `edge`: a typical edge of the surface, m.
  PieceContact(const CellComplex& complex, const BoundarySurface& surface, Attributes& attributes,
               const Options& options, double edge);
  bool touches_self() const { return options_.self; }
  /// A vertex that is deeper inside another piece does not touch it; of a typical edge.
  static constexpr double max_depth = 0.3;

  /// Makes the list of near pairs again if anything has moved by half of the skin. `ends`: rows of
  /// 4, where vertices will be at the end of the free step, at which contacts are found.
  void update(const double* ends);
  /// The vertices of near pairs: no others are changed in the step.
  std::span<const Index> vertices() const { return vertices_; }

  /// A vertex and a face, with the impulse between them.
  struct Touch {
    std::array<Index, 5> vertices;   ///< the vertex, and the corners of the face
    std::array<double, 5> weights;   ///< 1, and minus those of the nearest point of the face
    std::array<double, 5> response;  ///< of velocities to an impulse: weight over mass, 1/kg
    std::array<char, 5> fixed;       ///< components that do not respond
    Vec3 normal;                     ///< out of the face
    double speed;                    ///< along the normal that the end of the step needs, m/s
    double mass;                     ///< that an impulse along the normal moves, kg
    double impulse = 0;              ///< on the vertex, N s
    Vec3 friction{};
  };
  /// Finds the contacts at the end of a free step, without impulses.
  void begin(double dt);
  std::span<const Touch> touches() const { return touches_; }
  /// Improves the impulses, and changes velocities by them; positions are up to the caller. True if
  /// some gap changed by more than a thousandth of an edge.
  bool sweep();

  void follow(const TopologyChange& change);
  void state(Archive& archive);

 private:
  /// A face of a piece, and the place on it that is nearest to a vertex.
  struct Found {
    Index piece, face;
    double distance;
    Patch::Foot foot;
    Vec3 centre;  ///< of the face
    /// The faces form an inner corner, so that a vertex in it touches both.
    bool faces(const Found& other) const;
  };
  bool is_settled(Index piece, const Vec3& face_normal) const;
  void add(const Found& found);
  bool find_what_may_meet();
  bool is_behind_at_rest(const NearPair& pair) const;
  bool has_moved(const double* ends) const;
  void rebuild(const double* ends);
  void find_vertices();
  void find_normals(const double* positions);
  void find_nearest(std::span<const NearPair> pairs_of_vertex);
  void add_nearest(std::span<const NearPair> pairs_of_vertex);
  Touch touch_of(Index vertex, const BoundarySurface::Corners& corners,
                 const std::array<double, 4>& weights, const Vec3& normal) const;
  double improve(Touch& touch);

  const CellComplex& complex_;
  const BoundarySurface& surface_;
  Attributes& attributes_;
  Options options_;
  double edge_, dt_ = 0;
  Islands islands_;
  std::vector<bool> was_outside_;  ///< by face, as in BoundarySurface::faces(): at the beginning
  bool is_stale_ = true;           ///< an operation came after the last rebuild
  // Since the last operation.
  Meeting meeting_;
  bool may_meet_ = false;
  // Of the last rebuild.
  std::vector<NearPair> pairs_;
  std::vector<Index> vertices_;
  std::vector<Index> near_faces_;  ///< that have one of these vertices
  std::vector<Vec3> built_at_;     ///< in the order of the vertices of the surface
  // Of the step in progress.
  std::vector<Vec3> normals_;       ///< by vertex: sums of area vectors
  std::vector<Vec3> face_normals_;  ///< by place: of near faces, of length 1
  std::vector<Touch> touches_;
  std::vector<Found> nearest_;  ///< to one vertex
};

}  // namespace suture
