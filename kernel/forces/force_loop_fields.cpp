// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>

#include "kernel/forces/force_loop_impl.hpp"
#include "kernel/plugin_host/output_fields.hpp"

namespace suture {
namespace {

/// False if a field that a functor computed has a value that is not finite; `error` says where.
bool is_finite(std::span<const double> field, const suture_batch& batch, const char* name,
               suture_error& error) {
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (i % lanes >= batch.valid || std::isfinite(field[i])) continue;
    error.cell = batch.cell_ids[i % lanes];
    std::snprintf(error.text, sizeof error.text,
                  "field '%s' is not finite; see that no division, root or logarithm of the model "
                  "leaves its range, or remove the field from /output",
                  name);
    return false;
  }
  return true;
}

/// The blocks of 8 rows that have a wanted cell, each as batches take it: bits depend on which rows
/// are in one batch.
std::vector<loops::Rows> blocks_with(const std::vector<bool>& wanted, const CellSet& cells,
                                     std::span<const loops::Rows> ranges) {
  std::vector<loops::Rows> blocks;
  for (const loops::Rows& range : ranges)
    for (loops::Rows block{range.begin, range.begin}; block.begin < range.end;
         block.begin = block.end) {
      block.end = std::min(range.end, (block.begin / lanes + 1) * lanes);
      bool any = false;
      for (Index row = block.begin; row < block.end; ++row) any = any || wanted[cells.cell(row)];
      if (any) blocks.push_back(block);
    }
  return blocks;
}

std::vector<bool> marks_of(const std::vector<Index>& cells, Index count) {
  std::vector<bool> marks(count);
  for (const Index cell : cells) marks[cell] = true;
  return marks;
}

}  // namespace

/// `wanted`: by cell; null: all.
bool ForceLoop::Impl::add_field(Index number, std::string_view field, double time,
                                std::span<double> values, const std::vector<bool>* wanted) {
  const auto* extension = functors[number].extension<suture_output_1>(SUTURE_OUTPUT_1);
  if (!extension) return false;
  const std::vector<suture_field> fields = output_fields(functors[number].functor());
  const auto found = std::find_if(fields.begin(), fields.end(),
                                  [&](const suture_field& f) { return f.name == field; });
  if (found == fields.end()) return false;
  const auto width = std::size_t{found->components};
  const auto place = static_cast<std::size_t>(found - fields.begin());
  run(number, "output", time,
      [&](const loops::Job& job, const loops::Worker& worker, std::span<const loops::Rows> ranges,
          Index) {
        std::vector<loops::Rows> blocks;
        if (wanted) ranges = blocks = blocks_with(*wanted, functors[number].cells(), ranges);
        const std::span<double> out(worker.results_end - width * lanes, width * lanes);
        std::vector<double*> places(fields.size(), nullptr);
        places[place] = out.data();
        for_each_batch(job, worker, ranges, [&](suture_batch& batch, const loops::BatchRows& rows) {
          const suture_status status = extension->compute(worker.context, &batch, places.data());
          if (status == SUTURE_OK) check_results(out, batch.valid);
          if (status == SUTURE_OK && !is_finite(out, batch, found->name, *worker.context->error))
            return SUTURE_STOP;
          for (Index l = 0; l < batch.valid; ++l)
            for (std::size_t c = 0; c < width; ++c)
              values[rows.row[l] * width + c] = out[c * lanes + l];
          return status;
        });
      });
  return true;
}

bool ForceLoop::compute_field(const Instance& instance, int dimension, std::string_view field,
                              double time, std::span<double> values,
                              const std::vector<Index>* wanted) {
  std::vector<bool> marks;
  if (wanted) marks = marks_of(*wanted, impl_->complex->count(dimension));
  bool given = false;
  for (Index i = 0; i < impl_->functors.size(); ++i) {
    const CompiledFunctor& functor = impl_->functors[i];
    const bool asked = &functor.instance() == &instance && !functor.skipped() &&
                       static_cast<int>(functor.functor().dimension) == dimension;
    if (asked) given |= impl_->add_field(i, field, time, values, wanted ? &marks : nullptr);
  }
  impl_->raise_failures(time);
  return given;
}

void ForceLoop::mark_for_fields(int dimension, const std::vector<Index>& wanted,
                                std::vector<bool>& vertices) {
  const std::vector<bool> marks = marks_of(wanted, impl_->complex->count(dimension));
  for (const CompiledFunctor& functor : impl_->functors) {
    if (functor.skipped() || functor.dimension() != dimension ||
        !functor.extension<suture_output_1>(SUTURE_OUTPUT_1))
      continue;
    const Connectivity cells = functor.connectivity(*impl_->complex);
    for (Index chunk = 0; chunk < functor.list().chunk_count(); ++chunk)
      for (const loops::Rows& block :
           blocks_with(marks, functor.cells(), functor.list().ranges(chunk)))
        for (Index row = block.begin; row < block.end; ++row)
          for (const Index vertex : cells.of(row)) vertices[vertex] = true;
  }
}

}  // namespace suture
