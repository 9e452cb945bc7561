// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kernel/base/archive.hpp"
#include "kernel/base/types.hpp"

namespace suture {

/// One array of a frame, tightly packed, component fastest.
struct FrameField {
  std::string name;
  int components = 1;               ///< 1, 3 or 6 (XX YY ZZ XY YZ XZ)
  std::vector<double> values{};     ///< for vertices or elements
  std::vector<std::int64_t> ids{};  ///< instead of values: an integer array
  bool global_ids = false;          ///< the user's numbers, from which read_mesh restores them
  bool principal = false;           ///< components 1, 2, 3 in descending order, not X, Y, Z

  void state(Archive& archive);
};

/// A line, triangle or quadrilateral: 2, 3 or 4 points; unused places at the end are `none`.
using SmallCell = std::array<Index, 4>;

/// A copy of the data of one frame, so that the simulation can continue while it is
/// written. Points and cells are those of the complex, in its order; the user's ids
/// are fields. Nodes X0..X7; the writer converts to VTK's order.
struct Frame {
  std::uint64_t number = 0;
  double time = 0;  ///< s
  std::vector<Vec3> points;
  std::vector<Hexahedron> hexahedra;
  std::vector<std::array<Index, 4>> tetrahedra;  ///< after these: of partial elements; or
  std::vector<SmallCell> cells;
  bool is_surface = false;  ///< the cells are triangles, which go into a `.vtp`
  std::size_t pieces = 0;   ///< it is one of so many (frame_pieces.hpp); 0: whole
  std::vector<FrameField> point_fields;
  std::vector<FrameField> cell_fields;
  std::string field_data_provenance;  ///< scene hash, plugin versions

  /// Saves frames that are held back when a checkpoint is written, which are whole.
  void state(Archive& archive);
};

}  // namespace suture
