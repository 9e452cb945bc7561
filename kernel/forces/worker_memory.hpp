// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/base/aligned.hpp"
#include "kernel/forces/failures.hpp"
#include "kernel/forces/loops/loops.hpp"
#include "kernel/plugin_host/guarded_array.hpp"
#include "kernel/plugin_host/plugin_call.hpp"

namespace suture {

/// The memory of one thread, padded so that threads do not share a cache line.
struct alignas(64) WorkerMemory {
  AlignedVector<double> scratch;
  std::vector<const double*> cell_columns, vertex_columns;
  std::vector<double*> trial_columns;
  AlignedVector<float> single_scratch;
  std::vector<const float*> single_cell_columns, single_vertex_columns;
  static constexpr const char* size_of_results =
      "a force has nodes x 3 rows of 8 lanes, an energy one, bounds nodes x 6 each; `suture run "
      "--check-plugins` looks for writes outside of all arrays";
  GuardedArray results{"its results", size_of_results, loops::max_results};
  GuardedArray more_results{"its second results", size_of_results, loops::max_results};
  Failure failure;
  Index functor = 0;
  const suture_error* error = nullptr;
  PluginCall call;  ///< what the thread is doing

  static void failed(void* data, suture_status status, const suture_batch* batch) {
    auto& self = *static_cast<WorkerMemory*>(data);
    if (!is_fault(status)) return self.failure.note(status, self.functor, *self.error, *batch);
    self.failure.note_fault(self.functor, self.call, text_of_fault(self.call, status, *self.error));
  }

  static void thrown(void* data) {
    auto& self = *static_cast<WorkerMemory*>(data);
    self.failure.note_fault(self.functor, self.call, text_of_fault(self.call));
  }

  /// Prepares calls of `function` of functor `number`, which `call` describes.
  loops::Worker prepare(const loops::Job& job, const suture_context& context, Index number,
                        const PluginCall& named) {
    functor = number;
    call = named;
    error = context.error;
    const std::uint64_t needed = loops::scratch_doubles(job);
    if (scratch.size() < needed) scratch.resize(needed);
    const std::uint64_t needed_single = loops::single_scratch_floats(job);
    if (single_scratch.size() < needed_single) single_scratch.resize(needed_single);
    if (cell_columns.size() < job.cell_column_count) {
      cell_columns.resize(job.cell_column_count);
      trial_columns.resize(job.cell_column_count);
      single_cell_columns.resize(job.cell_column_count);
    }
    if (vertex_columns.size() < job.vertex_column_count) {
      vertex_columns.resize(job.vertex_column_count);
      single_vertex_columns.resize(job.vertex_column_count);
    }
    return {&context,
            scratch.data(),
            cell_columns.data(),
            vertex_columns.data(),
            trial_columns.data(),
            single_scratch.data(),
            single_cell_columns.data(),
            single_vertex_columns.data(),
            &failed,
            &thrown,
            this,
            &call.batch,
            results.end(),
            more_results.end()};
  }
};

}  // namespace suture
