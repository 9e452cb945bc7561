// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/output/frame.hpp"

namespace suture {

/// The last point field of a piece, with the numbers of its points in the frame: points of two
/// pieces are joined by them, and not by their places, which the lips of a cut share.
constexpr const char* point_in_frame = "point_in_frame";

/// The number of pieces of a frame with so many cells: each has a cell, if there is one, so that
/// all have the same types of arrays.
std::size_t count_pieces(std::size_t cells, unsigned processes);

/// Piece `number` of `count` of a frame: an equal range of its cells, in their order, and the
/// points of these. Points without a cell belong to piece 0; those from number `count` on are
/// empty. O(frame).
Frame piece_of(const Frame& frame, std::size_t number, std::size_t count);
/// Makes the frame a piece: these are the numbers of its points.
void make_piece(Frame& frame, std::vector<std::int64_t> points, std::size_t count);
/// Adds a piece to a frame, which becomes whole with the last one. In their order, beginning with
/// piece 0 and an empty frame.
void add_piece(Frame& frame, Frame piece);

/// The contents of a `.pvtu`, of a surface `.pvtp`: ParaView opens the pieces in these files as one
/// data set. `piece`: the first of them, for the fields.
std::string list_of_pieces(const Frame& piece, std::span<const std::string> files);

/// The files that such a text names.
std::vector<std::string> pieces_in(std::string_view text);

}  // namespace suture
