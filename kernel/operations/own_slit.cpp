// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/own_slit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/base/archive.hpp"
#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

// In another stroke, in elements: what is nearer to an earlier sheet is on it.
constexpr double on_earlier = 0.5;
// Of the angle between two sections of an element: with a larger one, they are the same cut.
constexpr double most_cosine = 0.7071;
// A slit, and another one that crosses it.
constexpr unsigned most_divisions = 2;
constexpr double no_height = std::numeric_limits<double>::quiet_NaN();

}  // namespace

OwnSlit::OwnSlit(const CellComplex& complex, double size)
    : complex_(complex),
      size_(size),
      kept_(complex.count(0), no_height),
      stroke_of_(complex.count(0), 0),
      times_divided_(complex.element_count()),
      section_of_(complex.element_count(), none) {}

/// The sheet may run the other way than in an earlier stroke: then its heights have the other sign.
/// Those of this stroke decide, if there are any.
std::vector<double> OwnSlit::snapped(std::vector<double> heights, Index stroke) const {
  const auto is_kept = [&](Index v) { return !std::isnan(heights[v]) && !std::isnan(kept_[v]); };
  double same = 0, other = 0;
  bool is_begun = false;
  for (Index v = 0; v < heights.size(); ++v) {
    if (!is_kept(v)) continue;
    const double product = heights[v] * kept_[v];
    if (stroke_of_[v] == stroke) {
      is_begun = true;
      same += product;
    } else if (std::abs(std::abs(kept_[v]) - std::abs(heights[v])) < on_earlier * size_) {
      other += product;
    }
  }
  const double sign = (is_begun ? same : other) < 0 ? -1 : 1;
  for (Index v = 0; v < heights.size(); ++v) {
    heights[v] *= sign;
    if (is_kept(v) &&
        (stroke_of_[v] == stroke || std::abs(kept_[v] - heights[v]) < on_earlier * size_))
      heights[v] = kept_[v];
  }
  return heights;
}

bool OwnSlit::has_heights(Index element, const std::vector<double>& heights) const {
  return std::ranges::all_of(complex_.vertices_of(element),
                             [&](Index v) { return heights[v] == kept_[v]; });
}

Blade::Earlier OwnSlit::earlier_cut(Index element, const std::vector<double>& heights,
                                    Index stroke) const {
  if (times_divided_[element] == 0) return Blade::Earlier::never;
  if (has_heights(element, heights)) return Blade::Earlier::here;
  const Section& section = sections_[section_of_[element]];
  const bool crosses = section.stroke != stroke && times_divided_[element] < most_divisions &&
                       std::abs(dot(section.normal, normal_of(element, heights))) < most_cosine;
  return crosses ? Blade::Earlier::never : Blade::Earlier::elsewhere;
}

/// That of the trilinear heights in the middle.
Vec3 OwnSlit::normal_of(Index element, const std::vector<double>& heights) const {
  Vec3 normal{};
  const Hexahedron& nodes = complex_.vertices_of(element);
  for (unsigned n = 0; n < 8; ++n)
    for (unsigned c = 0; c < 3; ++c)
      normal[c] += (n >> c & 1) != 0 ? heights[nodes[n]] : -heights[nodes[n]];
  const double length = norm(normal);
  return length > 0 ? scaled(1 / length, normal) : normal;
}

void OwnSlit::keep(const std::vector<double>& heights, std::span<const Index> divided,
                   Index stroke) {
  Index last = none;
  for (const Index e : divided) {
    if (e == last) continue;
    last = e;
    if (++times_divided_[e] == 1) {
      section_of_[e] = static_cast<Index>(sections_.size());
      sections_.push_back({normal_of(e, heights), stroke});
    }
    for (const Index v : complex_.vertices_of(e)) {
      kept_[v] = heights[v];
      stroke_of_[v] = stroke;
    }
  }
}

void OwnSlit::follow(const TopologyChange& change) {
  for (const Split& split : change.splits[0]) {
    kept_.push_back(double(kept_[split.old_cell]));
    stroke_of_.push_back(Index(stroke_of_[split.old_cell]));
  }
  for (const Split& copy : change.copies) {
    times_divided_.push_back(std::uint8_t{times_divided_[copy.old_cell]});
    section_of_.push_back(Index(section_of_[copy.old_cell]));
  }
}

void OwnSlit::state(Archive& archive) {
  archive("kept", kept_);
  archive("stroke of", stroke_of_);
  archive("times divided", times_divided_);
  archive("section of", section_of_);
  archive.member("normals", sections_, &Section::normal);
  archive.member("strokes", sections_, &Section::stroke);
}

}  // namespace suture
