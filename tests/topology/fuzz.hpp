// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <random>
#include <string>

#include "kernel/topology/journal.hpp"

namespace suture::fuzz {

/// The first law that a sequence broke.
struct Offence {
  std::size_t operation;  ///< its number in the journal; that many hold
  std::string law;
};

/// What sequences did, to see that they do something.
struct Tally {
  std::size_t faces_cut = 0, elements_removed = 0, faces_sewn = 0;
  std::size_t vertices_split = 0, vertices_merged = 0;
  std::size_t copies = 0, absorbed = 0;
  std::size_t refused = 0;  ///< sutures that are possible seam by seam only
};

/// Repeats a journal on a CellComplex, on Islands and on CGAL's map, and compares all
/// after each operation.
std::optional<Offence> play(const Journal& journal);

/// Cuts, tears, pierces, sutures and copies at random on this mesh, `operations` of them, and
/// compares as play() does. The journal says what was done, up to an offence.
std::optional<Offence> play_random(const Mesh& mesh, std::size_t operations, std::mt19937& random,
                                   Journal& journal, Tally& tally);

/// A journal with as few operations, and these with as few numbers, as delta debugging
/// finds such that it still `fails` (by default: that play() finds an offence).
Journal shrink(
    Journal journal, const std::function<bool(const Journal&)>& fails = [](const Journal& j) {
      return play(j).has_value();
    });

}  // namespace suture::fuzz
