// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Batches of floats (suture/single.h) of two halves of 8 cells. Included by tangents.cpp only;
// internal linkage throughout: see loops.hpp.

#include "kernel/forces/loops/directions.hpp"
#include "kernel/forces/loops/gather.hpp"

namespace {

enum : uint32_t { single_lanes = SUTURE_SINGLE_LANES };
static_assert(single_lanes == 2 * lanes);

/// Arrays of a batch of N nodes per cell.
template <uint32_t N>
struct alignas(64) SingleArrays {
  float rest[N * 3 * single_lanes], position[N * 3 * single_lanes], velocity[N * 3 * single_lanes];
  float dx[N * 3 * single_lanes], dv[N * 3 * single_lanes], df[N * 3 * single_lanes];
  uint32_t ids[single_lanes];
};

typedef double EightDoubles __attribute__((vector_size(64), may_alias));
typedef float EightFloats __attribute__((vector_size(32), may_alias));

/// 3 N rows of 8 doubles -> every second eight of `out`, less those of the first node if
/// `relative`. Vectors by name: the compiler would take the loop apart.
template <uint32_t N, bool relative>
inline __attribute__((always_inline)) void round_rows(const double* rows, float* out) {
  const auto* const in = reinterpret_cast<const EightDoubles*>(rows);
  for (uint32_t i = 0; i < N * 3; ++i)
    *reinterpret_cast<EightFloats*>(out + i * single_lanes) =
        __builtin_convertvector(relative ? in[i] - in[i % 3] : in[i], EightFloats);
}

/// One half of the columns of the cells, rounded, from `out` on; returns the first float behind
/// both halves. Those that are equal in all cells are read once.
template <class R>
float* round_cell_columns(const Job& job, const R& rows, bool first, float* out) {
  for (uint32_t i = 0; i < job.cell_column_count; ++i) {
    const CellColumn& column = job.cell_columns[i];
    const bool is_constant = column.block == 0 && column.stride == 0;
    for (uint32_t c = 0; c < column.components && (first || !is_constant); ++c)
      for (uint32_t l = 0; l < lanes; ++l)
        out[c * single_lanes + l] =
            static_cast<float>(column.data[place_in(column, row_in(rows, l), c)]);
    out += column.components * single_lanes;
  }
  return out;
}

template <uint32_t N, class C>
void round_vertex_columns(const Job& job, const Worker& worker, const C& cells, float* out) {
  gather_vertex_columns<N>(job, worker, cells);
  for (uint32_t i = 0; i < job.vertex_column_count; ++i) {
    const uint32_t rows = N * job.vertex_columns[i].components;
    for (uint32_t r = 0; r < rows; ++r, out += single_lanes)
      for (uint32_t l = 0; l < lanes; ++l)
        out[l] = static_cast<float>(worker.vertex_columns[i][r * lanes + l]);
  }
}

/// Points the lists of a batch to the columns in Worker::single_scratch.
template <uint32_t N>
void point_to_single_columns(const Job& job, const Worker& worker) {
  float* at = worker.single_scratch;
  for (uint32_t i = 0; i < job.cell_column_count; ++i) {
    worker.single_cell_columns[i] = at;
    at += job.cell_columns[i].components * single_lanes;
  }
  for (uint32_t i = 0; i < job.vertex_column_count; ++i) {
    worker.single_vertex_columns[i] = at;
    at += N * job.vertex_columns[i].components * single_lanes;
  }
}

/// Products of the cells of some ranges, two blocks at a time.
template <uint32_t N>
class SingleLoop {
 public:
  SingleLoop(const Job& job, const Worker& worker, const SingleProduct& product)
      : job_(job), worker_(worker), product_(product) {
    batch_.size = sizeof batch_;
    batch_.lanes = single_lanes;
    batch_.nodes = N;
    batch_.time = job.time;
    batch_.dt = job.dt;
    batch_.rest = arrays_.rest;
    batch_.position = arrays_.position;
    batch_.velocity = arrays_.velocity;
    batch_.cell_columns = job.cell_column_count != 0 ? worker.single_cell_columns : nullptr;
    batch_.vertex_columns = job.vertex_column_count != 0 ? worker.single_vertex_columns : nullptr;
    batch_.cell_ids = arrays_.ids;
    point_to_single_columns<N>(job, worker);
    begin_batches(job, worker, buffers_, names_);
    names_.cell_ids = arrays_.ids;
    *worker.present = &names_;
  }

  template <class R, class C>
  inline __attribute__((always_inline)) void add(const R& rows, const C& cells) {
    gather_half(rows, cells, filled_);
    for (uint32_t l = 0; l < lanes; ++l) cells_[filled_].nodes[l] = nodes_of(cells, l);
    valid_[filled_] = rows.valid;
    if (++filled_ == 2) apply();
  }
  /// Applies a half that is left over, twice in its batch.
  void finish() {
    if (filled_ == 0) return;
    repeat_half();
    valid_[1] = 0;
    apply();
  }

 private:
  static const uint32_t* nodes_of(const Block<N>& cells, uint32_t l) { return cells.nodes + l * N; }
  static const uint32_t* nodes_of(const Cells<N>& cells, uint32_t l) { return cells.nodes[l]; }

  /// Inlined where it is called, the loop would not fit the instruction cache.
  template <class R, class C>
  __attribute__((noinline)) void gather_half(const R& rows, const C& cells, uint32_t half) {
    const uint32_t at = half * lanes;
    if (job_.position) {
      gather_rows<N>(job_.position, cells, buffers_.position);
      round_rows<N, true>(buffers_.position, arrays_.position + at);
    }
    if (job_.rest) {
      gather_rows<N>(job_.rest, cells, buffers_.rest);
      if (job_.rest_slots) take_own_rest(job_, rows, buffers_.rest);
      round_rows<N, true>(buffers_.rest, arrays_.rest + at);
    }
    if (job_.velocity) {
      gather_rows<N>(job_.velocity, cells, buffers_.velocity);
      round_rows<N, false>(buffers_.velocity, arrays_.velocity + at);
    }
    gather_directions(cells, at);
    gather_columns(rows, cells, at);
    fill_ids(job_, rows, arrays_.ids + at);
  }

  template <class C>
  inline __attribute__((always_inline)) void gather_directions(const C& cells, uint32_t at) {
    const auto dx = static_cast<float>(product_.dx), dv = static_cast<float>(product_.dv);
    for (uint32_t n = 0; n < N; ++n) {
      const uint32_t node = n * 3 * single_lanes + at;
      gather_single_direction(product_.direction, cells, n, dx, arrays_.dx + node);
      if (job_.velocity)
        gather_single_direction(product_.direction, cells, n, dv, arrays_.dv + node);
    }
  }

  template <class R, class C>
  void gather_columns(const R& rows, const C& cells, uint32_t at) {
    float* const behind =
        round_cell_columns(job_, rows, batches_ == 0, worker_.single_scratch + at);
    if (job_.vertex_column_count != 0) round_vertex_columns<N>(job_, worker_, cells, behind);
  }

  /// Copies the first half of every array over the second.
  void repeat_half() {
    const auto repeat = [](float* values, uint64_t rows) {
      for (uint64_t r = 0; r < rows; ++r)
        for (uint32_t l = 0; l < lanes; ++l)
          values[r * single_lanes + lanes + l] = values[r * single_lanes + l];
    };
    float* const inputs[] = {arrays_.rest, arrays_.position, arrays_.velocity, arrays_.dx,
                             arrays_.dv};
    for (float* values : inputs) repeat(values, N * 3);
    repeat(worker_.single_scratch, single_scratch_floats(job_) / single_lanes);
    for (uint32_t l = 0; l < lanes; ++l) arrays_.ids[lanes + l] = arrays_.ids[l];
  }

  __attribute__((noinline)) void apply() {
    filled_ = 0;
    ++batches_;
    names_.valid = single_lanes;
    suture::reset(*worker_.context->error);
    const suture_status status =
        product_.function(worker_.context, &batch_, arrays_.dx, arrays_.dv, arrays_.df);
    if (status != 0) return worker_.failed(worker_.data, status, &names_);
    for (uint32_t half = 0; half < 2; ++half)
      for (uint32_t n = 0; n < N; ++n)
        scatter_single_direction(product_.out, cells_[half], n, valid_[half],
                                 arrays_.df + n * 3 * single_lanes + half * lanes);
  }

  const Job& job_;
  const Worker& worker_;
  const SingleProduct& product_;
  suture_single_batch batch_ = {};
  suture_batch names_;  ///< the cells, for messages
  Buffers buffers_;
  SingleArrays<N> arrays_ = {};
  Cells<N> cells_[2];
  uint32_t valid_[2] = {};
  uint32_t filled_ = 0;  ///< halves
  uint64_t batches_ = 0;
};

}  // namespace
