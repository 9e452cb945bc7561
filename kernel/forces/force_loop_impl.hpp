// SPDX-License-Identifier: GPL-3.0-or-later
//
// The implementation of ForceLoop: for its own sources only. force_loop.cpp runs over all cells,
// force_loop_local.cpp over those around some vertices.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>

#include "kernel/attributes/lips.hpp"
#include "kernel/base/lanes.hpp"
#include "kernel/forces/body_share.hpp"
#include "kernel/forces/compiled_functor.hpp"
#include "kernel/forces/force_loop.hpp"
#include "kernel/forces/local_rows.hpp"
#include "kernel/forces/loops/dispatch.hpp"
#include "kernel/forces/worker_memory.hpp"

namespace suture {

/// Number of gathered nodes below which one thread is faster than waking others: about
/// 0.07 ms of work compared with a few microseconds per round.
inline constexpr std::size_t parallel_nodes = 20000;

/// The energy that the functor stores, or null: what an active model (SUTURE_ACTIVE) declares, and
/// one that reads a field, changes with time, so the work of its forces is booked instead.
inline const suture_energy_1* stored_energy(const CompiledFunctor& functor) {
  if ((functor.instance().model().flags & SUTURE_ACTIVE) != 0) return nullptr;
  if (functor.reads_field() && functor.functor().field == 0) return nullptr;
  return functor.extension<suture_energy_1>(SUTURE_ENERGY_1);
}

/// A function of a functor that gives a number per cell, and its name for messages.
struct CellNumbers {
  suture_status (*function)(const suture_context*, const suture_batch*, double*) = nullptr;
  const char* name = "";
};
inline CellNumbers energy_function(const CompiledFunctor& functor) {
  const suture_energy_1* const table = stored_energy(functor);
  return {table ? table->energy : nullptr, "energy"};
}
inline CellNumbers dissipation_function(const CompiledFunctor& functor) {
  const auto* const table = functor.extension<suture_dissipation_1>(SUTURE_DISSIPATION_1);
  return {table ? table->power : nullptr, "dissipation"};
}

/// The vertices of the cell in a row.
inline const Index* nodes_of(const loops::Job& job, Index row) {
  return job.nodes + std::size_t{job.cells ? job.cells[row] : row} * job.node_count;
}

/// Throws PluginError unless the results of the current call are finite in the lanes of `cells`.
void require_finite(std::span<const double> results, std::span<const std::uint32_t> cells);

struct ForceLoop::Impl {
  Impl(Attributes& a, const CellComplex& c, unsigned wanted, const VertexField* field)
      : attributes(a), complex(&c), loops(hot_loops()), threads(wanted) {
    workers.resize(threads.threads());
    for (auto& instance : attributes.instances()) {
      instance->set_workers(threads.threads());
      add(*instance, field);
    }
  }

  void add(Instance& instance, const VertexField* field) {
    std::array<RowNodes*, 4> nodes{};
    const suture_model& model = instance.model();
    for (std::size_t i = 0; i < model.functor_count; ++i) {
      const suture_functor& functor = model.functors[i];
      if (attributes.field_of(model, functor) != field) continue;
      const auto dimension = functor.dimension;
      const bool has_rows = dimension < 3 && instance.functor(i).runs;
      RowNodes*& of_cells = nodes[acts_on_lips(functor) ? 3 : dimension];
      if (has_rows && !of_cells) {
        row_nodes.emplace_back(instance, functor, attributes.rest_places(*complex));
        of_cells = &row_nodes.back();
      }
      functors.emplace_back(instance, functor, dimension < 3 ? of_cells : nullptr);
      functors.back().build(*complex);
      if (const suture_functor* const on_parts = instance.part_functor(i)) {
        functors.emplace_back(instance, functor, nullptr, on_parts);
        functors.back().build(*complex);
      }
    }
  }

  bool pays(const CompiledFunctor& functor, const BatchList& list) const {
    const auto nodes = static_cast<std::size_t>(nodes_of(functor.functor()));
    const bool large = list.cell_count() * nodes >= parallel_nodes;
    return threads.threads() > 1 && (large || !functor.instance().skips());
  }

  /// Calls chunk(worker, ranges, chunk number) for all chunks, in the order of the list.
  /// `function` is the functor's function that it calls, for messages; `rows` get its forces.
  template <class Chunk>
  void run(Index number, const char* function, double time, Chunk chunk) {
    run(number, function, functors[number].cells().live(), time, 0, nullptr, chunk);
  }
  template <class Chunk>
  void run_tangent(Index number, const TangentTime& at, Chunk chunk) {
    run(number, own_list(functors[number]), "tangent", functors[number].cells().live(), at.time,
        at.dt, nullptr, chunk);
  }
  template <class Chunk>
  void run(Index number, const char* function, const LiveMask& live, double time, double dt,
           double* rows, Chunk chunk) {
    run(number, functors[number].list(), function, live, time, dt, rows, chunk);
  }
  template <class Chunk>
  void run(Index number, const BatchList& list, const char* function, const LiveMask& live,
           double time, double dt, double* rows, Chunk chunk) {
    CompiledFunctor& functor = functors[number];
    const loops::Job& job = functor.job(attributes, *complex, live, time, dt, rows);
    const FunctorTimes::Scope timed(times ? &*times : nullptr, number, function, list.cell_count());
    const auto one = [&](std::size_t i, unsigned w) {
      const auto c = static_cast<Index>(i);
      const auto worker =
          workers[w].prepare(job, functor.instance().context(w), number, functor.call(function));
      const PluginScope scope(workers[w].call);
      chunk(job, worker, list.ranges(c), c);
    };
    if (pays(functor, list))
      threads.in_order(list.order(), one);
    else
      for (Index c = 0; c < list.chunk_count(); ++c) one(c, 0);
  }

  /// Calls visit(batch, rows of its lanes) for every batch of some ranges.
  template <class Visit>
  void for_each_batch(const loops::Job& job, const loops::Worker& worker,
                      std::span<const loops::Rows> ranges, Visit visit) const {
    for (const loops::Rows& range : ranges)
      for (Index row = range.begin; row < range.end;) {
        const Index here = std::min(range.end - row, lanes - row % lanes);
        const loops::BatchRows rows = loops::live_rows(job.live, row, here);
        row += here;
        if (rows.valid != 0) visit_batch(job, worker, rows, visit);
      }
  }
  template <class Visit>
  void visit_batch(const loops::Job& job, const loops::Worker& worker, const loops::BatchRows& rows,
                   const Visit& visit) const {
    loops::Buffers buffers;
    suture_batch batch;
    loops.gather(&job, &worker, &rows, &buffers, &batch);
    *worker.present = &batch;
    try {
      const suture_status status = visit(batch, rows);
      if (status != SUTURE_OK) worker.failed(worker.data, status, &batch);
    } catch (...) {
      worker.thrown(worker.data);
    }
    *worker.present = nullptr;
  }
  /// The same for the live rows that `select` wants, packed into batches whose rows ascend.
  template <class Select, class Visit>
  void for_selected(const loops::Job& job, const loops::Worker& worker,
                    std::span<const loops::Rows> ranges, Select select, const Visit& visit) const {
    loops::BatchRows packed{};
    const auto flush = [&] {
      if (packed.valid == 0) return;
      std::fill(packed.row + packed.valid, packed.row + lanes, packed.row[packed.valid - 1]);
      visit_batch(job, worker, packed, visit);
      packed.valid = 0;
    };
    for (const loops::Rows& range : ranges)
      for (Index row = range.begin; row < range.end; ++row) {
        if (job.live && (job.live[row / lanes] >> row % lanes & 1) == 0) continue;
        if (!select(row)) continue;
        if (packed.valid == lanes || (packed.valid > 0 && row < packed.row[packed.valid - 1]))
          flush();
        packed.row[packed.valid++] = row;
      }
    flush();
  }
  /// The same for batches that local_rows.hpp found.
  template <class Visit>
  void for_each_local(Index number, const char* function, double time,
                      std::span<const loops::BatchRows> batches, Visit visit) {
    CompiledFunctor& functor = functors[number];
    const loops::Job& job =
        functor.job(attributes, *complex, functor.cells().live(), time, 0, nullptr);
    const auto worker =
        workers[0].prepare(job, functor.instance().context(0), number, functor.call(function));
    const PluginScope scope(workers[0].call);
    const auto one = [&](suture_batch& batch, const loops::BatchRows& rows) {
      return visit(job, worker, batch, rows);
    };
    for (const loops::BatchRows& rows : batches) visit_batch(job, worker, rows, one);
  }

  /// With checks: throws PluginError unless the results of the current call are finite.
  void check_results(std::span<const double> results, Index valid) const {
    if (checks) require_finite(results, {present_call()->batch->cell_ids, valid});
  }

  /// The first of all threads, once.
  Failure take_failure() {
    Failure first;
    for (WorkerMemory& worker : workers) {
      first.merge(worker.failure);
      worker.failure.clear();
    }
    return first;
  }
  void raise_failures(double time) { raise(take_failure(), time); }
  void raise(const Failure& first, double time) {
    if (!first.any()) return;
    const CompiledFunctor& functor = functors[first.functor()];
    constexpr const char* words[4] = {"vertex", "edge", "face", "element"};
    first.raise(functor.title(), words[functor.functor().dimension], time);
  }

  Failure add_forces(double time, double dt, Part part, double* rows);
  bool is_divided() const;
  const BatchList& own_list(CompiledFunctor& functor);
  void find_share();
  void find_sums();
  void forget_shares();

  void book_unstored(double last_dt, const double* force);
  void follow_fixed(const TopologyChange& change);
  Index skip_fixed();
  const LiveMask& awake(const CompiledFunctor& functor) const;
  void sleep(Instance& instance, std::array<LiveMask, 4>& awake, std::span<const Index> elements);

  double sum_of(Index number, const CellNumbers& numbers, double time, Failure& first);
  double sum_of(CellNumbers (*numbers)(const CompiledFunctor&), double time);
  Softness project(Index number, const Projection& step);
  const std::vector<std::vector<loops::BatchRows>>& independent_batches(Index number,
                                                                        const loops::Job& job);
  void add_cell_work(Index number, const double* direction, double energy, const TangentTime& at,
                     std::span<double> out);
  bool add_field(Index number, std::string_view field, double time, std::span<double> values,
                 const std::vector<bool>* wanted);
  enum class RowsOfShare { own, all };
  template <class Real>
  void add_tangent(loops::Product<Real> product, const TangentTime& at,
                   RowsOfShare rows = RowsOfShare::all);
  bool add_single_tangent(Index number, const loops::Product<float>& product,
                          const TangentTime& at);
  bool add_single_tangent(Index, const loops::Product<double>&, const TangentTime&) {
    return false;
  }
  Index cell_functor(Index number) const;
  const loops::Job& tangent_job(Index number, const TangentTime& at);
  class CellMatrices;
  void for_each_piece(Index number, double dx, double dv, const TangentTime& at,
                      TangentPieces& pieces);
  void for_some_tangents(Index number, double dx, double dv, const TangentTime& at,
                         const SelectCell& select, const VisitTangents& visit);

  Attributes& attributes;
  const CellComplex* complex;
  const loops::Table& loops;
  Workers threads;
  std::vector<WorkerMemory> workers;
  std::deque<RowNodes> row_nodes;
  std::deque<CompiledFunctor> functors;
  LocalRows local;
  /// Rows that are neither dead nor asleep, per instance; empty if none is asleep.
  std::vector<std::array<LiveMask, 4>> awake_rows;
  /// By functor and chunk; empty until cells are projected.
  std::vector<std::vector<std::vector<loops::BatchRows>>> independent;
  BodyShare* share = nullptr;
  std::function<void(std::vector<bool>&)> mark_others;   ///< read by other terms and contact
  std::optional<std::vector<bool>> others;               ///< BodyShare::others(), once known
  std::vector<std::vector<unsigned>> processes_of_sums;  ///< by functor and chunk, with `others`
  bool checks = false;                                   ///< check_plugins()
  std::optional<FunctorTimes> times;                     ///< measure()
  bool operated = false;                                 ///< follow() was called
  std::vector<bool> fixed;  ///< vertices held at their rest positions; empty: nothing is left out
  // Work of functors without an energy if others have one, and their forces at the last
  // evaluation, in rows of 4.
  double unstored_work = 0;
  std::vector<double> unstored_force;
  bool unstored_is_booked = false;
};

}  // namespace suture
