// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/inversion.hpp"

#include <algorithm>

#include "kernel/attributes/mean_gradient.hpp"
#include "kernel/forces/loops/dispatch.hpp"
#include "kernel/topology/rest_shape.hpp"

namespace suture {
namespace {

HexahedronNodes current(const CellComplex& complex, Attributes& attributes, Index element) {
  HexahedronNodes x;
  const double* positions = attributes.position().rows();
  for (std::size_t n = 0; n < x.size(); ++n) {
    const double* row = positions + std::size_t{complex.vertices_of(element)[n]} * 4;
    x[n] = {row[0], row[1], row[2]};
  }
  return x;
}

/// Whether only a part of the element is material, and that part is not inverted: corners of the
/// element may turn inside out where there is nothing.
bool has_sound_part(const CellComplex& complex, Attributes& attributes, Index element) {
  const PartMoments* const part = attributes.parts().of(element);
  return part != nullptr &&
         determinant(mean_edges(current(complex, attributes, element), part)) > 0;
}

}  // namespace

std::vector<Index> find_inverted(const CellComplex& complex, Attributes& attributes,
                                 loops::Rows elements) {
  constexpr Index part = 4096;
  const Index last = std::min(elements.end, complex.element_count());
  const Index* nodes = complex.vertices().data()->data();
  const std::uint8_t* live = attributes.kernel(3).cells.live().data();
  const double* position = attributes.position().rows();
  const auto count = hot_loops().inverted;
  std::vector<Index> found;
  for (Index begin = elements.begin; begin < last; begin += part) {
    Index first = none;
    const Index end = std::min(begin + part, last);
    Index here = count(nodes, live, position, begin, end, &first);
    for (Index e = first; here > 0; ++e)
      if (count(nodes, live, position, e, e + 1, &first) != 0) {
        found.push_back(e);
        --here;
      }
  }
  if (!attributes.parts().empty())
    std::erase_if(found, [&](Index e) { return has_sound_part(complex, attributes, e); });
  return found;
}

std::vector<Index> find_inverted(Body& body, const std::vector<Index>& allowed) {
  const auto find = [&] {
    BodyShare* const share = body.share();
    if (!share) return find_inverted(body.complex(), body.attributes());
    const PartialRows::Enough enough(body.attributes().partial_rows(),
                                     PartialRows::Extent::at_cells);
    return share->join_lists(find_inverted(body.complex(), body.attributes(), share->elements()));
  };
  std::vector<Index> found;
  std::ranges::set_difference(find(), allowed, std::back_inserter(found));
  return found;
}

namespace {

std::vector<Index> forbidden(const Body& body, const std::vector<Index>& inverted,
                             const std::vector<bool>& forbids) {
  const auto& instances = body.attributes().instances();
  std::vector<Index> found;
  std::ranges::copy_if(inverted, std::back_inserter(found), [&](Index e) {
    for (std::size_t i = 0; i < forbids.size(); ++i)
      if (forbids[i] && instances[i]->table(3).cells.contains(e)) return true;
    return false;
  });
  return found;
}

/// The first element of a group of more than few_turned, or `none`. `elements`: ascending.
Index first_of_many(const CellComplex& complex, const std::vector<Index>& elements) {
  std::vector<bool> visited(elements.size());
  for (std::size_t first = 0; first < elements.size(); ++first) {
    if (visited[first]) continue;
    std::vector<std::size_t> group{first};
    visited[first] = true;
    for (std::size_t next = 0; next < group.size(); ++next)
      for (int face = 0; face < hexahedron::faces; ++face) {
        const Index other = complex.neighbour(elements[group[next]], face);
        const auto found = std::ranges::lower_bound(elements, other);
        if (other == none || found == elements.end() || *found != other) continue;
        const auto place = static_cast<std::size_t>(found - elements.begin());
        if (!visited[place]) group.push_back(place);
        visited[place] = true;
      }
    if (group.size() > few_turned) return elements[first];
  }
  return none;
}

bool has_turned(Body& body, Index element) {
  if (body.attributes().parts().of(element) != nullptr) return true;  // as a whole
  return std::ranges::any_of(gauss_jacobians(current(body.complex(), body.attributes(), element)),
                             [](double j) { return !(j > 0); });
}

}  // namespace

Inversion judge_inversion(Body& body, const std::vector<Index>& inverted,
                          const std::vector<bool>& forbids) {
  const std::vector<Index> all = forbidden(body, inverted, forbids);
  Inversion result;
  if (all.empty()) return result;
  result.first = all.front();
  std::ranges::copy_if(all, std::back_inserter(result.turned),
                       [&](Index e) { return has_turned(body, e); });
  const bool are_many =
      all.size() * 100 > std::size_t{percent_inverted} * body.complex().existing(3);
  result.fatal = are_many ? result.first : first_of_many(body.complex(), result.turned);
  return result;
}

}  // namespace suture
