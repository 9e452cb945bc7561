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

/// Where a component of a row is in the data of a column.
std::size_t place_in(const loops::CellColumn& column, Index row, Index component) {
  if (column.stride != 0) return std::size_t{row} * column.stride + component;
  return row / lanes * column.block + component * lanes + row % lanes;
}

/// New states of lanes that were moved to the front go to their rows; others are there already.
void return_states(const loops::Job& job, const loops::Worker& worker,
                   const loops::BatchRows& rows) {
  for (std::uint32_t i = 0; i < job.cell_column_count; ++i) {
    const loops::CellColumn& column = job.cell_columns[i];
    if (column.trial == nullptr) continue;
    for (std::uint32_t c = 0; c < column.components; ++c)
      for (std::uint32_t l = 0; l < rows.valid; ++l)
        column.trial[place_in(column, rows.row[l], c)] = worker.trial_columns[i][c * lanes + l];
  }
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
          return_states(job, worker, rows);
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

// ------------------------------------------------------------------- energy --

double ForceLoop::Impl::sum_of(Index number, const CellNumbers& numbers, double time,
                               Failure& first) {
  if (numbers.function == nullptr) return 0;
  if (share && !others) find_share();
  const PartialRows::Enough enough(attributes.partial_rows(), PartialRows::Extent::at_cells);
  std::vector<double> of_chunk(functors[number].list().chunk_count());
  run(number, numbers.name, time,
      [&](const loops::Job& job, const loops::Worker& worker, std::span<const loops::Rows> ranges,
          Index chunk) {
        if (share && processes_of_sums[number][chunk] != share->number()) return;
        for_each_batch(job, worker, ranges, [&](suture_batch& batch, const loops::BatchRows&) {
          double* const out = worker.results_end - lanes;
          const suture_status status = numbers.function(worker.context, &batch, out);
          if (status == SUTURE_OK) check_results({out, lanes}, batch.valid);
          for (Index l = 0; l < batch.valid; ++l) of_chunk[chunk] += out[l];
          return status;
        });
      });
  first.merge(take_failure());
  if (share) share->join_sums(of_chunk, processes_of_sums[number], first);
  double sum = 0;
  for (const double part : of_chunk) sum += part;
  return sum;
}

double ForceLoop::Impl::sum_of(CellNumbers (*numbers)(const CompiledFunctor&), double time) {
  double sum = 0;
  Failure first;
  for (Index i = 0; i < functors.size(); ++i)
    if (!functors[i].skipped()) sum += sum_of(i, numbers(functors[i]), time, first);
  raise(first, time);
  return sum;
}

double ForceLoop::energy(double time) { return impl_->sum_of(energy_function, time); }

double ForceLoop::dissipation(double time) { return impl_->sum_of(dissipation_function, time); }

bool ForceLoop::has_dissipation() const {
  return std::ranges::any_of(impl_->functors, [](const CompiledFunctor& functor) {
    return !functor.skipped() && dissipation_function(functor).function != nullptr;
  });
}

}  // namespace suture
