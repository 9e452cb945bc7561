// SPDX-License-Identifier: GPL-3.0-or-later
//
// Compiled like loops.cpp, once for each instruction set.

#include "kernel/forces/loops/tangents.hpp"

#include "kernel/forces/loops/single.hpp"

namespace {

using namespace suture::loops;

/// Directions of a batch.
struct alignas(64) Vectors {
  double dx[8 * 3 * lanes], dv[8 * 3 * lanes];
};

/// Those of velocities stay zero for a functor that reads none.
template <uint32_t N, class Real, class C>
inline __attribute__((always_inline)) void gather_directions(const Product<Real>& product,
                                                             bool with_velocity, const C& cells,
                                                             Vectors& vectors) {
  for (uint32_t n = 0; n < N; ++n) {
    double* const dx = vectors.dx + n * 3 * lanes;
    double* const dv = vectors.dv + n * 3 * lanes;
    gather_direction(product.direction, cells, n, dx);
    if (with_velocity)
      for (uint32_t i = 0; i < 3 * lanes; ++i) dv[i] = product.dv * dx[i];
    for (uint32_t i = 0; i < 3 * lanes; ++i) dx[i] *= product.dx;
  }
}

template <uint32_t N, class Real>
void tangents_of(const Job& job, const Worker& worker, const Rows* ranges, uint32_t count,
                 const Product<Real>& product) {
  Buffers buffers;
  Vectors vectors = {};
  double* const df = worker.results_end - N * 3 * lanes;
  suture_batch batch;
  begin_batches(job, worker, buffers, batch);
  *worker.present = &batch;
  const auto one = [&](const auto& rows, const auto& cells) __attribute__((always_inline)) {
    gather_batch<N>(job, worker, rows, cells, buffers, batch);
    gather_directions<N>(product, job.velocity != nullptr, cells, vectors);
    const suture_status status =
        product.function(worker.context, &batch, vectors.dx, vectors.dv, df);
    if (status != 0) return worker.failed(worker.data, status, &batch);
    for (uint32_t n = 0; n < N; ++n)
      scatter_direction(product.out, cells, n, rows.valid, df + n * 3 * lanes);
  };
  try {
    for (uint32_t i = 0; i < count; ++i) for_each_batch<N>(job, ranges[i], one);
  } catch (...) {
    worker.thrown(worker.data);
  }
  *worker.present = nullptr;
}

template <class Real>
void tangents(const Job& job, const Worker& worker, const Rows* ranges, uint32_t count,
              const Product<Real>& product) {
  if (job.node_count == 1) return tangents_of<1>(job, worker, ranges, count, product);
  if (job.node_count == 2) return tangents_of<2>(job, worker, ranges, count, product);
  if (job.node_count == 4) return tangents_of<4>(job, worker, ranges, count, product);
  tangents_of<8>(job, worker, ranges, count, product);
}

template <uint32_t N>
void single_tangents_of(const Job& job, const Worker& worker, const Rows* ranges, uint32_t count,
                        const SingleProduct& product) {
  SingleLoop<N> loop(job, worker, product);
  try {
    const auto add = [&](const auto& rows, const auto& cells) __attribute__((always_inline)) {
      loop.add(rows, cells);
    };
    for (uint32_t i = 0; i < count; ++i) {
      const bool is_skewed = ranges[i].begin >= job.skewed_begin;
      if (i > 0 && is_skewed && ranges[i - 1].begin < job.skewed_begin) loop.finish();
      for_each_batch<N>(job, ranges[i], add);
    }
    loop.finish();
  } catch (...) {
    worker.thrown(worker.data);
  }
  *worker.present = nullptr;
}

}  // namespace

void suture::loops::tangents_of_doubles(const Job* job, const Worker* worker, const Rows* ranges,
                                        uint32_t count, const Product<double>* product) {
  tangents(*job, *worker, ranges, count, *product);
}

void suture::loops::tangents_of_floats(const Job* job, const Worker* worker, const Rows* ranges,
                                       uint32_t count, const Product<float>* product) {
  tangents(*job, *worker, ranges, count, *product);
}

void suture::loops::single_tangents(const Job* job, const Worker* worker, const Rows* ranges,
                                    uint32_t count, const SingleProduct* product) {
  if (job->node_count == 1) return single_tangents_of<1>(*job, *worker, ranges, count, *product);
  if (job->node_count == 2) return single_tangents_of<2>(*job, *worker, ranges, count, *product);
  if (job->node_count == 4) return single_tangents_of<4>(*job, *worker, ranges, count, *product);
  single_tangents_of<8>(*job, *worker, ranges, count, *product);
}
