// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <deque>
#include <vector>

#include "suture/plugin.h"

/// Models as C tables, as a plugin would provide them. Their contributions use all bits and differ
/// from element to element, so that a wrong element, order or lane changes a sum.
namespace suture::fake {

inline double rest(const suture_batch* b, int node, int component, int lane) {
  return b->rest[(node * 3 + component) * 8 + lane];
}

/// Some smooth positive function of the element's geometry and a local cell.
inline double value(const suture_batch* b, int k, int component, int lane) {
  double s = 0.1 * (component + 1);
  for (int n = 0; n < 8; ++n)
    for (int c = 0; c < 3; ++c)
      s += std::abs(rest(b, n, c, lane)) * (1 + 0.01 * ((n + k) % 8) + 0.1 * c);
  return std::sqrt(s);
}

template <int Cells, int Components>
suture_status contribute(const suture_context* context, const suture_batch* batch, double* out) {
  for (int k = 0; k < Cells; ++k)
    for (int c = 0; c < Components; ++c)
      for (int lane = 0; lane < 8; ++lane)
        out[(k * Components + c) * 8 + lane] = context->parameters[0] * value(batch, k, c, lane);
  return SUTURE_OK;
}

/// rho V / 8 of a box, as it comes from the edges at X0: the closed form.
inline suture_status box_mass(const suture_context* context, const suture_batch* batch,
                              double* out) {
  for (int lane = 0; lane < 8; ++lane) {
    const double volume = (rest(batch, 1, 0, lane) - rest(batch, 0, 0, lane)) *
                          (rest(batch, 2, 1, lane) - rest(batch, 0, 1, lane)) *
                          (rest(batch, 4, 2, lane) - rest(batch, 0, 2, lane));
    for (int k = 0; k < 8; ++k) out[k * 8 + lane] = context->parameters[0] * volume / 8;
  }
  return SUTURE_OK;
}

/// Lets hexahedra give what the function says, as a plugin's constant tables would.
inline void contribute_by(suture_attribute& attribute, suture_contribution_fn function) {
  static std::deque<suture_contribution> tables;
  attribute.contribution_count = 1;
  attribute.contributions = &tables.emplace_back(
      suture_contribution{sizeof(suture_contribution), SUTURE_HEXAHEDRON, function});
}

inline suture_attribute attribute(const char* name, std::uint32_t dimension,
                                  std::uint32_t components, suture_contribution_fn contribution,
                                  std::uint32_t policy = SUTURE_FROM_VOLUMES,
                                  std::uint32_t flags = 0, double initial = 0) {
  suture_attribute a{};
  a.size = sizeof(a);
  a.dimension = dimension;
  a.components = components;
  a.policy = policy;
  a.flags = flags;
  a.name = name;
  a.unit = "1";
  a.doc = "";
  a.initial = initial;
  if (contribution != nullptr) contribute_by(a, contribution);
  return a;
}

inline suture_parameter parameter() {
  suture_parameter p{};
  p.size = sizeof(p);
  p.name = "rho";
  p.unit = "kg/m^3";
  p.doc = "";
  p.maximum = 1e9;
  return p;
}

struct Model {
  std::vector<suture_attribute> attributes;
  std::vector<suture_functor> functors;
  suture_parameter parameters = parameter();
  suture_model table{};

  explicit Model(std::vector<suture_attribute> a, std::vector<suture_functor> f = {})
      : attributes(std::move(a)), functors(std::move(f)) {
    table.size = sizeof(table);
    table.id = "fake";
    table.parameter_count = 1;
    table.parameters = &parameters;
    table.attribute_count = static_cast<std::uint32_t>(attributes.size());
    table.attributes = attributes.data();
    table.functor_count = static_cast<std::uint32_t>(functors.size());
    table.functors = functors.data();
  }
  Model(const Model&) = delete;
};

/// Position of each attribute in everything().
enum Attribute { mass, edge, face, volume, vertex, plain, load, memory };

/// One attribute per dimension summed from the elements, a share of the mass, and
/// one of each other policy.
inline std::vector<suture_attribute> everything() {
  return {attribute("mass", 0, 1, &contribute<8, 1>, SUTURE_FROM_VOLUMES, SUTURE_SHARED_MASS),
          attribute("edge", 1, 2, &contribute<12, 2>),
          attribute("face", 2, 1, &contribute<6, 1>),
          attribute("volume", 3, 4, &contribute<1, 4>),
          attribute("vertex", 0, 3, &contribute<8, 3>),
          attribute("plain", 1, 1, nullptr, SUTURE_COPY, 0, 5),
          attribute("load", 0, 3, nullptr, SUTURE_SHARE),
          attribute("memory", 2, 2, nullptr, SUTURE_ZERO, SUTURE_TRIAL, 7)};
}

}  // namespace suture::fake
