// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/inversion.hpp"

#include <algorithm>

#include "kernel/forces/loops/dispatch.hpp"

namespace suture {

std::vector<Index> find_inverted(const CellComplex& complex, Attributes& attributes) {
  constexpr Index part = 4096;
  const Index elements = complex.element_count();
  const Index* nodes = complex.vertices().data()->data();
  const std::uint8_t* live = attributes.kernel(3).cells.live().data();
  const double* position = attributes.position().rows();
  const auto count = hot_loops().inverted;
  std::vector<Index> found;
  for (Index begin = 0; begin < elements; begin += part) {
    Index first = none;
    const Index end = std::min(begin + part, elements);
    Index here = count(nodes, live, position, begin, end, &first);
    for (Index e = first; here > 0; ++e)
      if (count(nodes, live, position, e, e + 1, &first) != 0) {
        found.push_back(e);
        --here;
      }
  }
  return found;
}

std::vector<Index> find_inverted(Body& body, const std::vector<Index>& allowed) {
  std::vector<Index> found;
  std::ranges::set_difference(find_inverted(body.complex(), body.attributes()), allowed,
                              std::back_inserter(found));
  return found;
}

Index first_forbidden(const Body& body, const std::vector<Index>& inverted,
                      const std::vector<bool>& forbids) {
  const auto& instances = body.attributes().instances();
  const auto is_forbidden = [&](Index e) {
    for (std::size_t i = 0; i < forbids.size(); ++i)
      if (forbids[i] && instances[i]->table(3).cells.contains(e)) return true;
    return false;
  };
  const auto found = std::ranges::find_if(inverted, is_forbidden);
  return found != inverted.end() ? *found : none;
}

}  // namespace suture
