// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/force_loop_impl.hpp"

namespace suture {

void ForceLoop::add_forces_at(const VertexSelection& selection, std::span<const Index> vertices,
                              double time, std::vector<Vec3>& forces) {
  const std::vector<Index> elements = impl_->local.elements_around(*impl_->complex, vertices);
  for (Index i = 0; i < impl_->functors.size(); ++i) {
    const CompiledFunctor& functor = impl_->functors[i];
    if (functor.skipped()) continue;
    impl_->for_each_local(i, "force", time,
                          impl_->local.rows_at(*impl_->complex, functor, elements, selection),
                          [&](const loops::Job& job, const loops::Worker& worker,
                              suture_batch& batch, const loops::BatchRows& rows) {
                            batch.force = worker.results_end - job.node_count * 3 * lanes;
                            const suture_status status = job.function(worker.context, &batch);
                            for (Index l = 0; l < batch.valid; ++l) {
                              const Index* nodes = nodes_of(job, rows.row[l]);
                              for (Index n = 0; n < job.node_count; ++n) {
                                if (!selection.contains(nodes[n])) continue;
                                Vec3& sum = forces[selection.slot(nodes[n])];
                                for (std::size_t c = 0; c < 3; ++c)
                                  sum[c] += batch.force[(n * 3 + c) * lanes + l];
                              }
                            }
                            return status;
                          });
  }
  impl_->raise_failures(time);
}

double ForceLoop::energy_around(std::span<const Index> elements, double time) {
  double sum = 0;
  for (Index i = 0; i < impl_->functors.size(); ++i) {
    const CompiledFunctor& functor = impl_->functors[i];
    const auto* extension = stored_energy(functor);
    if (functor.skipped() || !extension) continue;
    impl_->for_each_local(
        i, "energy", time, impl_->local.rows_of(*impl_->complex, functor, elements),
        [&](const loops::Job&, const loops::Worker& worker, suture_batch& batch,
            const loops::BatchRows&) {
          double* const out = worker.results_end - lanes;
          const suture_status status = extension->energy(worker.context, &batch, out);
          if (status == SUTURE_OK) impl_->check_results({out, lanes}, batch.valid);
          for (Index l = 0; l < batch.valid; ++l) sum += out[l];
          return status;
        });
  }
  impl_->raise_failures(time);
  return sum;
}

std::vector<Index> ForceLoop::elements_around(std::span<const Index> vertices) {
  return impl_->local.elements_around(*impl_->complex, vertices);
}

// ------------------------------------------------------------------- bounds --

namespace {

const suture_stable_dt_1& bounds_of(const CompiledFunctor& functor) {
  const auto* extension = functor.extension<suture_stable_dt_1>(SUTURE_STABLE_DT_1);
  if (extension) return *extension;
  throw NoStepBound(functor.title() +
                    " provides no bound for the stable step (suture.stable-dt/1); give \"dt\" in "
                    "seconds, or add the extension to the model");
}

/// sums(vertex) += the bounds of every node of a batch that `wanted` has.
template <class Loop, class Wanted>
suture_status add_bounds_of(const Loop& loop, const suture_stable_dt_1& extension,
                            const loops::Job& job, const loops::Worker& worker, suture_batch& batch,
                            const loops::BatchRows& rows, const BoundedTerm::AddBounds& sums,
                            Wanted wanted) {
  const std::size_t size = std::size_t{job.node_count} * 6 * lanes;
  double* const stiffness = std::fill_n(worker.results_end - size, size, 0.0) - size;
  double* const damping = std::fill_n(worker.more_results_end - size, size, 0.0) - size;
  const suture_status status = extension.bounds(worker.context, &batch, stiffness, damping);
  for (const double* const bounds : {stiffness, damping})
    if (status == SUTURE_OK) loop.check_results({bounds, size}, batch.valid);
  for (Index l = 0; l < batch.valid; ++l) {
    const Index* nodes = nodes_of(job, rows.row[l]);
    for (Index n = 0; n < job.node_count; ++n) {
      if (!wanted(nodes[n])) continue;
      double k[6], c[6];
      for (std::size_t i = 0; i < 6; ++i) {
        k[i] = stiffness[(n * 6 + i) * lanes + l];
        c[i] = damping[(n * 6 + i) * lanes + l];
      }
      sums(nodes[n], k, c);
    }
  }
  return status;
}

}  // namespace

void ForceLoop::add_bounds(double time, const AddBounds& sums) {
  for (Index i = 0; i < impl_->functors.size(); ++i) {
    if (impl_->functors[i].skipped()) continue;
    const suture_stable_dt_1& extension = bounds_of(impl_->functors[i]);
    impl_->run(i, "bounds", time,
               [&](const loops::Job& job, const loops::Worker& worker,
                   std::span<const loops::Rows> ranges, Index) {
                 impl_->for_each_batch(
                     job, worker, ranges, [&](suture_batch& batch, const loops::BatchRows& rows) {
                       return add_bounds_of(*impl_, extension, job, worker, batch, rows, sums,
                                            [](Index) { return true; });
                     });
               });
  }
  impl_->raise_failures(time);
}

void ForceLoop::add_bounds_at(const VertexSelection& selection, std::span<const Index> vertices,
                              double time, const AddBounds& sums) {
  const std::vector<Index> elements = impl_->local.elements_around(*impl_->complex, vertices);
  for (Index i = 0; i < impl_->functors.size(); ++i) {
    const CompiledFunctor& functor = impl_->functors[i];
    if (functor.skipped()) continue;
    const suture_stable_dt_1& extension = bounds_of(functor);
    impl_->for_each_local(i, "bounds", time,
                          impl_->local.rows_at(*impl_->complex, functor, elements, selection),
                          [&](const auto& job, const auto& worker, auto& batch, const auto& rows) {
                            return add_bounds_of(*impl_, extension, job, worker, batch, rows, sums,
                                                 [&](Index v) { return selection.contains(v); });
                          });
  }
  impl_->raise_failures(time);
}

}  // namespace suture
