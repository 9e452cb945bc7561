// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Fills batches: the positions, columns and ids of up to eight cells. Included by loops.cpp only;
// internal linkage throughout.

#include "kernel/base/reset_error.hpp"
#include "kernel/forces/loops/lanes.hpp"
#include "kernel/forces/loops/loops.hpp"

namespace {

using namespace suture::loops;

inline uint32_t cell_of(const Job& job, uint32_t row) { return job.cells ? job.cells[row] : row; }

/// The rows of a whole block: most batches of most bodies. Numbers, not an array.
struct BlockRows {
  uint32_t first;
  static constexpr uint32_t valid = lanes;
};
inline uint32_t row_in(const BlockRows& rows, uint32_t l) { return rows.first + l; }
inline uint32_t row_in(const BatchRows& rows, uint32_t l) { return rows.row[l]; }

/// Rows row .. row+valid-1, which all live; lanes behind the last repeat it.
inline BatchRows rows_of_block(uint32_t row, uint32_t valid) {
  BatchRows rows;
  rows.valid = valid;
  for (uint32_t l = 0; l < lanes; ++l) rows.row[l] = row + (l < valid ? l : valid - 1);
  return rows;
}

template <uint32_t N>
inline __attribute__((always_inline)) Cells<N> find_cells(const Job& job, const BatchRows& rows) {
  Cells<N> cells;
  for (uint32_t l = 0; l < lanes; ++l)
    cells.nodes[l] = job.nodes + static_cast<uint64_t>(cell_of(job, rows.row[l])) * N;
  return cells;
}

template <class R>
inline void fill_ids(const Job& job, const R& rows, uint32_t* ids) {
  for (uint32_t l = 0; l < lanes; ++l) {
    const uint32_t r = row_in(rows, l), cell = cell_of(job, r);
    ids[l] = job.row_ids ? job.row_ids[r] : job.ids ? job.ids[cell] : cell;
  }
}

template <uint32_t N, class C>
inline __attribute__((always_inline)) void gather_rows(const double* rows, const C& cells,
                                                       double* out) {
  for (uint32_t n = 0; n < N; ++n) gather_node(rows, cells, n, out + n * 3 * lanes);
}

/// A column of one number per vertex, such as most fields.
template <uint32_t N, class C>
inline __attribute__((always_inline)) void gather_numbers(const double* numbers, const C& cells,
                                                          double* out) {
  for (uint32_t n = 0; n < N; ++n)
    for (uint32_t l = 0; l < lanes; ++l) out[n * lanes + l] = numbers[cells.vertex(l, n)];
}

/// Vertex columns into scratch; returns the first free double behind them.
template <uint32_t N, class C>
double* gather_vertex_columns(const Job& job, const Worker& worker, const C& cells) {
  double* out = worker.scratch;
  for (uint32_t i = 0; i < job.vertex_column_count; ++i) {
    const VertexColumn& column = job.vertex_columns[i];
    worker.vertex_columns[i] = out;
    if (column.stride == 1 && !column.rows) {
      gather_numbers<N>(column.data, cells, out);
      out += N * lanes;
      continue;
    }
    for (uint32_t n = 0; n < N; ++n, out += column.components * lanes)
      for (uint32_t l = 0; l < lanes; ++l) {
        const uint32_t vertex = cells.vertex(l, n);
        const uint64_t row = column.rows ? column.rows[vertex] : vertex;
        for (uint32_t c = 0; c < column.components; ++c)
          out[c * lanes + l] = column.data[row * column.stride + c];
      }
  }
  return out;
}

/// Columns of the cells are read in place if the batch is a whole block: elsewhere the lanes that
/// are left over would read rows of another shape. Those of vertices lie in rows.
inline bool in_place(const Job& job, const BatchRows& rows) {
  return job.node_count != 1 && rows.valid == lanes && rows.row[0] % lanes == 0 &&
         rows.row[lanes - 1] - rows.row[0] == lanes - 1;
}

/// Where a component of a row is.
inline uint64_t place_in(const CellColumn& column, uint32_t row, uint32_t component) {
  if (column.stride != 0) return static_cast<uint64_t>(row) * column.stride + component;
  return row / lanes * column.block + component * lanes + row % lanes;
}

/// Otherwise the lanes are moved to the front, through scratch.
void move_cell_columns(const Job& job, const Worker& worker, const BatchRows& rows, double* spare) {
  for (uint32_t v = 0; v < job.varying_column_count; ++v) {
    const uint32_t i = job.varying_columns[v];
    const CellColumn& column = job.cell_columns[i];
    const uint32_t doubles = column.components * lanes;
    for (uint32_t k = 0; k < doubles; ++k)
      spare[k] = column.data[place_in(column, rows.row[k % lanes], k / lanes)];
    worker.cell_columns[i] = spare;
    worker.trial_columns[i] = column.trial ? spare + doubles : nullptr;
    spare += 2 * doubles;
  }
}

void point_to_cell_columns(const Job& job, const Worker& worker, const BlockRows& rows, double*) {
  const uint64_t block = rows.first / lanes;
  for (uint32_t v = 0; v < job.varying_column_count; ++v) {
    const uint32_t i = job.varying_columns[v];
    const CellColumn& column = job.cell_columns[i];
    worker.cell_columns[i] = column.data + block * column.block;
    worker.trial_columns[i] = column.trial ? column.trial + block * column.block : nullptr;
  }
}

void point_to_cell_columns(const Job& job, const Worker& worker, const BatchRows& rows,
                           double* spare) {
  if (!in_place(job, rows)) return move_cell_columns(job, worker, rows, spare);
  point_to_cell_columns(job, worker, BlockRows{rows.row[0]}, spare);
}

inline void return_trials(const Job&, const Worker&, const BlockRows&) {}

/// Trial values of lanes that were moved go home.
inline void return_trials(const Job& job, const Worker& worker, const BatchRows& rows) {
  if (in_place(job, rows)) return;
  for (uint32_t i = 0; i < job.cell_column_count; ++i) {
    const CellColumn& column = job.cell_columns[i];
    if (!column.trial) continue;
    for (uint32_t c = 0; c < column.components; ++c)
      for (uint32_t l = 0; l < rows.valid; ++l)
        column.trial[place_in(column, rows.row[l], c)] = worker.trial_columns[i][c * lanes + l];
  }
}

/// Rest positions of cells that have their own instead of their vertices'.
template <class R>
void take_own_rest(const Job& job, const R& rows, double* rest) {
  const uint32_t nodes = job.node_count;
  for (uint32_t l = 0; l < lanes; ++l) {
    const uint32_t slot = job.rest_slots[cell_of(job, row_in(rows, l))];
    if (slot == UINT32_MAX) continue;
    const double* own = job.own_rest + static_cast<uint64_t>(slot) * nodes * 4;
    for (uint32_t n = 0; n < nodes; ++n)
      for (uint32_t c = 0; c < 3; ++c) rest[(n * 3 + c) * lanes + l] = own[n * 4 + c];
  }
}

template <uint32_t N, class R, class C>
inline __attribute__((always_inline)) void gather_batch(const Job& job, const Worker& worker,
                                                        const R& rows, const C& cells,
                                                        Buffers& buffers, suture_batch& batch) {
  batch.valid = rows.valid;
  if (job.position) gather_rows<N>(job.position, cells, buffers.position);
  if (job.rest) gather_rows<N>(job.rest, cells, buffers.rest);
  if (job.velocity) gather_rows<N>(job.velocity, cells, buffers.velocity);
  double* spare = worker.scratch;
  if (job.vertex_column_count != 0) spare = gather_vertex_columns<N>(job, worker, cells);
  if (job.varying_column_count != 0) point_to_cell_columns(job, worker, rows, spare);
  fill_ids(job, rows, buffers.ids);
  if (job.rest_slots && job.rest) take_own_rest(job, rows, buffers.rest);
  suture::reset(*worker.context->error);
}

/// What stands where nothing is gathered.
alignas(64) constexpr double zeros[8 * 3 * lanes] = {};

/// Once for all batches: the other columns are pointed to in each of them.
void point_to_equal_columns(const Job& job, const Worker& worker) {
  for (uint32_t i = 0; i < job.cell_column_count; ++i) {
    worker.cell_columns[i] = job.cell_columns[i].data;
    worker.trial_columns[i] = nullptr;
  }
}

void begin_batches(const Job& job, const Worker& worker, Buffers& buffers, suture_batch& batch) {
  point_to_equal_columns(job, worker);
  batch.size = sizeof batch;
  batch.lanes = lanes;
  batch.valid = 0;
  batch.nodes = job.node_count;
  batch.time = job.time;
  batch.dt = job.dt;
  batch.rest = job.rest ? buffers.rest : zeros;
  batch.position = job.position ? buffers.position : zeros;
  batch.velocity = job.velocity ? buffers.velocity : zeros;
  batch.cell_columns = job.cell_column_count != 0 ? worker.cell_columns : nullptr;
  batch.vertex_columns = job.vertex_column_count != 0 ? worker.vertex_columns : nullptr;
  batch.cell_ids = buffers.ids;
  batch.force = nullptr;
  batch.trial_columns = job.has_trial ? worker.trial_columns : nullptr;
}

/// Calls work(rows, cells) for every batch of a range, one after the other. The commonest batch is
/// a block of 8 elements that all live.
template <uint32_t N, class Work>
inline __attribute__((always_inline)) void for_each_batch(const Job& job, const Rows& range,
                                                          const Work& work) {
  const uint32_t end = range.end;
  for (uint32_t row = range.begin; row < end;) {
    const uint32_t to_block = lanes - row % lanes;
    const uint32_t here = end - row < to_block ? end - row : to_block;
    const bool whole = !job.live || job.live[row / lanes] == 0xFF;
    if (N > 1 && here == lanes && !job.cells && whole) {
      work(BlockRows{row}, Block<N>{job.nodes + static_cast<uint64_t>(row) * N});
    } else {
      const BatchRows rows = whole ? rows_of_block(row, here) : live_rows(job.live, row, here);
      if (rows.valid != 0) work(rows, find_cells<N>(job, rows));
    }
    row += here;
  }
}

}  // namespace
