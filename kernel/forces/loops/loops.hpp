// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdint.h>

#include "suture/plugin.h"
#include "suture/single.h"

/// The hot loops of a step, compiled once per instruction set from loops.cpp and reached through
/// one table of function pointers. Only plain data crosses this header: an inline function of the
/// standard library that was compiled for AVX-512 must not become the program's only copy of it.
///
/// Vertex columns are rows of 4 doubles, 32-byte aligned, the fourth zero.
namespace suture::loops {

/// Rows [begin, end) of a table, consecutive in their blocks of 8.
struct Rows {
  uint32_t begin, end;
};

/// A column of the functor's own cells: in blocks of 8, of vertices in rows.
struct CellColumn {
  const double* data;
  double* trial;   ///< trial copy, same layout, or null
  uint64_t block;  ///< doubles from block to block; 0: constant
  uint32_t components;
  uint32_t stride;  ///< doubles from row to row, of vertices; 0: blocks
};

/// A column of the vertices, gathered per node.
struct VertexColumn {
  const double* data;
  const uint32_t* rows;  ///< vertex -> row, or null: the vertex itself
  uint32_t components;
  uint32_t stride;  ///< doubles from vertex to vertex
};

/// One functor on one table: the data common to all its batches.
struct Job {
  const uint32_t* nodes;    ///< node_count vertices per cell
  const uint32_t* cells;    ///< row -> position in `nodes`, or null: the row itself
  const uint32_t* ids;      ///< position in `nodes` -> id as users see it, or null
  const uint32_t* row_ids;  ///< instead: row -> id, or null
  uint32_t node_count;      ///< 1, 2, 4 or 8
  uint32_t cell_column_count;
  uint32_t vertex_column_count;
  uint32_t has_trial;  ///< some cell column has a trial copy
  uint32_t varying_column_count;
  const uint32_t* varying_columns;  ///< places of the cell columns that differ from cell to cell
  const CellColumn* cell_columns;
  const VertexColumn* vertex_columns;
  const double* rest;  ///< rows; null: not gathered, the functor sees zeros
  const double* position;
  const double* velocity;
  double* force;
  double time, dt;
  suture_force_fn function;
  uint32_t skewed_begin;       ///< no batch holds rows before and from here on
  const uint8_t* live;         ///< a bit per row, a byte per block of 8; null: all rows
  const uint32_t* rest_slots;  ///< position in `nodes` -> slot in own_rest or UINT32_MAX; or null
  const double* own_rest;      ///< rows: node n of slot s is row node_count s + n
};

/// The rows of a batch: the live rows of a block, moved to the front. The remaining lanes repeat
/// the last one. valid = 0 if there are none.
struct BatchRows {
  uint32_t row[8];
  uint32_t valid;
};

/// Rows row .. row+count-1 of one block.
static inline BatchRows live_rows(const uint8_t* live, uint32_t row, uint32_t count) {
  BatchRows rows = {{0, 0, 0, 0, 0, 0, 0, 0}, 0};
  const uint32_t bits = live ? live[row / 8] : 0xFFu;
  for (uint32_t r = row; r < row + count; ++r)
    if (bits >> r % 8 & 1) rows.row[rows.valid++] = r;
  for (uint32_t l = rows.valid; l < 8 && rows.valid != 0; ++l)
    rows.row[l] = rows.row[rows.valid - 1];
  return rows;
}

/// The memory of one thread; never shared. `scratch` is 64-byte aligned and holds
/// scratch_doubles(job); the pointer lists have one entry per declared column. Results of a
/// function of the plugin end at `results_end`, where memory ends that it may write
/// (guarded_array.hpp).
struct Worker {
  const suture_context* context;
  double* scratch;
  const double** cell_columns;
  const double** vertex_columns;
  double** trial_columns;
  float* single_scratch;  ///< for batches of floats: 64-byte aligned, single_scratch_floats(job)
  const float** single_cell_columns;
  const float** single_vertex_columns;
  /// Reports a batch whose status is not 0. The loop continues, so that the lowest cell is found
  /// whatever the threads do.
  void (*failed)(void* data, suture_status status, const suture_batch* batch);
  /// In a catch block: the plugin threw an exception in the present batch. The loop ends.
  void (*thrown)(void* data);
  void* data;
  const suture_batch** present;  ///< set to the batch whose plugin is called, null after
  double* results_end;           ///< of max_results doubles, 64-byte aligned
  double* more_results_end;      ///< the same again, for a function with two results
};
/// Bounds of a hexahedron fit; forces and fields are smaller.
enum : uint32_t { max_results = 8 * 6 * 8 };

/// Arrays that a batch points into.
struct alignas(64) Buffers {
  double rest[192], position[192], velocity[192];
  uint32_t ids[8];
};

/// Sums over the vertices of a pass, for the ledger of work and for the apparent frequency of the
/// motion (motion_sums.hpp). a = f / m + gravity; v- and v+ are the velocities before and after the
/// kicks of the pass.
struct PassSums {
  double before;   ///< sum m a . v-, W
  double after;    ///< sum m a . v+, W
  double inertia;  ///< sum m v+ . v+, twice the kinetic energy, J
};

/// One pass of an integrator over vertices [begin, end).
///   a = f / m + gravity
///   v = decay[k] v + gain[k] a      for each of the `kicks`
///   x = x + drift v,  f = 0         if drifting
/// Vertices that are not live are skipped.
struct Motion {
  double* position;
  double* velocity;
  double* force;
  const double* mass;
  double gravity[4];
  double decay[2], gain[2];
  double drift;
  const uint8_t* live;  ///< as in Job
};

/// A sum over vertices [begin, end), in a fixed order. Components are held that have a bit in
/// `fixed` (1 x, 2 y, 4 z), the others are free. Nothing is written.
using VertexSum = double (*)(const Motion*, const double* fixed, uint32_t begin, uint32_t end);

/// Sums of the search for rest over vertices [begin, end), free components only.
struct RestSums {
  double residual;  ///< sum |f + f_ext|^2
  double external;  ///< sum |f_ext|^2
  double reaction;  ///< sum |f + f_ext|^2 over constrained components
  double kinetic;   ///< sum m v^2 / 2
  double work;      ///< - sum dx . df
  double inertia;   ///< sum m dx . dx
};

struct RestInput {
  const double* position;
  const double* velocity;
  const double* force;     ///< f: of the models and the loads
  const double* external;  ///< rows of the loads alone, or null
  const double* mass;
  const double* fixed;  ///< bits 1 x, 2 y, 4 z as a double
  double gravity[4];
  double* old_position;  ///< at the previous check; replaced by the current one
  double* old_force;
};

/// Elements whose stretch is checked: row -> element -> 8 vertices.
struct Stretch {
  const uint32_t* nodes;  ///< 8 vertices per element
  const uint32_t* cells;  ///< row -> element, or null: the row itself
  const double* position;
  const double* metric;  ///< in blocks of 8 rows; the test defines its meaning
  uint64_t block;        ///< doubles from block to block; 0: constant
  double bound;
};

/// out += df/dx (dx d) + df/dv (dv d), by a functor's suture.tangent/1, in double precision. Rows
/// of 3 doubles or of 4 floats per vertex, these 16-byte aligned and the fourth 0.
template <class Real>
struct Product {
  decltype(suture_tangent_1::apply) function;
  const Real* direction;  ///< d
  double dx, dv;
  Real* out;
};
/// The same by its suture.tangent-single/1.
struct SingleProduct {
  decltype(suture_tangent_single_1::apply) function;
  const float* direction;
  double dx, dv;
  float* out;
};

struct Table {
  uint32_t size;
  uint32_t reserved;
  const char* isa;
  /// Forces of all cells in `ranges` added to the vertices, in order.
  void (*forces)(const Job*, const Worker*, const Rows* ranges, uint32_t count);
  /// Products of all cells in `ranges`, in order.
  void (*tangents_of_doubles)(const Job*, const Worker*, const Rows* ranges, uint32_t count,
                              const Product<double>*);
  void (*tangents_of_floats)(const Job*, const Worker*, const Rows* ranges, uint32_t count,
                             const Product<float>*);
  void (*single_tangents)(const Job*, const Worker*, const Rows* ranges, uint32_t count,
                          const SingleProduct*);
  /// Fills `batch` with some rows, at least one; they ascend (extensions).
  void (*gather)(const Job*, const Worker*, const BatchRows*, Buffers*, suture_batch*);
  /// Passes of integrators; they return 1 if a velocity is not finite.
  int32_t (*kick_drift)(const Motion*, uint32_t begin, uint32_t end, PassSums*);
  int32_t (*kick_kick_drift)(const Motion*, uint32_t begin, uint32_t end, PassSums*);
  int32_t (*kick)(const Motion*, uint32_t begin, uint32_t end, PassSums*);
  /// sum m v^2 / 2, v after the first kick of the motion, which moves free components.
  VertexSum kinetic;
  /// sum m a^2 over free components.
  VertexSum forcing;
  RestSums (*rest_sums)(const RestInput*, uint32_t begin, uint32_t end);
  /// The number of live elements in [begin, end) with a corner Jacobian <= 0; *first is set to the
  /// first of them.
  uint32_t (*inverted)(const uint32_t* nodes, const uint8_t* live, const double* position,
                       uint32_t begin, uint32_t end, uint32_t* first);
  /// Finds the rows in [begin, end), begin a multiple of 8, that may exceed a bound; the others
  /// certainly do not. Writes them to `found`, which has room for all rows, and returns their
  /// number.
  ///   strained   largest eigenvalue of F^T F above `bound` (metric: G, 9 components,
  ///              a quarter of the reciprocals of the mean edge vectors at rest)
  ///   elongated  an edge longer than its limit (metric: squares of the limits, 12)
  uint32_t (*strained)(const Stretch*, uint32_t begin, uint32_t end, uint32_t* found);
  uint32_t (*elongated)(const Stretch*, uint32_t begin, uint32_t end, uint32_t* found);
};

/// Doubles of Worker::scratch that a job needs.
inline uint64_t scratch_doubles(const Job& job) {
  uint64_t n = 0;
  for (uint32_t i = 0; i < job.vertex_column_count; ++i)
    n += 8u * job.node_count * job.vertex_columns[i].components;
  for (uint32_t i = 0; i < job.cell_column_count; ++i) n += 16u * job.cell_columns[i].components;
  return n;
}

/// Floats of Worker::single_scratch that a job needs.
inline uint64_t single_scratch_floats(const Job& job) {
  uint64_t n = 0;
  for (uint32_t i = 0; i < job.vertex_column_count; ++i)
    n += SUTURE_SINGLE_LANES * job.node_count * job.vertex_columns[i].components;
  for (uint32_t i = 0; i < job.cell_column_count; ++i)
    n += SUTURE_SINGLE_LANES * job.cell_columns[i].components;
  return n;
}

}  // namespace suture::loops

/// The only exported symbol of a module.
#define SUTURE_LOOPS_SYMBOL "suture_loops"
