/* SPDX-License-Identifier: MIT
 *
 * suture/parts.h - an optional extension of functors: elements of which only a part is material.
 *
 * Part of the binary contract, under the rules of plugin.h; in a header of its own because only
 * plugins that offer the extension need it. A body may be cut out of a grid by its surface. An
 * element that the surface crosses keeps its eight nodes, some of which then lie outside the
 * material, and forces are integrated over its part. If all elements of a body that may have parts
 * are parallelepipeds at rest, functors of that shape compute them, otherwise those of
 * SUTURE_GENERAL shape.
 *
 * The host multiplies what a partial element contributes to attributes of vertices, edges and
 * faces (SUTURE_FROM_VOLUMES), its mass among them, by its fraction. Attributes of elements keep
 * the values of the whole element. A model whose functors do not offer this extension is refused
 * on bodies with partial elements. suture/model.hpp offers it for models of continuum.hpp, and
 * for functors with `allows_parts`.
 */
#ifndef SUTURE_PARTS_H
#define SUTURE_PARTS_H

#include "suture/plugin.h"

#ifdef __cplusplus
extern "C" {
#endif

/* In suture_functor.cell_columns of a functor on parts: the moments of the part in the reference
 * cube [-1,1]^3 of its element, SUTURE_PART_COMPONENTS numbers:
 *   fraction                         volume of the part over that of the element, in (0, 1]
 *   mean x, mean y, mean z           the centroid
 *   mean yz, mean xz, mean xy        about the centre of the cube
 * A functor of SUTURE_ANY_SHAPE gets parts of distorted elements, too. The fraction is then that at
 * rest, but the mean gradient of such a part does not follow from its moments in the cube. */
#define SUTURE_PART_COLUMN 0xFFFFFFFEu
#define SUTURE_PART_COMPONENTS 7u

/* The same of a functor on parts of SUTURE_GENERAL shape, SUTURE_GENERAL_PART_COMPONENTS numbers:
 *   fraction                         as above, at rest
 *   x, y, z of d_1, ... d_4          d_k: the mean of grad h_k over the part, less that over the
 *                                    element, for h_1 ... h_4 = yz, zx, xy, xyz of the cube
 * Gradients are by Y = E^-1 X, where E = dX/dx at the centre of the cube. With the signs s_kn of
 * h_k and s_an of coordinate a at node n, and c_k = sum_n s_kn E^-1 X_n / 8, the mean of grad N_n
 * over the part is that over the element plus
 *   sum_k (s_kn - sum_a s_an c_ka) E^-T d_k / 8. */
#define SUTURE_GENERAL_PART_COLUMN 0xFFFFFFFDu
#define SUTURE_GENERAL_PART_COMPONENTS 13u

/* What a functor does on a body that has partial elements. `functor` computes the same as the
 * functor with this extension, on partial elements only, and must not be NULL if the dimension is
 * 3. It is complete, with columns and extensions of its own; its dimension, cell_type, shape and
 * reads are equal. It runs if the functor with this extension is enabled.
 * NULL for vertices, edges and faces: the functor itself is right, because the columns that it
 * reads are sums over elements.
 * suture.parts/2 is the same for functors on elements of SUTURE_GENERAL shape, which the host asks
 * for it instead; its functor may read more than the one with the extension. */
#define SUTURE_PARTS_1 "suture.parts/1"
#define SUTURE_PARTS_2 "suture.parts/2"
typedef struct suture_parts_1 {
  uint32_t size;
  uint32_t reserved; /* 0 */
  const suture_functor* functor;
} suture_parts_1;

/* The layout, as in layout.h. */
#if UINTPTR_MAX == UINT64_MAX
#ifdef __cplusplus
static_assert(sizeof(suture_parts_1) == 16, "size of suture_parts_1");
static_assert(offsetof(suture_parts_1, functor) == 8, "place of functor");
#else
_Static_assert(sizeof(suture_parts_1) == 16, "size of suture_parts_1");
_Static_assert(offsetof(suture_parts_1, functor) == 8, "place of functor");
#endif
#endif

#ifdef __cplusplus
}
#endif

#endif
