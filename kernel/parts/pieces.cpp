// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/pieces.hpp"

#include <algorithm>
#include <bit>

#include "kernel/topology/disjoint_sets.hpp"

namespace suture {
namespace {

/// The corners on the upper face along each axis; the lower ones are the others.
constexpr std::array<CornerSet, 3> upper{0b10101010, 0b11001100, 0b11110000};

/// Whether a piece and one of the next cube along the axis have a corner of their face in common.
bool touch(CornerSet lower_piece, CornerSet upper_piece, int axis) {
  return (((lower_piece & upper[axis]) >> (1 << axis)) & upper_piece) != 0;
}

/// Calls visit(axis, p, q) for all pieces p, q of which q lies behind p along the axis and touches
/// it. The pieces are sorted, so that neighbours are found without a search.
template <class Visit>
void for_each_link(const Lattice& lattice, const std::vector<Piece>& pieces, Visit visit) {
  for (int axis = 0; axis < 3; ++axis) {
    std::size_t q = 0;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
      const std::size_t next = pieces[p].cube + lattice.step(axis);
      while (q < pieces.size() && pieces[q].cube < next) ++q;
      if (lattice.place(pieces[p].cube)[axis] + 1 == lattice.cubes[axis]) continue;
      for (std::size_t r = q; r < pieces.size() && pieces[r].cube == next; ++r)
        if (touch(pieces[p].corners, pieces[r].corners, axis)) visit(axis, p, r);
    }
  }
}

bool share_a_face(const Hexahedron& a, const Hexahedron& b) {
  CornerSet shared = 0;
  for (unsigned n = 0; n < 8; ++n) shared |= CornerSet((a[n] == b[n] ? 1u : 0u) << n);
  return std::ranges::any_of(upper, [&](CornerSet face) {
    return (shared & face) == face || (shared & CornerSet(~face)) == CornerSet(~face);
  });
}

/// Replaces the pieces of each set by one; returns the number of those that are gone.
std::size_t keep_sets(std::vector<Piece>& pieces, DisjointSets& sets) {
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const std::size_t first = sets.find(p);
    if (first == p) continue;
    pieces[first].corners |= pieces[p].corners;
    pieces[p].corners = 0;
  }
  return std::erase_if(pieces, [](const Piece& piece) { return piece.corners == 0; });
}

}  // namespace

std::vector<Piece> pieces_of(const Lattice& lattice, const std::vector<std::uint8_t>& inside) {
  std::vector<Piece> pieces;
  const auto [nx, ny, nz] = lattice.cubes;
  std::size_t cube = 0;
  for (Index k = 0; k < nz; ++k)
    for (Index j = 0; j < ny; ++j)
      for (Index i = 0; i < nx; ++i, ++cube) {
        CornerSet corners = 0;
        for (Index n = 0; n < 8; ++n)
          if (inside[lattice.corner({i + (n & 1), j + (n >> 1 & 1), k + (n >> 2 & 1)})] != 0)
            corners |= CornerSet(1u << n);
        if (corners == all_corners) {
          pieces.push_back({cube, corners});
        } else if (corners != 0) {
          for (const CornerSet part : connected_parts(corners)) pieces.push_back({cube, part});
        }
      }
  return pieces;
}

std::size_t drop_specks(const Lattice& lattice, std::vector<Piece>& pieces) {
  DisjointSets sets(pieces.size());
  for_each_link(lattice, pieces, [&](int, std::size_t p, std::size_t q) { sets.unite(p, q); });
  // Each corner belongs to the pieces of eight cubes.
  std::vector<std::size_t> corners(pieces.size());
  for (std::size_t p = 0; p < pieces.size(); ++p)
    corners[sets.find(p)] += static_cast<std::size_t>(std::popcount(pieces[p].corners));
  const std::size_t least = std::min(std::size_t{8 * 4}, std::ranges::max(corners));
  const auto specks =
      std::ranges::count_if(corners, [&](std::size_t count) { return count > 0 && count < least; });
  if (specks == 0) return 0;
  for (std::size_t p = 0; p < pieces.size(); ++p)
    if (corners[sets.find(p)] < least) pieces[p].corners = 0;
  std::erase_if(pieces, [](const Piece& piece) { return piece.corners == 0; });
  return static_cast<std::size_t>(specks);
}

std::size_t join_pieces(const Lattice& lattice, std::vector<Piece>& pieces) {
  std::size_t gone = 0, now = 1;
  while (now != 0 && std::ranges::adjacent_find(pieces, {}, &Piece::cube) != pieces.end()) {
    const std::vector<Hexahedron> nodes = nodes_of(lattice, pieces);
    DisjointSets sets(pieces.size());
    for (std::size_t p = 0; p < pieces.size(); ++p)
      for (std::size_t q = p + 1; q < pieces.size() && pieces[q].cube == pieces[p].cube; ++q)
        if (share_a_face(nodes[p], nodes[q])) sets.unite(p, q);
    now = keep_sets(pieces, sets);
    gone += now;
  }
  return gone;
}

std::vector<Hexahedron> nodes_of(const Lattice& lattice, const std::vector<Piece>& pieces) {
  DisjointSets sets(8 * pieces.size());
  for_each_link(lattice, pieces, [&](int axis, std::size_t p, std::size_t q) {
    const std::size_t across = std::size_t{1} << axis;
    for (std::size_t n = 0; n < 8; ++n)
      if ((n & across) != 0) sets.unite(8 * p + n, 8 * q + n - across);
  });
  // A set is represented by its first corner, which is numbered first.
  std::vector<Hexahedron> nodes(pieces.size());
  Index next = 0;
  for (std::size_t p = 0; p < pieces.size(); ++p)
    for (std::size_t n = 0; n < 8; ++n) {
      const std::size_t first = sets.find(8 * p + n);
      nodes[p][n] = first == 8 * p + n ? next++ : nodes[first / 8][first % 8];
    }
  return nodes;
}

}  // namespace suture
