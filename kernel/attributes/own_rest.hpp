// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "kernel/attributes/column.hpp"
#include "kernel/attributes/shape.hpp"
#include "kernel/base/aligned.hpp"
#include "kernel/topology/cell_complex.hpp"
#include "kernel/topology/element_parts.hpp"

namespace suture {

/// Rest positions of elements that need separate ones: where faces were sewn that do not
/// coincide at rest, one rest position per vertex would bend the rest shape of the
/// elements around it. Memory: nothing while no element needs it; then 4 B per element
/// and 256 B for each that has separate ones.
class OwnRest {
 public:
  bool empty() const { return slot_of_.empty(); }
  /// `none` if the element uses the rest positions of its vertices.
  Index slot(Index element) const { return element < slot_of_.size() ? slot_of_[element] : none; }
  /// Gives the element separate rest positions. O(1), the first time O(elements).
  void set(Index element, const HexahedronNodes& x, Index element_count);
  /// To be called when the element was removed; its slot is reused.
  void remove(Index element);
  /// A new element takes the separate rest positions of another, if that has some.
  void copy(Index from, Index to, Index element_count);

  void state(Archive& archive);

  /// The slot of every element; null if empty().
  const Index* slots() const { return empty() ? nullptr : slot_of_.data(); }
  /// Rows of 4 doubles as in vertex columns: corner i of slot s is row 8 s + i.
  const double* rows() const { return rows_.data(); }
  Index count() const { return static_cast<Index>(rows_.size() / 32 - free_.size()); }

 private:
  std::vector<Index> slot_of_, free_;
  AlignedVector<double> rows_;
};

/// The positions of the corners of elements at rest, and which part of them is material: every
/// reader of rest positions uses it. For an edge or a face, those of the element of its dart_of()
/// (side 0) count.
class RestPlaces {
 public:
  RestPlaces(const CellComplex& complex, const Column& vertex_rest, const OwnRest& own,
             const ElementParts& parts)
      : complex_(complex), vertex_rest_(vertex_rest), own_(own), parts_(parts) {}

  /// x, y, z of corner i of an element, m. O(1).
  const double* corner(Index element, std::size_t i) const {
    const Index slot = own_.empty() ? none : own_.slot(element);
    if (slot != none) return own_.rows() + (std::size_t{slot} * 8 + i) * 4;
    return vertex_rest_.rows() + std::size_t{complex_.vertices_of(element)[i]} * 4;
  }
  HexahedronNodes of(Index element) const {
    HexahedronNodes x;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double* p = corner(element, i);
      x[i] = {p[0], p[1], p[2]};
    }
    return x;
  }
  /// Volume of the material of an element, m^3.
  double volume(Index element) const {
    const double whole = hexahedron_volume(of(element));
    return parts_.empty() ? whole : parts_.fraction(element) * whole;
  }
  const CellComplex& complex() const { return complex_; }
  const OwnRest& own() const { return own_; }
  const ElementParts& parts() const { return parts_; }

 private:
  const CellComplex& complex_;
  const Column& vertex_rest_;
  const OwnRest& own_;
  const ElementParts& parts_;
};

}  // namespace suture
