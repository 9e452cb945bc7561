// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/output/frame.hpp"

namespace suture {

/// The field of a piece with the numbers of its points in the frame: points of two pieces are
/// joined by them, and not by their places, which the lips of a cut share.
constexpr const char* point_in_frame = "point_in_frame";

/// Piece `number` of `count` of a frame: an equal range of its cells, in their order, and the
/// points of these. Points without a cell belong to piece 0. O(frame).
Frame piece_of(const Frame& frame, std::size_t number, std::size_t count);

/// The contents of a `.pvtu`, of a surface `.pvtp`: ParaView opens the pieces in these files as one
/// data set. The fields are those of `frame`, and point_in_frame.
std::string list_of_pieces(const Frame& frame, std::span<const std::string> files);

/// The files that such a text names.
std::vector<std::string> pieces_in(std::string_view text);

}  // namespace suture
