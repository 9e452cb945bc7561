// SPDX-License-Identifier: GPL-3.0-or-later
//
// Compiled three times (base, x86-64-v3, x86-64-v4); see loops.hpp. Built with
// -ffp-contract=off, so that an integrator rounds the same whether two half
// kicks are fused into one pass or not, and on every instruction set.

#include "kernel/forces/loops/loops.hpp"

#include "kernel/forces/loops/gather.hpp"
#include "kernel/forces/loops/integrators.hpp"
#include "kernel/forces/loops/inverted.hpp"
#include "kernel/forces/loops/motion_sums.hpp"
#include "kernel/forces/loops/stretch.hpp"
#include "kernel/forces/loops/tangents.hpp"

namespace {

using namespace suture::loops;

#if defined(__AVX512F__)
constexpr const char* isa_name = "avx512";
#elif defined(__AVX2__)
constexpr const char* isa_name = "avx2";
#else
constexpr const char* isa_name = "base";
#endif

template <uint32_t N, class R, class C>
inline __attribute__((always_inline)) void one_batch(const Job& job, const Worker& worker,
                                                     const R& rows, const C& cells,
                                                     Buffers& buffers, suture_batch& batch) {
  gather_batch<N>(job, worker, rows, cells, buffers, batch);
  const suture_status status = job.function(worker.context, &batch);
  if (status != 0) worker.failed(worker.data, status, &batch);
  for (uint32_t n = 0; n < N; ++n)
    scatter_node(job.force, cells, n, rows.valid, batch.force + n * 3 * lanes);
  if (job.has_trial) return_trials(job, worker, rows);
}

template <uint32_t N>
void forces_of(const Job& job, const Worker& worker, const Rows* ranges, uint32_t count) {
  Buffers buffers;
  suture_batch batch;
  begin_batches(job, worker, buffers, batch);
  batch.force = worker.results_end - N * 3 * lanes;
  *worker.present = &batch;
  const auto one = [&](const auto& rows, const auto& cells) __attribute__((always_inline)) {
    one_batch<N>(job, worker, rows, cells, buffers, batch);
  };
  try {
    for (uint32_t i = 0; i < count; ++i) for_each_batch<N>(job, ranges[i], one);
  } catch (...) {
    worker.thrown(worker.data);
  }
  *worker.present = nullptr;
}

void forces(const Job* job, const Worker* worker, const Rows* ranges, uint32_t count) {
  if (job->node_count == 1) return forces_of<1>(*job, *worker, ranges, count);
  if (job->node_count == 2) return forces_of<2>(*job, *worker, ranges, count);
  if (job->node_count == 4) return forces_of<4>(*job, *worker, ranges, count);
  forces_of<8>(*job, *worker, ranges, count);
}

template <uint32_t N>
void gather_one(const Job& job, const Worker& worker, const BatchRows& rows, Buffers& buffers,
                suture_batch& batch) {
  begin_batches(job, worker, buffers, batch);
  gather_batch<N>(job, worker, rows, find_cells<N>(job, rows), buffers, batch);
}

void gather(const Job* job, const Worker* worker, const BatchRows* rows, Buffers* buffers,
            suture_batch* batch) {
  if (job->node_count == 1) return gather_one<1>(*job, *worker, *rows, *buffers, *batch);
  if (job->node_count == 2) return gather_one<2>(*job, *worker, *rows, *buffers, *batch);
  if (job->node_count == 4) return gather_one<4>(*job, *worker, *rows, *buffers, *batch);
  gather_one<8>(*job, *worker, *rows, *buffers, *batch);
}

const Table table = {sizeof(Table),
                     0,
                     isa_name,
                     forces,
                     tangents_of_doubles,
                     tangents_of_floats,
                     single_tangents,
                     gather,
                     pass<1, true>,
                     pass<2, true>,
                     pass<1, false>,
                     kinetic,
                     forcing,
                     rest_sums,
                     inverted,
                     stretched<MayStrain>,
                     stretched<MayElongate>};

}  // namespace

#ifndef SUTURE_LOOPS_FUNCTION
#define SUTURE_LOOPS_FUNCTION suture_loops
#endif

extern "C" __attribute__((visibility("default"))) const suture::loops::Table* SUTURE_LOOPS_FUNCTION(
    void) {
  return &table;
}
