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

/// For a parallelepiped: the means of grad yz = (0, z, y) and so on, which vanish over the cube.
GeneralPart general_part_of(const PartMoments& part) {
  const auto& [x, y, z] = part.centroid;
  const auto& [yz, zx, xy] = part.covariance;
  return {part.fraction, {{{0, z, y}, {z, 0, x}, {y, x, 0}, {yz + y * z, zx + z * x, xy + x * y}}}};
}

}  // namespace

ElementParts::ElementParts(std::vector<Index> elements, std::vector<PartMoments> moments,
                           std::vector<GeneralPart> general)
    : elements_(std::move(elements)),
      moments_(std::move(moments)),
      general_(std::move(general)),
      are_general_(!general_.empty()) {
  for (std::size_t i = 0; i < general_.size(); ++i) moments_[i].fraction = general_[i].fraction;
}

void ElementParts::make_general() {
  if (are_general_) return;
  are_general_ = true;
  for (const PartMoments& part : moments_) general_.push_back(general_part_of(part));
}

/// Copies are the last elements. As they follow each other, a part is as far from the last one as
/// their numbers say, unless a part between them is missing.
const PartMoments* ElementParts::of(Index element) const {
  if (elements_.empty() || element < elements_.front() || element > elements_.back())
    return nullptr;
  const std::size_t after = elements_.back() - element, last = elements_.size() - 1;
  if (after <= last && elements_[last - after] == element) return &moments_[last - after];
  const std::size_t place = position_in(elements_, element);
  return place < moments_.size() ? &moments_[place] : nullptr;
}

void ElementParts::begin_copies(const Parts& copies, std::span<const GeneralPart> general) {
  for (std::size_t i = 0; i < copies.elements.size(); ++i) {
    if (copies.moments[i].is_whole()) continue;
    elements_.push_back(copies.elements[i]);
    moments_.push_back(copies.moments[i]);
    if (general.empty()) continue;
    general_.push_back(general[i]);
    moments_.back().fraction = general[i].fraction;
  }
  copies_ = &copies;
}

void ElementParts::state(Archive& archive) {
  archive("elements", elements_);
  archive.rows<double>("moments", moments_);
  archive.require(elements_.size() == moments_.size(), "parts without moments, or the reverse");
  if (!are_general_) return;
  archive.rows<double>("general", general_);
  archive.require(elements_.size() == general_.size(), "parts without gradients, or the reverse");
}

void ElementParts::mirror(Index element) {
  const std::size_t place = position_in(elements_, element);
  if (place == moments_.size()) return;
  PartMoments& part = moments_[place];
  part.centroid[0] = -part.centroid[0];
  part.covariance[1] = -part.covariance[1];
  part.covariance[2] = -part.covariance[2];
  if (!are_general_) return;
  for (std::size_t k = 0; k < 4; ++k)  // x changes its sign, and with it zx, xy and xyz
    for (std::size_t a = 0; a < 3; ++a)
      if ((k > 0) != (a == 0)) general_[place].gradients[k][a] *= -1;
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
  std::vector<GeneralPart> general;
  for (const Index i : order) {
    elements.push_back(number(i));
    moments.push_back(parts.moments[i]);
    if (!parts.general.empty()) general.push_back(parts.general[i]);
  }
  return {std::move(elements), std::move(moments), std::move(general)};
}

}  // namespace suture
