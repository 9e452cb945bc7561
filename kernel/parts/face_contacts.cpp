// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/face_contacts.hpp"

#include "kernel/parts/part_writer.hpp"

namespace suture {

const SideTriangles& FaceContacts::triangles_of(Index element) const {
  if (!materials_.is_part(element)) return SideTriangles::of_full_element();
  const auto known = triangles_.find(element);
  if (known != triangles_.end()) return known->second;
  Material own;
  return triangles_.emplace(element, SideTriangles(materials_.of(element, own))).first->second;
}

double FaceContacts::area(const Seam& seam) const {
  const auto mine = triangles_of(element_of(seam.one))[cube_side_of(seam.one)],
             theirs = triangles_of(element_of(seam.other))[cube_side_of(seam.other)];
  return covered(mine, theirs).area + covered(theirs, mine).area;
}

Parts FaceContacts::uncovered(std::span<const Seam> seams) const {
  Parts open;
  PartWriter writer(open);
  const auto show = [&](Dart here, Dart there) {
    const unsigned side = cube_side_of(here);
    const auto others = triangles_of(element_of(there))[cube_side_of(there)];
    for (const SideTriangle& triangle : triangles_of(element_of(here))[side])
      if (!is_covered(triangle, others))
        writer.add_open_triangle(element_of(here), triangle.places(cube_sides[side]));
  };
  for (const auto& [one, other] : seams) {
    if (!materials_.is_part(element_of(one)) && !materials_.is_part(element_of(other))) continue;
    show(one, other);
    show(other, one);
  }
  return open;
}

}  // namespace suture
