// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "kernel/build/built_scene.hpp"
#include "kernel/operations/debris.hpp"

namespace suture {

/// A small piece of the body at which a run has failed.
struct FailedPiece {
  Index elements = 0;
  double volume = 0;            ///< at rest, m^3
  double fraction = 0;          ///< of the volume of a typical element
  std::uint64_t good_step = 0;  ///< the last step after which the state was known to be good
  /// "a piece of 0.0003 ml (2 elements)".
  std::string text() const;
  /// Its cause and cure, as a sentence.
  std::string advice() const;
};

/// The smallest piece with one of the elements `suspects` (those that are inverted or not finite,
/// if some are), or without any, with an element that is inverted or not finite. None if it is
/// larger than a few typical elements: then it is the load that is too large.
std::optional<FailedPiece> find_failed_piece(BuiltScene& built, const Debris& debris,
                                             std::vector<Index> suspects);

}  // namespace suture
