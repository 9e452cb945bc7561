// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kernel/operations/cut_faces.hpp"
#include "kernel/operations/seam_batch.hpp"

namespace suture {

// Decides which boundary faces a suture joins; CellComplex::sew() joins them.
//
//    A  |..|  B        the faces of A and B face each other and each corner has
//   +---+..+---+       a partner: a seam, the darts of both paired corner by corner
//   |   |..|   |
//   +---+..+---+

/// Two faces that stay open although they are close or were one face.
struct Misfit {
  Seam seam;
  std::string reason;  ///< "corners are 0.02 m apart"
};
/// Seams that sew() accepts together, and faces that had to be left out of all seams.
struct MatchedSeams {
  std::vector<Seam> seams;
  std::vector<Misfit> misfits;
};

/// "2 faces ... stay open", with the first of them and the reason, for a warning.
std::string misfits_text(const std::vector<Misfit>& misfits, const Naming& naming);

/// Faces that were one before a cut: boundary faces whose corners are the same points
/// of the user's mesh, so that they coincide at rest. `elements`: both sides must be
/// among them; empty: everywhere. Seams ascend by the smaller dart. O(elements).
MatchedSeams seams_of_cuts(const CellComplex& complex, std::span<const Index> point_of_vertex,
                           std::span<const Index> elements, const Naming& naming = {});

/// Boundary faces of `a` and of `b` that face each other, with corners at most `gap` (m) apart,
/// where vertex v is at rows[stride * v]; each face at most once, nearest pairs first. An element
/// in both sets may be sewn to any element except its neighbours. Misfits are faces that have
/// others within the gap but match none of them: the meshes on the two sides differ there, or an
/// element would be folded. May be empty. O(boundary faces) for gaps up to the size of a face.
MatchedSeams seams_within_gap(const CellComplex& complex, const double* rows,
                              std::span<const Index> a, std::span<const Index> b, double gap,
                              const Naming& naming = {}, std::size_t stride = 4);

/// The faces for listed pairs of elements: the face that was cut between them, or else the two
/// nearest boundary faces that face each other. Pairs that still share a face, or of which an
/// element was removed, are in `idle`. seams_between() throws one InputError with a line per
/// invalid pair ("<path>/3: ..."), including pairs that sew() would not accept after the preceding
/// ones. O(pairs).
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
