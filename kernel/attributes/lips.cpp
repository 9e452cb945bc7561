// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/lips.hpp"

#include <algorithm>

#include "kernel/base/sort_unique.hpp"
#include "kernel/topology/seam.hpp"

namespace suture {
namespace {

FunctorCorner corner_at(Dart dart) {
  return {element_of(dart), hexahedron::dart_vertex[local(dart)]};
}

}  // namespace

bool acts_on_lips(const suture_model& model) {
  return std::ranges::any_of(std::span(model.functors, model.functor_count),
                             [](const suture_functor& f) { return acts_on_lips(f); });
}

std::vector<Seam> faces_between(const CellComplex& complex, std::span<const Index> a,
                                const std::vector<bool>& is_other) {
  std::vector<Seam> faces;
  for (const Index e : a)
    for (const Dart side : sides_of(e))
      if (const Dart other = complex.beta3(side); other != none && is_other[element_of(other)])
        faces.push_back({side, other});
  std::ranges::sort(faces, {}, &Seam::one);
  return faces;
}

std::vector<Dart> faces_to_open(const Attributes& attributes) {
  std::vector<Dart> faces;
  for (const auto& instance : attributes.instances())
    for (const Seam& lips : instance->lips)
      faces.push_back(std::min(lips.one, face_of(lips.other)));
  sort_unique(faces);
  return faces;
}

const Seam* lips_at(const Instance& instance, const CellComplex& complex, Index face) {
  const Dart side = face_of(complex.dart_of(2, face));
  const auto found = std::ranges::lower_bound(instance.lips, side, {}, &Seam::one);
  if (found == instance.lips.end() || found->one != side) return nullptr;
  return is_open(complex, found->one) && is_open(complex, found->other) ? &*found : nullptr;
}

// The darts of a face run counter-clockwise as seen from inside its element: corners 0, 3, 2, 1 are
// counter-clockwise as seen from the other lip.
FunctorCorners corners_of(const Seam& lips) {
  FunctorCorners corners;
  for (Dart i = 0; i < 4; ++i) {
    const Dart k = (4 - i) % 4;
    corners[i] = corner_at(lips.one + k);
    corners[4 + i] = corner_at(partner_dart(lips, k));
  }
  return corners;
}

FunctorCorners corners_of(const Instance& instance, const suture_functor& functor,
                          const CellComplex& complex, Index cell) {
  if (acts_on_lips(functor)) return corners_of(*lips_at(instance, complex, cell));
  hexahedron::Local local[8]{};
  const Index element = cell_corners(complex, static_cast<int>(functor.dimension), cell, local);
  FunctorCorners corners;
  for (std::size_t n = 0; n < 8; ++n) corners[n] = {element, local[n]};
  return corners;
}

}  // namespace suture
