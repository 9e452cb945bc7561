// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/build/built_scene.hpp"
#include "kernel/output/frame_writer.hpp"
#include "kernel/results/piece_cells.hpp"

namespace suture {

/// For frames of a scene: the format that it requests, without prefix and collection.
FrameWriterOptions frame_options(const OutputOptions& options,
                                 const std::shared_ptr<OutputFolder>& folder);

/// The points at their current positions in the scene, and the hexahedra, of the whole complex.
/// Add fields, then call leave_out().
void set_geometry(Frame& frame, BuiltScene& built);
/// Those of a piece, which has no removed cells.
void set_geometry(Frame& frame, BuiltScene& built, const PieceCells& piece);
/// Drops removed cells, with their values in all fields, and what is not material of elements that
/// are so in part only.
void leave_out(Frame& frame, BuiltScene& built);

}  // namespace suture
