// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/results/stress_groups.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kernel/plugin_host/output_fields.hpp"
#include "kernel/topology/disjoint_sets.hpp"

namespace suture {
namespace {

constexpr double rounding = 1e-6, always = 0.5, against_smooth = 4;
constexpr std::array<int, hexahedron::faces> opposite_face{2, 3, 0, 1, 5, 4};

bool differs(const Column& column) {
  const int components = column.spec().components;
  for (Index row = 1; row < column.size(); ++row)
    for (int c = 0; c < components; ++c)
      if (column.get(row, c) != column.get(0, c)) return true;
  return false;
}

/// The instance that the stress of an element comes from.
Index last_of(std::span<const Index> provide, const Attributes& attributes, Index element) {
  Index last = none;
  for (const Index i : provide)
    if (attributes.instances()[i]->table(3).cells.row(element) != none) last = i;
  return last;
}

}  // namespace

ParameterJumps::ParameterJumps(const CellComplex& complex, const Instance& instance)
    : complex_(complex), instance_(instance) {
  const auto add = [&](const Column* column) {
    if (column && column->dimension() == 3 && differs(*column)) columns_.push_back(column);
  };
  std::ranges::for_each(instance.parameter_columns(), add);
  std::ranges::for_each(instance.columns_given_by_cell(), add);
}

double ParameterJumps::difference(const Column& column, Index one, Index other) const {
  const Index a = instance_.table(3).cells.row(one), b = instance_.table(3).cells.row(other);
  double apart = 0, first = 0, second = 0;
  for (int c = 0; c < column.spec().components; ++c) {
    const double x = column.get(a, c), y = column.get(b, c);
    apart += (x - y) * (x - y);
    first += x * x;
    second += y * y;
  }
  return apart == 0 ? 0 : std::sqrt(apart / std::max(first, second));
}

/// Between the element and the one behind it as seen from the face; infinite without one.
double ParameterJumps::difference_behind(const Column& column, Index element, int face) const {
  const Index behind = complex_.neighbour(element, opposite_face[face]);
  if (behind == none || instance_.table(3).cells.row(behind) == none)
    return std::numeric_limits<double>::infinity();
  return difference(column, element, behind);
}

bool ParameterJumps::is_at(Index element, int face) const {
  const Dart mate = complex_.beta3(face_dart(element, face));
  const Index other = element_of(mate);
  return std::ranges::any_of(columns_, [&](const Column* column) {
    const double here = difference(*column, element, other);
    if (here <= rounding) return false;
    if (here > always) return true;
    const double smooth =
        std::min(difference_behind(*column, element, face),
                 difference_behind(*column, other, static_cast<int>(local_face(mate))));
    return here > against_smooth * smooth;
  });
}

ZeroedVector<Index> stress_groups(const CellComplex& complex, const Attributes& attributes,
                                  std::span<const double> stress, const ShownCells& elements) {
  const auto& instances = attributes.instances();
  std::vector<Index> provide;
  for (Index i = 0; i < instances.size(); ++i)
    if (provides_field(instances[i]->model(), 3, "stress", 6)) provide.push_back(i);
  ZeroedVector<Index> group(complex.element_count());
  std::vector<ParameterJumps> jumps;
  for (const Index i : provide) jumps.emplace_back(complex, *instances[i]);
  const bool may_jump =
      std::ranges::any_of(jumps, [](const ParameterJumps& j) { return j.may_be(); });
  for (Index i = 0; i < elements.size(); ++i) {
    const Index e = elements[i];
    group[e] = std::isnan(stress[std::size_t{6} * e]) ? none : last_of(provide, attributes, e);
  }
  if (!may_jump) return group;

  // All elements, so that the groups are the same for each of several processes.
  const Index count = complex.element_count();
  DisjointSets sets(count);
  const auto instance_of = [&](Index e) {
    return complex.exists(3, e) ? last_of(provide, attributes, e) : none;
  };
  const auto is_jump = [&](Index e, int face, Index other) {
    for (std::size_t i = 0; i < provide.size(); ++i) {
      const CellSet& cells = instances[provide[i]]->table(3).cells;
      if (jumps[i].may_be() && cells.row(e) != none && cells.row(other) != none &&
          jumps[i].is_at(e, face))
        return true;
    }
    return false;
  };
  for (Index e = 0; e < count; ++e) {
    const Index own = instance_of(e);
    if (own == none) continue;
    for (int f = 0; f < hexahedron::faces; ++f) {
      const Index other = complex.neighbour(e, f);
      if (other != none && e < other && instance_of(other) == own && !is_jump(e, f, other))
        sets.unite(e, other);
    }
  }
  std::vector<Index> number(count, none);
  Index next = 0;
  for (const Index i : provide)
    for (Index e = 0; e < count; ++e)
      if (sets.find(e) == e && instance_of(e) == i) number[e] = next++;
  for (Index i = 0; i < elements.size(); ++i) {
    const Index e = elements[i];
    if (group[e] != none) group[e] = number[sets.find(e)];
  }
  return group;
}

}  // namespace suture
