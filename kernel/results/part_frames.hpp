// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/output/frame.hpp"
#include "kernel/parts/embedding.hpp"

namespace suture {

/// For a body with partial elements: replaces each of them in a frame, which has all vertices and
/// elements with their values, by the tetrahedra of its material. Points of these have interpolated
/// values (whole numbers: -1 where a point is no vertex), tetrahedra those of their element; nodes
/// outside the material are left out, and so are removed elements.
void show_parts(Frame& frame, const Parts& parts, const Embedding& embedding,
                const CellComplex& complex);

/// The same with the triangles of the surface instead of all cells, and the field "cut" of them: 1
/// where a cut or a removal has laid the inside open.
void show_surface(Frame& frame, const Embedding& embedding);

}  // namespace suture
