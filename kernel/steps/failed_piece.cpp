// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/steps/failed_piece.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>

#include "kernel/base/message_text.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/dynamics/inversion.hpp"

namespace suture {
namespace {

/// In typical elements. A larger piece does not fail because it is small.
constexpr double largest_failed = 8;

bool has_finite_nodes(const CellComplex& complex, const Column& position, Index element) {
  return std::ranges::all_of(complex.vertices_of(element), [&](Index v) {
    return std::isfinite(position.get(v, 0)) && std::isfinite(position.get(v, 1)) &&
           std::isfinite(position.get(v, 2));
  });
}

}  // namespace

std::string FailedPiece::text() const {
  return "a piece of " + volume_text(volume) + " (" + count_text(elements, "element") + ")";
}

std::string FailedPiece::advice() const {
  std::ostringstream below;
  below.precision(2);
  below << 1.1 * fraction;
  std::string sentence = text() + " collapsed";
  sentence[0] = 'A';
  return sentence + "; \"debris\" removes such pieces: set \"debris\": {\"below\": " + below.str() +
         "} in the scene";
}

std::optional<FailedPiece> find_failed_piece(BuiltScene& built, const Debris& debris,
                                             std::vector<Index> suspects) {
  const double typical = debris.typical_volume();
  if (!(typical > 0)) return {};
  Body& body = built.body();
  const CellComplex& complex = body.complex();
  std::vector<Index> failed = find_inverted(body, {});
  const Column& position = body.attributes().position();
  for (Index e = 0; e < complex.element_count(); ++e)
    if (complex.exists(3, e) && !has_finite_nodes(complex, position, e)) failed.push_back(e);
  sort_unique(failed);
  if (suspects.empty()) {
    suspects = failed;
  } else {
    std::vector<Index> both;
    sort_unique(suspects);
    std::ranges::set_intersection(suspects, failed, std::back_inserter(both));
    if (!both.empty()) suspects = both;
  }
  std::vector<Index> islands, elements;
  for (const Index e : suspects) islands.push_back(body.islands().of(e));
  sort_unique(islands);
  std::optional<FailedPiece> smallest;
  for (const Index i : islands) {
    if (i == none) continue;
    const double limit = smallest ? smallest->volume : largest_failed * typical;
    const double volume = debris.volume_below(i, limit, elements);
    if (volume < limit)
      smallest = {static_cast<Index>(elements.size()), volume, volume / typical, 0};
  }
  return smallest;
}

}  // namespace suture
