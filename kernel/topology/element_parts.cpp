// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/element_parts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernel/base/archive.hpp"
#include "kernel/base/error.hpp"

namespace suture {
namespace {

// Rounding may lift a mean above 1, which it reaches for parts at a corner.
constexpr double bound = 1 + 1e-9;

/// What is wrong, or "".
std::string fault_of(const PartMoments& part) {
  if (!(part.fraction > 0 && part.fraction <= bound))
    return "has the fraction " + std::to_string(part.fraction) + ", expected 0 to 1, without 0";
  const auto is_bounded = [](double x) { return std::abs(x) <= bound; };
  if (!std::ranges::all_of(part.centroid, is_bounded)) return "has a centroid outside the element";
  if (!std::ranges::all_of(part.covariance, is_bounded))
    return "has a covariance that no part of an element has";
  return "";
}

}  // namespace

const PartMoments* ElementParts::of(Index element) const {
  const std::size_t place = position_in(elements_, element);
  return place < moments_.size() ? &moments_[place] : nullptr;
}

void ElementParts::begin_copies(const Parts& copies) {
  elements_.insert(elements_.end(), copies.elements.begin(), copies.elements.end());
  moments_.insert(moments_.end(), copies.moments.begin(), copies.moments.end());
  copies_ = &copies;
}

void ElementParts::state(Archive& archive) {
  archive("elements", elements_);
  archive.rows<double>("moments", moments_);
  archive.require(elements_.size() == moments_.size(), "parts without moments, or the reverse");
}

void ElementParts::mirror(Index element) {
  const std::size_t place = position_in(elements_, element);
  if (place == moments_.size()) return;
  PartMoments& part = moments_[place];
  part.centroid[0] = -part.centroid[0];
  part.covariance[1] = -part.covariance[1];
  part.covariance[2] = -part.covariance[2];
}

ElementParts number_parts(const Parts& parts, Index element_count,
                          const std::function<Index(Index)>& element_of,
                          const std::function<std::string(Index)>& name) {
  std::vector<Index> order(parts.elements.size());
  std::iota(order.begin(), order.end(), Index{0});
  for (const Index i : order) {
    if (parts.elements[i] >= element_count)
      throw InputError("the mesh has a part of element " + std::to_string(parts.elements[i]) +
                       ", but only " + std::to_string(element_count) + " elements");
    if (const std::string fault = fault_of(parts.moments[i]); !fault.empty())
      throw InputError("the part of element " + name(parts.elements[i]) + " that is material " +
                       fault);
  }
  const auto number = [&](Index i) { return element_of(parts.elements[i]); };
  std::ranges::sort(order, {}, number);
  std::vector<Index> elements;
  std::vector<PartMoments> moments;
  for (const Index i : order) {
    elements.push_back(number(i));
    moments.push_back(parts.moments[i]);
  }
  return {std::move(elements), std::move(moments)};
}

}  // namespace suture
