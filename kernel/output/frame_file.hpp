// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

#include "kernel/base/file.hpp"
#include "kernel/output/frame_writer.hpp"

namespace suture {

std::size_t cell_count(const Frame& frame);
/// One per component; empty: those of VTK.
std::span<const char* const> names_of_components(const FrameField& field);

/// Throws std::invalid_argument if a field does not fit the points or cells.
void check_frame(const Frame& frame);

/// Writes one `.vtu`, or the `.vtp` of a surface. The nodes of the frame's cells are reordered for
/// VTK in place, so that nothing is copied. Throws IoError.
void write_frame(OutputFile& file, Frame& frame, FrameWriterOptions::Compression compression);

}  // namespace suture
