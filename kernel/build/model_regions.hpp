// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/attributes/own_rest.hpp"
#include "kernel/build/select.hpp"
#include "kernel/scene/scene.hpp"

namespace suture {

/// The elements of each model of a scene, ascending: its region, without the elements on which a
/// later model stands in its place ("over"). An empty list stands for all elements; of models
/// between two regions it has no meaning.
///
/// Two models with a density on one element would give it two masses. Throws InputError for them,
/// with both names, the number of elements and their volume, unless the later model says "over" or
/// "adds"; also for an "over" that leaves an earlier model without an element, or takes none from
/// it. O(models x elements).
std::vector<std::vector<Index>> model_regions(const Scene& scene, const Selector& selector,
                                              const RestPlaces& rest);

}  // namespace suture
