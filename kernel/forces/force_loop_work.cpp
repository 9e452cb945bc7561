// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/force_loop_impl.hpp"

namespace suture {
namespace {

/// sum of d . f over the nodes of a cell in a lane.
double work_on(const double* force, const Index* nodes, Index count, Index lane, const double* d) {
  double sum = 0;
  for (Index n = 0; n < count; ++n)
    for (std::size_t c = 0; c < 3; ++c)
      sum += d[std::size_t{nodes[n]} * 3 + c] * force[(n * 3 + c) * lanes + lane];
  return sum;
}

}  // namespace

void ForceLoop::Impl::add_cell_work(Index number, const double* direction, double energy,
                                    const TangentTime& at, std::span<double> out) {
  const auto* stored = energy != 0 ? stored_energy(functors[number]) : nullptr;
  run(number, "force", functors[number].cells().live(), at.time, at.dt, nullptr,
      [&](const loops::Job& job, const loops::Worker& worker, std::span<const loops::Rows> ranges,
          Index) {
        for_each_batch(job, worker, ranges, [&](suture_batch& batch, const loops::BatchRows& rows) {
          batch.force = worker.results_end - job.node_count * 3 * lanes;
          suture_status status = job.function(worker.context, &batch);
          for (Index l = 0; l < batch.valid; ++l)
            out[rows.row[l]] +=
                work_on(batch.force, nodes_of(job, rows.row[l]), job.node_count, l, direction);
          if (status != SUTURE_OK || stored == nullptr) return status;
          double* const energies = worker.results_end - lanes;
          status = stored->energy(worker.context, &batch, energies);
          for (Index l = 0; l < batch.valid; ++l) out[rows.row[l]] += energy * energies[l];
          return status;
        });
      });
}

void ForceLoop::add_cell_work(const Instance& instance, int dimension, const double* direction,
                              double energy, const TangentTime& at, std::span<double> out) {
  for (Index i = 0; i < impl_->functors.size(); ++i) {
    const CompiledFunctor& functor = impl_->functors[i];
    if (&functor.instance() == &instance && !functor.skipped() && functor.dimension() == dimension)
      impl_->add_cell_work(i, direction, energy, at, out);
  }
  impl_->raise_failures(at.time);
}

}  // namespace suture
