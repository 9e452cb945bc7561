// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kernel/events/cut_faces.hpp"
#include "kernel/events/seam_batch.hpp"

namespace suture {

// Which boundary faces a suture joins is decided here; CellComplex::sew() joins them.
//
//    A  |..|  B        the faces of A and B look at each other and each corner has
//   +---+..+---+       a partner: a seam, the darts of both paired corner by corner
//   |   |..|   |
//   +---+..+---+

/// Two faces that stay open though they are near or were one.
struct Misfit {
  Seam seam;
  std::string reason;  ///< "corners are 0.02 m apart"
};
/// Seams that sew() accepts together, and faces that had to be left out: each of them
/// is in no seam.
struct MatchedSeams {
  std::vector<Seam> seams;
  std::vector<Misfit> misfits;
};

/// "2 faces ... stay open", with the first of them and why, for a warning.
std::string misfits_text(const std::vector<Misfit>& misfits, const Naming& naming);

/// Faces that were one before a cut: boundary faces whose corners are the same points
/// of the user's mesh, so that they coincide at rest. `elements`: both sides must be
/// among them; empty: everywhere. Seams ascend by the smaller dart. O(elements).
MatchedSeams seams_of_cuts(const CellComplex& complex, std::span<const Index> point_of_vertex,
                           std::span<const Index> elements, const Naming& naming = {});

/// Boundary faces of `a` and of `b` that look at each other, with corners no further
/// apart than `gap` (m) where vertex v is at rows[stride * v]; each face at most once,
/// nearest pairs first. An element of both sets may be sewn to any other, but for its
/// neighbours. Misfits are faces with others within the gap none of which fits: the
/// meshes of both sides differ there, or an element would be folded. Maybe empty.
/// O(boundary faces) for gaps up to the size of a face.
MatchedSeams seams_within_gap(const CellComplex& complex, const double* rows,
                              std::span<const Index> a, std::span<const Index> b, double gap,
                              const Naming& naming = {}, std::size_t stride = 4);

/// The faces of listed pairs of elements: the one that was cut between them, else the
/// two boundary faces that look at each other and are nearest. Pairs that still
/// share a face, or one of which was removed, are in `idle`. Throws one InputError with
/// a line per pair at fault ("<path>/3: ..."): also for pairs that sew() would not
/// accept after those before. O(pairs).
struct ListedSeams {
  std::vector<Seam> seams;
  std::vector<ElementPair> idle;
};
ListedSeams seams_between(const CellComplex& complex, const double* rows, const std::string& path,
                          std::span<const ElementPair> pairs,
                          const std::function<Index(std::uint64_t)>& element_of,
                          std::span<const Index> point_of_vertex, const Naming& naming = {},
                          std::size_t stride = 4);

}  // namespace suture
