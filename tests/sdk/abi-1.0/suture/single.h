/* SPDX-License-Identifier: MIT
 *
 * suture/single.h - an optional extension of functors: the tangent in single precision.
 *
 * Part of the binary contract, under the rules of plugin.h; in a header of its own because
 * only plugins that offer the extension need it. suture/model.hpp does so for every
 * functor with `single_tangent`, which hexahedra of continuum.hpp have.
 */
#ifndef SUTURE_SINGLE_H
#define SUTURE_SINGLE_H

#include "suture/plugin.h"

#ifdef __cplusplus
extern "C" {
#endif

#define SUTURE_SINGLE_LANES 16u /* cells in a batch of floats */

/* SUTURE_SINGLE_LANES cells, in arrays with the layout of suture_batch. Every lane holds a
 * cell; several may hold the same one. Positions and rest positions are relative to those of
 * node 0 of their cell, subtracted in double precision: their accuracy does not depend on
 * the distance from the origin. */
typedef struct suture_single_batch {
  uint32_t size;
  uint32_t lanes; /* SUTURE_SINGLE_LANES */
  uint32_t nodes;
  uint32_t reserved; /* 0 */
  double time;
  double dt;
  const float* rest;
  const float* position;
  const float* velocity;
  const float* const* cell_columns;
  const float* const* vertex_columns;
  const uint32_t* cell_ids; /* lanes */
} suture_single_batch;

/* Directional derivative of the force in single precision, for preconditioners, which need
 * few digits: df = (df/dx) dx + (df/dv) dv. Only for functors whose force depends on
 * differences of positions and of rest positions. Where a functor does not offer it, the
 * host uses suture.tangent/1. [worker] */
#define SUTURE_TANGENT_SINGLE_1 "suture.tangent-single/1"
typedef struct suture_tangent_single_1 {
  uint32_t size;
  uint32_t lanes;   /* SUTURE_SINGLE_LANES */
  uint32_t reads;   /* suture_read bits: what is gathered here, whatever the functor reads */
  uint32_t columns; /* how many of the functor's cell columns are gathered, from the first;
                       UINT32_MAX: all, and those of vertices. Lists of none are NULL */
  suture_status (*apply)(const suture_context* context, const suture_single_batch* batch,
                         const float* dx, const float* dv, float* df);
} suture_tangent_single_1;

/* The layout, as in layout.h. */
#if UINTPTR_MAX == UINT64_MAX
#ifdef __cplusplus
#define SUTURE_LAYOUT(condition, text) static_assert(condition, text)
#else
#define SUTURE_LAYOUT(condition, text) _Static_assert(condition, text)
#endif
SUTURE_LAYOUT(sizeof(suture_single_batch) == 80, "size of suture_single_batch");
SUTURE_LAYOUT(offsetof(suture_single_batch, nodes) == 8, "place of nodes");
SUTURE_LAYOUT(offsetof(suture_single_batch, time) == 16, "place of time");
SUTURE_LAYOUT(offsetof(suture_single_batch, rest) == 32, "place of rest");
SUTURE_LAYOUT(offsetof(suture_single_batch, cell_columns) == 56, "place of cell_columns");
SUTURE_LAYOUT(offsetof(suture_single_batch, cell_ids) == 72, "place of cell_ids");
SUTURE_LAYOUT(sizeof(suture_tangent_single_1) == 24, "size of suture_tangent_single_1");
SUTURE_LAYOUT(offsetof(suture_tangent_single_1, reads) == 8, "place of reads");
SUTURE_LAYOUT(offsetof(suture_tangent_single_1, apply) == 16, "place of apply");
#undef SUTURE_LAYOUT
#endif

#ifdef __cplusplus
}
#endif

#endif
