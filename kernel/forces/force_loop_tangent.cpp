// SPDX-License-Identifier: GPL-3.0-or-later
#include <type_traits>
#include <utility>

#include "kernel/forces/force_loop_impl.hpp"

namespace suture {

bool ForceLoop::has_tangent() const { return without_tangent().empty(); }

std::string ForceLoop::without_tangent() const {
  for (const CompiledFunctor& functor : impl_->functors)
    if (!functor.skipped() && !functor.extension<suture_tangent_1>(SUTURE_TANGENT_1))
      return functor.title();
  return "";
}

namespace {

/// The functor's tangent in a run that checks plugins: it must be finite.
suture_status checked_tangent(const suture_context* context, const suture_batch* batch,
                              const double* dx, const double* dv, double* df) {
  const auto* extension =
      extension_of<suture_tangent_1>(*present_call()->functor, SUTURE_TANGENT_1);
  const suture_status status = extension->apply(context, batch, dx, dv, df);
  if (status != SUTURE_OK) return status;
  require_finite({df, std::size_t{batch->nodes} * 3 * lanes}, {batch->cell_ids, batch->valid});
  return status;
}

/// The same for floats, whose lanes all hold cells.
suture_status checked_single_tangent(const suture_context* context,
                                     const suture_single_batch* batch, const float* dx,
                                     const float* dv, float* df) {
  const PluginCall& call = *present_call();
  const auto* extension =
      extension_of<suture_tangent_single_1>(*call.functor, SUTURE_TANGENT_SINGLE_1);
  const suture_status status = extension->apply(context, batch, dx, dv, df);
  if (status != SUTURE_OK) return status;
  const std::size_t count = std::size_t{batch->nodes} * 3;
  for (std::size_t half = 0; half < SUTURE_SINGLE_LANES; half += lanes) {
    std::array<double, std::size_t{8} * 3 * lanes> results;
    for (std::size_t i = 0; i < count * lanes; ++i)
      results[i] = static_cast<double>(df[i / lanes * SUTURE_SINGLE_LANES + half + i % lanes]);
    require_finite({results.data(), count * lanes}, {call.batch->cell_ids + half, lanes});
  }
  return status;
}

/// What a functor's tangent in single precision reads.
loops::Job single_job(const loops::Job& job, const suture_tangent_single_1& extension,
                      Attributes& attributes) {
  loops::Job single = job;
  const auto reads = extension.reads;
  single.rest = reads & SUTURE_READ_REST ? attributes.rest().rows() : nullptr;
  single.position = reads & SUTURE_READ_POSITION ? attributes.position().rows() : nullptr;
  if ((reads & SUTURE_READ_VELOCITY) == 0) single.velocity = nullptr;
  single.cell_column_count = std::min(job.cell_column_count, extension.columns);
  if (extension.columns != UINT32_MAX) single.vertex_column_count = 0;
  return single;
}

void call(const loops::Table& loops, const loops::Job& job, const loops::Worker& worker,
          std::span<const loops::Rows> ranges, const loops::Product<double>& product) {
  loops.tangents_of_doubles(&job, &worker, ranges.data(), static_cast<Index>(ranges.size()),
                            &product);
}
void call(const loops::Table& loops, const loops::Job& job, const loops::Worker& worker,
          std::span<const loops::Rows> ranges, const loops::Product<float>& product) {
  loops.tangents_of_floats(&job, &worker, ranges.data(), static_cast<Index>(ranges.size()),
                           &product);
}

}  // namespace

/// False if the functor has no tangent in single precision.
bool ForceLoop::Impl::add_single_tangent(Index number, const loops::Product<float>& floats,
                                         const TangentTime& at) {
  const auto* extension =
      functors[number].extension<suture_tangent_single_1>(SUTURE_TANGENT_SINGLE_1);
  if (extension == nullptr) return false;
  const loops::SingleProduct product{checks ? checked_single_tangent : extension->apply,
                                     floats.direction, floats.dx, floats.dv, floats.out};
  run_tangent(number, at,
              [&](const loops::Job& job, const loops::Worker& worker,
                  std::span<const loops::Rows> ranges, Index) {
                const loops::Job single = single_job(job, *extension, attributes);
                loops.single_tangents(&single, &worker, ranges.data(),
                                      static_cast<Index>(ranges.size()), &product);
              });
  return true;
}

/// Adds those of the share, if there is one, which others then get.
template <class Real>
void ForceLoop::Impl::add_tangent(loops::Product<Real> product, const TangentTime& at,
                                  RowsOfShare wanted) {
  if (share && !others) find_share();
  for (Index i = 0; i < functors.size(); ++i) {
    if (functors[i].skipped() || add_single_tangent(i, product, at)) continue;
    const auto* extension = functors[i].extension<suture_tangent_1>(SUTURE_TANGENT_1);
    product.function = checks ? checked_tangent : extension->apply;
    run_tangent(
        i, at,
        [&](const loops::Job& job, const loops::Worker& worker, std::span<const loops::Rows> ranges,
            Index) { call(loops, job, worker, ranges, product); });
  }
  Failure first = take_failure();
  if (is_divided()) {
    const VertexRows rows(product.out, std::is_same_v<Real, float> ? 4 : 3);
    share->join_forces(rows, first);
    if (wanted == RowsOfShare::all) share->complete(rows);
  }
  raise(first, at.time);
}

void ForceLoop::add_own_tangent(const float* d, double dx, double dv, const TangentTime& at,
                                float* out) {
  const PartialRows::OwnIsEnough own(impl_->attributes.partial_rows());
  impl_->add_tangent(loops::Product<float>{nullptr, d, dx, dv, out}, at, Impl::RowsOfShare::own);
}

void ForceLoop::add_own_tangent(const double* d, double dx, double dv, const TangentTime& at,
                                double* out) {
  const PartialRows::OwnIsEnough own(impl_->attributes.partial_rows());
  impl_->add_tangent(loops::Product<double>{nullptr, d, dx, dv, out}, at, Impl::RowsOfShare::own);
}

void ForceLoop::add_tangent(const float* d, double dx, double dv, const TangentTime& at,
                            float* out) {
  impl_->add_tangent(loops::Product<float>{nullptr, d, dx, dv, out}, at);
}

void ForceLoop::add_tangent(const double* d, double dx, double dv, const TangentTime& at,
                            double* out) {
  impl_->add_tangent(loops::Product<double>{nullptr, d, dx, dv, out}, at);
}

// -------------------------------------------------------- matrices of cells --

namespace {

/// The functor's derivatives along one component of one node, for all cells of a batch at once:
/// column `column` of their matrices. Those of components that it does not have are 0.
class TangentColumns {
 public:
  TangentColumns(const suture_tangent_1& extension, Index nodes, Index components, double dx,
                 double dv)
      : extension_(extension),
        size_(nodes * 3),
        components_(components),
        values_(std::size_t{size_} * size_ * lanes),
        dx_(std::size_t{size_} * lanes),
        dv_(dx_.size()),
        scaled_dx_(dx),
        scaled_dv_(dv) {}

  suture_status compute(const suture_context* context, const suture_batch& batch) {
    for (Index column = 0; column < size_; ++column) {
      if (column % 3 >= components_) continue;
      const suture_status status = compute(context, batch, std::size_t{column} * lanes);
      if (status != SUTURE_OK) return status;
    }
    return SUTURE_OK;
  }
  std::span<const double> values() const { return values_; }

 private:
  suture_status compute(const suture_context* context, const suture_batch& batch, std::size_t at) {
    std::fill_n(&dx_[at], lanes, scaled_dx_);
    std::fill_n(&dv_[at], lanes, scaled_dv_);
    const suture_status status =
        extension_.apply(context, &batch, dx_.data(), dv_.data(), &values_[at * size_]);
    std::fill_n(&dx_[at], lanes, 0.0);
    std::fill_n(&dv_[at], lanes, 0.0);
    return status;
  }

  const suture_tangent_1& extension_;
  Index size_, components_;
  AlignedVector<double> values_;
  AlignedVector<double> dx_, dv_;  ///< 0 between two columns
  double scaled_dx_, scaled_dv_;
};

/// Computes the columns of a batch and hands them on, with the vertices of its cells.
class VisitColumns {
 public:
  VisitColumns(TangentColumns columns, const loops::Job& job, Index functor)
      : columns_(std::move(columns)),
        job_(job),
        functor_(functor),
        vertices_(std::size_t{job.node_count} * lanes) {}

  template <class Check>
  suture_status operator()(const suture_context* context, const suture_batch& batch,
                           const loops::BatchRows& rows, const Check& check,
                           const CellTangentTerm::VisitTangents& visit) {
    const suture_status status = columns_.compute(context, batch);
    if (status != SUTURE_OK) return status;
    check(columns_.values(), batch.valid);
    for (Index l = 0; l < batch.valid; ++l)
      std::copy_n(nodes_of(job_, rows.row[l]), job_.node_count,
                  vertices_.data() + std::size_t{l} * job_.node_count);
    visit({batch.valid, job_.node_count, vertices_.data(), columns_.values().data(), functor_});
    return status;
  }

 private:
  TangentColumns columns_;
  const loops::Job& job_;
  Index functor_;
  std::vector<Index> vertices_;
};

}  // namespace

/// CellTangents::functor of its cells.
Index ForceLoop::Impl::cell_functor(Index number) const {
  return acts_on_lips(functors[number].functor()) ? link_functor : number;
}

const loops::Job& ForceLoop::Impl::tangent_job(Index number, const TangentTime& at) {
  CompiledFunctor& functor = functors[number];
  return functor.job(attributes, *complex, functor.cells().live(), at.time, at.dt, nullptr);
}

/// The matrices of a functor's cells, for one thread.
class ForceLoop::Impl::CellMatrices {
 public:
  CellMatrices(Impl& impl, Index number, const loops::Job& job, double dx, double dv,
               unsigned thread = 0)
      : impl_(impl),
        functor_(impl.functors[number]),
        job_(job),
        number_(number),
        thread_(thread),
        columns_(TangentColumns(*functor_.extension<suture_tangent_1>(SUTURE_TANGENT_1),
                                job.node_count, functor_.components(), dx, dv),
                 job, impl.cell_functor(number)) {}

  /// Calls run(worker, visit of a batch).
  template <class Run>
  void operator()(const VisitTangents& visit, Run run) {
    WorkerMemory& memory = impl_.workers[thread_];
    const auto worker = memory.prepare(job_, functor_.instance().context(thread_), number_,
                                       functor_.call("tangent"));
    const PluginScope scope(memory.call);
    const auto check = [this](auto values, Index valid) { impl_.check_results(values, valid); };
    run(worker, [&](suture_batch& batch, const loops::BatchRows& rows) {
      return columns_(worker.context, batch, rows, check, visit);
    });
  }

 private:
  Impl& impl_;
  CompiledFunctor& functor_;
  const loops::Job& job_;
  Index number_;
  unsigned thread_;
  VisitColumns columns_;
};

namespace {

/// The rows of a list in pieces of whole batches, in the order of its chunks.
std::vector<loops::Rows> pieces_of(const BatchList& list) {
  constexpr Index most = 128;
  std::vector<loops::Rows> pieces;
  for (Index chunk = 0; chunk < list.chunk_count(); ++chunk)
    for (loops::Rows left : list.ranges(chunk))
      while (left.begin < left.end) {
        const Index end = std::min(left.end, (left.begin + most) / lanes * lanes);
        pieces.push_back({left.begin, end});
        left.begin = end;
      }
  return pieces;
}

}  // namespace

void ForceLoop::Impl::for_each_piece(Index number, double dx, double dv, const TangentTime& at,
                                     TangentPieces& pieces) {
  const BatchList& list = functors[number].list();
  const loops::Job& job = tangent_job(number, at);
  const bool is_shared = pieces.slots() > 1 && pays(functors[number], list);
  std::vector<CellMatrices> matrices;
  for (unsigned thread = 0; thread < (is_shared ? threads.threads() : 1); ++thread)
    matrices.emplace_back(*this, number, job, dx, dv, thread);

  const std::vector<loops::Rows> rows = pieces_of(list);
  const std::size_t slots = is_shared ? pieces.slots() : 1;
  for (std::size_t first = 0; first < rows.size(); first += slots) {
    const std::size_t count = std::min(slots, rows.size() - first);
    const auto visit_slot = [&](std::size_t slot, unsigned thread) {
      matrices[thread]([&](const CellTangents& cells) { pieces.visit(slot, cells); },
                       [&](const loops::Worker& worker, auto one) {
                         for_each_batch(job, worker, {&rows[first + slot], 1}, one);
                       });
    };
    if (is_shared)
      threads.parallel_for(count, visit_slot);
    else
      visit_slot(0, 0);
    for (std::size_t slot = 0; slot < count; ++slot) pieces.end_piece(slot);
  }
}

void ForceLoop::Impl::for_some_tangents(Index number, double dx, double dv, const TangentTime& at,
                                        const SelectCell& select, const VisitTangents& visit) {
  const BatchList& list = functors[number].list();
  const loops::Job& job = tangent_job(number, at);
  CellMatrices matrices(*this, number, job, dx, dv);
  matrices(visit, [&](const loops::Worker& worker, auto one) {
    const auto is_selected = [&](Index row) {
      return select({1, job.node_count, nodes_of(job, row), nullptr, cell_functor(number)});
    };
    for (Index chunk = 0; chunk < list.chunk_count(); ++chunk)
      for_selected(job, worker, list.ranges(chunk), is_selected, one);
  });
}

void ForceLoop::for_each_piece(double dx, double dv, const TangentTime& at, TangentPieces& pieces) {
  for (Index i = 0; i < impl_->functors.size(); ++i)
    if (!impl_->functors[i].skipped()) impl_->for_each_piece(i, dx, dv, at, pieces);
  impl_->raise_failures(at.time);
}

void ForceLoop::for_each_tangent(double dx, double dv, const TangentTime& at,
                                 const VisitTangents& visit) {
  class OneByOne final : public TangentPieces {
   public:
    explicit OneByOne(const VisitTangents& visit) : TangentPieces(1), visit_(visit) {}
    void visit(std::size_t, const CellTangents& cells) override { visit_(cells); }
    void end_piece(std::size_t) override {}

   private:
    const VisitTangents& visit_;
  } pieces(visit);
  for_each_piece(dx, dv, at, pieces);
}

void ForceLoop::for_some_tangents(double dx, double dv, const TangentTime& at,
                                  const SelectCell& select, const VisitTangents& visit) {
  for (Index i = 0; i < impl_->functors.size(); ++i)
    if (!impl_->functors[i].skipped()) impl_->for_some_tangents(i, dx, dv, at, select, visit);
  impl_->raise_failures(at.time);
}

namespace {

/// Whether the matrix of every cell is, but for rounding.
bool is_symmetric(const CellTangents& cells) {
  constexpr double rounding = 1e-6;  // of the largest entry
  constexpr std::size_t lanes = 8;
  const std::size_t rows = std::size_t{cells.nodes} * 3;
  double largest[lanes] = {}, difference[lanes] = {};
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      const double* const below = cells.values + (j * rows + i) * lanes;
      const double* const above = cells.values + (i * rows + j) * lanes;
      for (std::size_t l = 0; l < lanes; ++l) {
        largest[l] = std::max(largest[l], std::max(std::abs(below[l]), std::abs(above[l])));
        difference[l] = std::max(difference[l], std::abs(below[l] - above[l]));
      }
    }
  for (std::size_t cell = 0; cell < cells.cells; ++cell)
    if (difference[cell] > rounding * largest[cell]) return false;
  return true;
}

}  // namespace

bool ForceLoop::is_conservative(double time) {
  if (!has_tangent()) return true;
  constexpr Index sample = 24;
  const Index stride = impl_->complex->element_count() / sample + 1;
  Index cells = 0, functor = none;
  bool result = true;
  const auto is_selected = [&](const CellTangents& cell) {
    if (std::exchange(functor, cell.functor) != cell.functor) cells = 0;
    return cells++ % stride == 0;
  };
  for_some_tangents(1, 0, time, is_selected,
                    [&](const CellTangents& found) { result = result && is_symmetric(found); });
  return result;
}

}  // namespace suture
