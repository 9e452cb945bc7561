/* SPDX-License-Identifier: MIT
 *
 * suture/lips.h - functors between two regions of a body.
 *
 * Part of the binary contract, under the rules of plugin.h; in a header of its own because only
 * plugins with such functors need it. A scene names two regions whose elements have faces in
 * common ("between"). The host opens these faces at the start of the run; from then on each is two
 * lips, opposite each other, that only models hold together.
 *
 * A functor with this cell_type visits each pair of lips as one cell, of dimension 2 and with 8
 * nodes: 0..3 are those of the lip of the first region, counter-clockwise as seen from the second,
 * so that the normal points to it; 4..7 are those of the other lip, node 4 + i having been one with
 * node i. `faces` is SUTURE_ALL_FACES, cell_columns are attributes of faces, and belong to the
 * first lip. Mass comes from other models: such a model has no attributes of other dimensions.
 * Pairs whose faces were sewn, or of which an element was removed, are not visited.
 *
 * Hosts older than this type refuse the model by name.
 */
#ifndef SUTURE_LIPS_H
#define SUTURE_LIPS_H

#include "suture/plugin.h"

/* After suture_cell_type. */
#define SUTURE_LIPS 5u

#endif
