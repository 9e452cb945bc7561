// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/build/model_regions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <string_view>

#include "kernel/base/error.hpp"
#include "kernel/base/escape.hpp"

namespace suture {
namespace {

using Elements = std::vector<Index>;

/// Whether a model gives mass to its elements: it declares a mass, and its density is not 0.
bool has_mass(const ModelUse& use) {
  const suture_model& model = *use.model;
  bool declares_mass = false;
  for (std::uint32_t a = 0; a < model.attribute_count; ++a)
    declares_mass = declares_mass || (model.attributes[a].flags & SUTURE_SHARED_MASS) != 0;
  bool is_zero = false;
  for (std::uint32_t p = 0; p < model.parameter_count && p < use.parameters.size(); ++p)
    is_zero = is_zero ||
              (std::string_view(model.parameters[p].unit) == "kg/m^3" && use.parameters[p] == 0);
  return declares_mass && !is_zero;
}

Elements common(const Elements& a, const Elements& b) {
  Elements both;
  std::ranges::set_intersection(a, b, std::back_inserter(both));
  return both;
}

Elements elements_of(const ModelUse& use, const Selector& selector, const CellComplex& complex) {
  Elements elements;
  if (use.between) return elements;
  if (!std::holds_alternative<Selection::All>(use.region.what)) {
    elements = selector.elements(use.region);
    std::ranges::sort(elements);
    return elements;
  }
  for (Index e = 0; e < complex.element_count(); ++e)
    if (complex.exists(3, e)) elements.push_back(e);
  return elements;
}

std::string count_text(const Elements& elements, const RestPlaces& rest) {
  double volume = 0;
  for (const Index e : elements) volume += rest.volume(e);
  char text[64];
  std::snprintf(text, sizeof text, " element%s (%.4g m^3)", elements.size() == 1 ? "" : "s",
                volume);
  return std::to_string(elements.size()) + text;
}

/// Takes the elements of a later model away from an earlier one, in whose place it stands there.
void replace(const ModelUse& later, const Elements& by, const ModelUse& earlier, Elements& left) {
  const std::string path = later.path + "/over: ";
  Elements rest;
  std::ranges::set_difference(left, by, std::back_inserter(rest));
  if (rest.size() == left.size())
    throw InputError(path + quote(later.name) + " has no element in common with " +
                     quote(earlier.name) + "; remove \"over\", or check the region");
  if (rest.empty())
    throw InputError(path + quote(later.name) + " replaces " + quote(earlier.name) +
                     " on all of its elements; remove " + quote(earlier.name) +
                     ", or check the region");
  left = std::move(rest);
}

}  // namespace

std::vector<Elements> model_regions(const Scene& scene, const Selector& selector,
                                    const RestPlaces& rest) {
  const std::vector<ModelUse>& models = scene.models;
  std::vector<Elements> regions(models.size());
  for (std::size_t i = 0; i < models.size(); ++i) {
    const bool is_all = std::holds_alternative<Selection::All>(models[i].region.what);
    if (models.size() == 1 && is_all && !models[i].between) return regions;
    regions[i] = elements_of(models[i], selector, rest.complex());
    for (std::size_t j = 0; j < i; ++j) {
      if (models[i].over == models[j].name) {
        replace(models[i], regions[i], models[j], regions[j]);
      } else if (!models[i].adds && has_mass(models[i]) && has_mass(models[j])) {
        if (const Elements both = common(regions[j], regions[i]); !both.empty())
          throw InputError(models[i].path + ": " + quote(models[i].name) + " and " +
                           quote(models[j].name) + " both have a density on " +
                           count_text(both, rest) + ", so both masses would count there; give " +
                           "\"over\": " + '"' + models[j].name + "\" to replace " +
                           quote(models[j].name) + " there, or \"adds\": true if masses and " +
                           "forces of both are meant");
      }
    }
  }
  for (Elements& region : regions)
    if (region.size() == rest.complex().existing(3)) region.clear();
  return regions;
}

}  // namespace suture
