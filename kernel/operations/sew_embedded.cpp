// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/sew_embedded.hpp"

#include "kernel/base/rows.hpp"
#include "kernel/operations/reunite.hpp"
#include "kernel/parts/embedding.hpp"

namespace suture {

EmbeddedSewing::EmbeddedSewing(const SewFaces& sew, BuiltScene& built)
    : sew_(sew),
      built_(built),
      complex_(built.body().complex()),
      rows_(built.body().attributes().position().rows()) {
  const Selector& selector = built.selector();
  if (sew.between) {
    one_ = mask_of(selector.elements_now((*sew.between)[0], rows_));
    other_ = mask_of(selector.elements_now((*sew.between)[1], rows_));
  } else if (sew.where) {
    one_ = other_ =
        mask_of(selector.elements_now(*sew.where, built.body().attributes().rest().rows()));
  } else {
    one_ = other_ = Mask(complex_.element_count(), 1);
  }
}

EmbeddedSewing::Mask EmbeddedSewing::mask_of(const std::vector<Index>& elements) const {
  Mask mask(complex_.element_count());
  for (const Index e : elements) mask[e] = 1;
  return mask;
}

bool EmbeddedSewing::may_join(Index one, Index other) const {
  return (one_[one] & other_[other]) != 0 || (one_[other] & other_[one]) != 0;
}

/// Two parts of one element: where the place between their centroids is in each.
bool EmbeddedSewing::are_near(Index one, Index other) const {
  if (!sew_.between) return true;
  const ElementParts& parts = built_.body().attributes().parts();
  const Vec3 at = scaled(0.5, plus(parts.of(one)->centroid, parts.of(other)->centroid));
  const auto place = [&](Index e) { return place_in(complex_.vertices_of(e), at, rows_, 4); };
  return norm(minus(place(one), place(other))) <= sew_.gap;
}

bool EmbeddedSewing::are_near(const Seam& seam) const {
  if (!sew_.between) return true;
  for (Dart k = 0; k < 4; ++k)
    if (norm(minus(row(rows_, corner_vertex(complex_, seam, k)),
                   row(rows_, partner_vertex(complex_, seam, k)))) > sew_.gap)
      return false;
  return true;
}

std::vector<std::vector<Index>> EmbeddedSewing::groups() const {
  Mask wanted = one_;
  for (std::size_t e = 0; e < wanted.size(); ++e) wanted[e] |= other_[e];
  auto groups = divided_groups(complex_, built_.body().origins(), wanted);
  std::erase_if(groups, [&](const std::vector<Index>& group) {
    for (const Index a : group)
      for (const Index b : group)
        if (a != b && may_join(a, b) && are_near(a, b)) return false;
    return true;
  });
  return groups;
}

MatchedSeams EmbeddedSewing::seams(const Naming& naming) const {
  std::vector<Index> elements;
  for (Index e = 0; e < complex_.element_count(); ++e)
    if ((one_[e] | other_[e]) != 0) elements.push_back(e);
  if (elements.empty()) return {};
  MatchedSeams matched = seams_of_cuts(complex_, built_.body().user_vertex(), elements, naming);
  const FaceContacts contacts(built_.parts());
  std::erase_if(matched.seams, [&](const Seam& seam) {
    return !may_join(element_of(seam.one), element_of(seam.other)) || !are_near(seam) ||
           !(contacts.area(seam) > 0);
  });
  return matched;
}

}  // namespace suture
