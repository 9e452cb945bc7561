// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "kernel/build/built_scene.hpp"
#include "kernel/contact/boundary_surface.hpp"
#include "kernel/results/fields.hpp"

namespace suture {

/// The surface of a body for display: its boundary, or that of its material where elements are
/// material in part only. It follows operations.
class ShownSurface final : private Follower {
 public:
  /// `built` must outlive it, and may then not change any more.
  explicit ShownSurface(BuiltScene& built);

  /// Increases whenever faces change. They are found at the first call after an operation:
  /// O(surface), and a pass over a list of vertices.
  std::uint64_t number();
  /// Call after the state of another simulation was loaded. O(elements).
  void find_again();

  // ---- after number(), until the next operation ----

  std::size_t size() const { return vertices_.size() + embedded_.size(); }  ///< points
  /// Those of the faces, counterclockwise as seen from outside. Faces that cuts and removals have
  /// laid open come last.
  std::span<const Index> corners() const { return corners_; }
  std::size_t corners_per_face() const { return built_.parts().empty() ? 4 : 3; }
  std::size_t face_count() const { return corners_.size() / corners_per_face(); }
  std::size_t laid_open() const { return laid_open_; }
  /// The points, relative to the body's own origin.
  void append_positions(std::vector<float>& out) const;
  void append_rest(std::vector<float>& out) const;
  /// A field at the points, O(points) if it lies on vertices and they are points: the magnitude of
  /// a vector, the largest of principal values, and of a field of elements the mean of those
  /// around. NaN where there is none.
  void append_values(const FieldChoice& field, const Vec3& gravity, double time,
                     std::vector<float>& out);

 private:
  void follow(const CellComplex& complex, const TopologyChange& change) override;
  void append(const Column& places, std::vector<float>& out) const;
  template <std::size_t N>
  void add_face(const std::array<Index, N>& corners, bool is_laid_open);
  void find_boundary();
  void find_embedded();
  void compress();
  std::vector<double> at_vertices(const FieldChoice& field, const FrameField& values) const;

  BuiltScene& built_;
  BoundarySurface boundary_;
  std::vector<bool> was_boundary_;  ///< by face at the start, 6 e + f
  bool is_current_ = false;
  std::uint64_t number_ = 0;
  // Points: vertices, then embedded ones; corners refer to places in this order.
  std::vector<Index> vertices_, embedded_;
  std::vector<Index> corners_, inside_;  ///< the latter: of faces laid open, while they are found
  std::size_t laid_open_ = 0;
};

/// The fields of a scene that a surface can show: scalars and vectors that need no forces of their
/// own.
std::vector<FieldChoice> shown_fields(BuiltScene& built);

}  // namespace suture
