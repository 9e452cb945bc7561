// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/force_loop.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <limits>
#include <ranges>

#include "kernel/base/archive.hpp"
#include "kernel/forces/compiled_functor.hpp"
#include "kernel/forces/local_rows.hpp"
#include "kernel/forces/loops/dispatch.hpp"
#include "kernel/forces/vertex_bounds.hpp"
#include "kernel/forces/worker_memory.hpp"

namespace suture {
namespace {

constexpr Index lanes = SUTURE_LANES;
constexpr const char* cell_words[4] = {"vertex", "edge", "face", "element"};

/// Nodes gathered below which one thread is faster than waking others: about
/// 0.1 ms of work against some microseconds per colour.
constexpr std::size_t parallel_nodes = 32768;

/// A direction of dx and dv: a row of 3 per vertex, times a factor each.
template <class Real>
struct Direction {
  const Real* rows;
  double dx, dv;
};

}  // namespace

struct ForceLoop::Impl {
  Impl(Attributes& a, const CellComplex& c, unsigned wanted)
      : attributes(a), complex(&c), loops(hot_loops()), threads(wanted) {
    workers.resize(threads.threads());
    for (auto& instance : attributes.instances()) {
      instance->set_workers(threads.threads());
      add(*instance);
    }
  }

  void add(Instance& instance) {
    std::array<RowNodes*, 4> nodes{};
    const suture_model& model = instance.model();
    for (std::size_t i = 0; i < model.functor_count; ++i) {
      const suture_functor& functor = model.functors[i];
      const auto dimension = functor.dimension;
      const bool has_rows = (dimension == 1 || dimension == 2) && instance.functor(i).runs;
      if (has_rows && !nodes[dimension]) {
        row_nodes.emplace_back(instance, static_cast<int>(dimension),
                               attributes.rest_places(*complex));
        nodes[dimension] = &row_nodes.back();
      }
      functors.emplace_back(instance, functor, dimension < 3 ? nodes[dimension] : nullptr);
      functors.back().build(*complex);
    }
  }

  bool pays(const CompiledFunctor& functor) const {
    const std::size_t nodes = std::size_t{2} << (functor.functor().dimension - 1);
    const bool large = functor.list().cell_count() * nodes >= parallel_nodes;
    return threads.threads() > 1 && (large || !functor.instance().skips());
  }

  /// chunk(worker, ranges, chunk number) for all chunks, in the order of the list.
  template <class Chunk>
  void run(Index number, double time, double dt, Chunk chunk) {
    run(number, functors[number].cells().live(), time, dt, chunk);
  }
  template <class Chunk>
  void run(Index number, const LiveMask& live, double time, double dt, Chunk chunk) {
    CompiledFunctor& functor = functors[number];
    const loops::Job& job = functor.job(attributes, *complex, live, time, dt);
    const BatchList& list = functor.list();
    const auto one = [&](std::size_t i, unsigned w) {
      const auto c = static_cast<Index>(i);
      const auto worker = workers[w].prepare(job, functor.instance().context(w), number);
      chunk(job, worker, list.ranges(c), c);
    };
    if (pays(functor))
      threads.in_order(list.order(), one);
    else
      for (Index c = 0; c < list.chunk_count(); ++c) one(c, 0);
  }

  /// visit(batch, rows of its lanes) for every batch of some ranges.
  template <class Visit>
  void for_each_batch(const loops::Job& job, const loops::Worker& worker,
                      std::span<const loops::Range> ranges, Visit visit) const {
    for (const loops::Range& range : ranges)
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
    const suture_status status = visit(batch, rows);
    if (status != SUTURE_OK) worker.failed(worker.data, status, &batch);
  }
  /// The same for batches that local_rows.hpp found.
  template <class Visit>
  void for_each_local(Index number, double time, std::span<const loops::BatchRows> batches,
                      Visit visit) {
    CompiledFunctor& functor = functors[number];
    const loops::Job& job = functor.job(attributes, *complex, functor.cells().live(), time, 0);
    const auto worker = workers[0].prepare(job, functor.instance().context(0), number);
    const auto one = [&](suture_batch& batch, const loops::BatchRows& rows) {
      return visit(job, worker, batch, rows);
    };
    for (const loops::BatchRows& rows : batches) visit_batch(job, worker, rows, one);
  }

  void raise_failures(double time) {
    Failure first;
    for (WorkerMemory& worker : workers) {
      first.merge(worker.failure);
      worker.failure.clear();
    }
    if (!first.any()) return;
    const CompiledFunctor& functor = functors[first.functor()];
    first.raise(functor.title(), cell_words[functor.functor().dimension], time);
  }

  void follow_still(const TopologyChange& change);
  Index skip_still();
  const LiveMask& awake(const CompiledFunctor& functor) const;
  void sleep(Instance& instance, std::array<LiveMask, 4>& awake, std::span<const Index> elements);

  double energy_of(Index number, double time);
  bool add_field(Index number, std::string_view field, double time, std::span<double> values);
  template <class Real>
  void add_tangent(Index number, const Direction<Real>& d, double time, Real* out);
  template <class Real>
  void add_tangent(const Direction<Real>& d, double time, Real* out);

  Attributes& attributes;
  const CellComplex* complex;
  const loops::Table& loops;
  Workers threads;
  std::vector<WorkerMemory> workers;
  std::deque<RowNodes> row_nodes;
  std::deque<CompiledFunctor> functors;
  LocalRows local;
  VertexSelection selection;
  /// Rows that are neither dead nor asleep, per instance; empty if none sleeps.
  std::vector<std::array<LiveMask, 4>> awake_rows;
  bool operated = false;    ///< update() was called
  std::vector<bool> still;  ///< vertices held where they are at rest; empty: nothing is left out
};

ForceLoop::ForceLoop(Attributes& attributes, const CellComplex& complex, unsigned threads)
    : impl_(std::make_unique<Impl>(attributes, complex, threads)) {}

ForceLoop::~ForceLoop() = default;

namespace {

bool has_energy(const CompiledFunctor& functor) {
  return functor.extension<suture_energy_1>(SUTURE_ENERGY_1) != nullptr;
}

bool belongs(const CompiledFunctor& functor, ForceLoop::Part part) {
  if (functor.skipped()) return false;
  return part == ForceLoop::Part::all ||
         has_energy(functor) == (part == ForceLoop::Part::with_energy);
}

bool reads_velocity_now(const CompiledFunctor& functor) {
  return !functor.skipped() && (functor.reads() & SUTURE_READ_VELOCITY) != 0;
}

}  // namespace

void ForceLoop::add_forces(double time, double dt, Part part) {
  const auto& loops = impl_->loops;
  for (Index i = 0; i < impl_->functors.size(); ++i) {
    if (!belongs(impl_->functors[i], part)) continue;
    impl_->run(i, impl_->awake(impl_->functors[i]), time, dt,
               [&](const loops::Job& job, const loops::Worker& worker,
                   std::span<const loops::Range> ranges, Index) {
                 loops.forces(&job, &worker, ranges.data(),
                              static_cast<std::uint32_t>(ranges.size()));
               });
  }
  impl_->raise_failures(time);
}

bool ForceLoop::has(Part part) const {
  return std::ranges::any_of(
      impl_->functors, [&](const CompiledFunctor& functor) { return belongs(functor, part); });
}

bool ForceLoop::is_viscoelastic() const {
  return std::ranges::any_of(impl_->functors, [](const CompiledFunctor& functor) {
    return reads_velocity_now(functor) && has_energy(functor);
  });
}

void ForceLoop::accept() { impl_->attributes.accept_trials(); }

// ------------------------------------------------------------------- energy --

double ForceLoop::Impl::energy_of(Index number, double time) {
  const auto* extension = functors[number].extension<suture_energy_1>(SUTURE_ENERGY_1);
  if (!extension) return 0;
  std::vector<double> of_chunk(functors[number].list().chunk_count());
  run(number, time, 0,
      [&](const loops::Job& job, const loops::Worker& worker, std::span<const loops::Range> ranges,
          Index chunk) {
        for_each_batch(job, worker, ranges, [&](suture_batch& batch, const loops::BatchRows&) {
          alignas(64) double out[lanes];
          const suture_status status = extension->energy(worker.context, &batch, out);
          for (Index l = 0; l < batch.valid; ++l) of_chunk[chunk] += out[l];
          return status;
        });
      });
  double sum = 0;
  for (const double part : of_chunk) sum += part;
  return sum;
}

double ForceLoop::energy(double time) {
  double sum = 0;
  for (Index i = 0; i < impl_->functors.size(); ++i)
    if (!impl_->functors[i].skipped()) sum += impl_->energy_of(i, time);
  impl_->raise_failures(time);
  return sum;
}

std::vector<Vec3> ForceLoop::forces_around(std::span<const Index> vertices, double time) {
  std::vector<Vec3> forces(vertices.size());
  if (vertices.empty()) return forces;
  impl_->selection.select(vertices, impl_->attributes.vertex_count());
  const std::vector<Index> elements = impl_->local.elements_around(*impl_->complex, vertices);
  alignas(64) double force[8 * 3 * lanes];
  for (Index i = 0; i < impl_->functors.size(); ++i) {
    const CompiledFunctor& functor = impl_->functors[i];
    if (functor.skipped()) continue;
    impl_->for_each_local(
        i, time, impl_->local.rows_at(*impl_->complex, functor, elements, impl_->selection),
        [&](const loops::Job& job, const loops::Worker& worker, suture_batch& batch,
            const loops::BatchRows& rows) {
          batch.force = force;
          const suture_status status = job.function(worker.context, &batch);
          for (Index l = 0; l < batch.valid; ++l) {
            const Index r = rows.row[l];
            const Index* nodes =
                job.nodes + std::size_t{job.cells ? job.cells[r] : r} * job.node_count;
            for (Index n = 0; n < job.node_count; ++n) {
              if (!impl_->selection.contains(nodes[n])) continue;
              Vec3& sum = forces[impl_->selection.slot(nodes[n])];
              for (std::size_t c = 0; c < 3; ++c) sum[c] += force[(n * 3 + c) * lanes + l];
            }
          }
          return status;
        });
  }
  impl_->raise_failures(time);
  return forces;
}

const VertexSelection& ForceLoop::selection() const { return impl_->selection; }

double ForceLoop::energy_around(std::span<const Index> elements, double time) {
  double sum = 0;
  for (Index i = 0; i < impl_->functors.size(); ++i) {
    const CompiledFunctor& functor = impl_->functors[i];
    const auto* extension = functor.extension<suture_energy_1>(SUTURE_ENERGY_1);
    if (functor.skipped() || !extension) continue;
    impl_->for_each_local(i, time, impl_->local.rows_of(*impl_->complex, functor, elements),
                          [&](const loops::Job&, const loops::Worker& worker, suture_batch& batch,
                              const loops::BatchRows&) {
                            alignas(64) double out[lanes];
                            const suture_status status =
                                extension->energy(worker.context, &batch, out);
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

// ------------------------------------------------------------ output fields --

bool ForceLoop::Impl::add_field(Index number, std::string_view field, double time,
                                std::span<double> values) {
  const auto* extension = functors[number].extension<suture_output_1>(SUTURE_OUTPUT_1);
  if (!extension) return false;
  const std::span fields(extension->fields, extension->field_count);
  const auto wanted = std::find_if(fields.begin(), fields.end(),
                                   [&](const suture_field& f) { return f.name == field; });
  if (wanted == fields.end()) return false;
  const auto width = std::size_t{wanted->components};
  const auto place = static_cast<std::size_t>(wanted - fields.begin());
  run(number, time, 0,
      [&](const loops::Job& job, const loops::Worker& worker, std::span<const loops::Range> ranges,
          Index) {
        AlignedVector<double> out(width * lanes);
        std::vector<double*> places(fields.size(), nullptr);
        places[place] = out.data();
        for_each_batch(job, worker, ranges, [&](suture_batch& batch, const loops::BatchRows& rows) {
          const suture_status status = extension->compute(worker.context, &batch, places.data());
          for (Index l = 0; l < batch.valid; ++l)
            for (std::size_t c = 0; c < width; ++c)
              values[rows.row[l] * width + c] = out[c * lanes + l];
          return status;
        });
      });
  return true;
}

bool ForceLoop::compute_field(const Instance& instance, int dimension, std::string_view field,
                              double time, std::span<double> values) {
  bool given = false;
  for (Index i = 0; i < impl_->functors.size(); ++i) {
    const CompiledFunctor& functor = impl_->functors[i];
    const bool asked = &functor.instance() == &instance && !functor.skipped() &&
                       static_cast<int>(functor.functor().dimension) == dimension;
    if (asked) given |= impl_->add_field(i, field, time, values);
  }
  impl_->raise_failures(time);
  return given;
}

// ------------------------------------------------------------------- bounds --

namespace {

const suture_stable_dt_1& bounds_of(const CompiledFunctor& functor) {
  const auto* extension = functor.extension<suture_stable_dt_1>(SUTURE_STABLE_DT_1);
  if (extension) return *extension;
  throw PluginError(functor.title() +
                    " offers no bound of the stable step (suture.stable-dt/1): give \"dt\" as a "
                    "number of seconds, or add the extension to the model");
}

/// sums(vertex) += the bounds of every node of a batch.
template <class Sums>
suture_status add_bounds(const suture_stable_dt_1& extension, const loops::Job& job,
                         const loops::Worker& worker, suture_batch& batch,
                         const loops::BatchRows& rows, Sums& sums) {
  alignas(64) double stiffness[8 * 6 * lanes] = {}, damping[8 * 6 * lanes] = {};
  const suture_status status = extension.bounds(worker.context, &batch, stiffness, damping);
  for (Index l = 0; l < batch.valid; ++l) {
    const Index r = rows.row[l];
    const Index* nodes = job.nodes + std::size_t{job.cells ? job.cells[r] : r} * job.node_count;
    for (Index n = 0; n < job.node_count; ++n)
      sums.add(nodes[n], stiffness + n * 6 * lanes + l, damping + n * 6 * lanes + l);
  }
  return status;
}

}  // namespace

ForceLoop::Bounds ForceLoop::bounds(double time) {
  VertexBounds sums(impl_->attributes.vertex_count());
  for (Index i = 0; i < impl_->functors.size(); ++i) {
    if (impl_->functors[i].skipped()) continue;
    const suture_stable_dt_1& extension = bounds_of(impl_->functors[i]);
    impl_->run(i, time, 0,
               [&](const loops::Job& job, const loops::Worker& worker,
                   std::span<const loops::Range> ranges, Index) {
                 impl_->for_each_batch(
                     job, worker, ranges, [&](suture_batch& batch, const loops::BatchRows& rows) {
                       return add_bounds(extension, job, worker, batch, rows, sums);
                     });
               });
  }
  impl_->raise_failures(time);
  Bounds bounds;
  for (Index v = 0; v < impl_->attributes.vertex_count(); ++v)
    include_vertex(v, sums[v], impl_->attributes, bounds);
  return bounds;
}

ForceLoop::Bounds ForceLoop::bounds_around(std::span<const Index> vertices, double time) {
  if (vertices.empty()) return {};
  VertexSelection& selection = impl_->selection;
  selection.select(vertices, impl_->attributes.vertex_count());
  LocalBounds sums(selection, vertices.size());
  const std::vector<Index> elements = impl_->local.elements_around(*impl_->complex, vertices);
  for (Index i = 0; i < impl_->functors.size(); ++i) {
    const CompiledFunctor& functor = impl_->functors[i];
    if (functor.skipped()) continue;
    const suture_stable_dt_1& extension = bounds_of(functor);
    impl_->for_each_local(i, time,
                          impl_->local.rows_at(*impl_->complex, functor, elements, selection),
                          [&](const auto& job, const auto& worker, auto& batch, const auto& rows) {
                            return add_bounds(extension, job, worker, batch, rows, sums);
                          });
  }
  impl_->raise_failures(time);
  Bounds bounds;
  for (const Index v : vertices) include_vertex(v, sums[v], impl_->attributes, bounds);
  return bounds;
}

// ------------------------------------------------------------------ tangent --

bool ForceLoop::has_tangent() const { return without_tangent().empty(); }

std::string ForceLoop::without_tangent() const {
  for (const CompiledFunctor& functor : impl_->functors)
    if (!functor.skipped() && !functor.extension<suture_tangent_1>(SUTURE_TANGENT_1))
      return functor.title();
  return "";
}

bool ForceLoop::reads_velocity() const {
  return std::ranges::any_of(impl_->functors, reads_velocity_now);
}

bool ForceLoop::reads_summed_columns() const {
  return std::ranges::any_of(impl_->functors, [](const CompiledFunctor& functor) {
    return !functor.skipped() &&
           (functor.dimension() != 3 || functor.functor().vertex_column_count != 0);
  });
}

template <class Real>
void ForceLoop::Impl::add_tangent(Index number, const Direction<Real>& d, double time, Real* out) {
  const auto* extension = functors[number].extension<suture_tangent_1>(SUTURE_TANGENT_1);
  run(number, time, 0,
      [&](const loops::Job& job, const loops::Worker& worker, std::span<const loops::Range> ranges,
          Index) {
        for_each_batch(job, worker, ranges, [&](suture_batch& batch, const loops::BatchRows& rows) {
          alignas(64) double dx[8 * 3 * lanes], dv[8 * 3 * lanes], df[8 * 3 * lanes];
          const auto for_each_value = [&](Index count, auto value) {
            for (Index l = 0; l < count; ++l) {
              const Index r = rows.row[l];
              const Index* nodes =
                  job.nodes + std::size_t{job.cells ? job.cells[r] : r} * job.node_count;
              for (Index n = 0; n < job.node_count; ++n)
                for (std::size_t c = 0; c < 3; ++c)
                  value(std::size_t{nodes[n]} * 3 + c, (n * 3 + c) * lanes + l);
            }
          };
          for_each_value(lanes, [&](std::size_t vertex, std::size_t at) {
            dx[at] = d.dx * static_cast<double>(d.rows[vertex]);
            dv[at] = d.dv * static_cast<double>(d.rows[vertex]);
          });
          const suture_status status = extension->apply(worker.context, &batch, dx, dv, df);
          for_each_value(batch.valid, [&](std::size_t vertex, std::size_t at) {
            out[vertex] += static_cast<Real>(df[at]);
          });
          return status;
        });
      });
}

template <class Real>
void ForceLoop::Impl::add_tangent(const Direction<Real>& d, double time, Real* out) {
  for (Index i = 0; i < functors.size(); ++i)
    if (!functors[i].skipped()) add_tangent(i, d, time, out);
  raise_failures(time);
}

void ForceLoop::add_tangent(const float* d, double dx, double dv, double time, float* out) {
  impl_->add_tangent(Direction<float>{d, dx, dv}, time, out);
}

void ForceLoop::add_tangent(const double* d, double dx, double dv, double time, double* out) {
  impl_->add_tangent(Direction<double>{d, dx, dv}, time, out);
}

// -------------------------------------------------------------------- sleep --

const LiveMask& ForceLoop::Impl::awake(const CompiledFunctor& functor) const {
  if (awake_rows.empty()) return functor.cells().live();
  const auto is_its = [&](const auto& instance) { return instance.get() == &functor.instance(); };
  const auto& instances = attributes.instances();
  const auto at = std::ranges::find_if(instances, is_its) - instances.begin();
  return awake_rows[static_cast<std::size_t>(at)][functor.functor().dimension];
}

/// Rows that no loop visits keep their state through every acceptance.
void ForceLoop::Impl::sleep(Instance& instance, std::array<LiveMask, 4>& awake,
                            std::span<const Index> elements) {
  const auto put_to_sleep = [&](int dimension, Index cell) {
    Table& table = instance.table(dimension);
    if (!table.cells.contains(cell)) return;
    const Index row = table.cells.row(cell);
    awake[static_cast<std::size_t>(dimension)].kill(row, table.cells.size());
    for (Column& column : table.columns)
      if (column.has_trial()) column.hold_row(row);
  };
  for (const Index e : elements) {
    put_to_sleep(3, e);
    if (instance.table(1).cells.size() != 0)
      for (const Index edge : complex->edges_of(e)) put_to_sleep(1, edge);
    if (instance.table(2).cells.size() != 0)
      for (const Index face : complex->faces_of(e)) put_to_sleep(2, face);
  }
}

void ForceLoop::sleep(std::span<const Index> elements) {
  auto& instances = impl_->attributes.instances();
  if (impl_->awake_rows.empty()) {
    impl_->awake_rows.resize(instances.size());
    for (std::size_t i = 0; i < instances.size(); ++i)
      for (int d = 0; d < 4; ++d)
        impl_->awake_rows[i][static_cast<std::size_t>(d)] = instances[i]->table(d).cells.live();
  }
  for (std::size_t i = 0; i < instances.size(); ++i)
    impl_->sleep(*instances[i], impl_->awake_rows[i], elements);
}

void ForceLoop::wake_all() { impl_->awake_rows.clear(); }

// --------------------------------------------------------- changes, summary --

Index ForceLoop::Impl::skip_still() {
  Index skipped = 0;
  for (CompiledFunctor& functor : functors) {
    functor.leave_out(&still, *complex);
    skipped += functor.list().left_out();
  }
  return skipped;
}

Index ForceLoop::skip_still(std::vector<bool> still) {
  impl_->still = std::move(still);
  return impl_->skip_still();
}

/// The parts of a vertex are held alike; what is sewn to a held vertex is held.
void ForceLoop::Impl::follow_still(const TopologyChange& change) {
  if (still.empty()) return;
  still.resize(complex->count(0));
  for (const Split& split : change.splits[0]) still[split.new_cell] = still[split.old_cell];
  for (const Merge& merge : change.merges[0])
    still[merge.kept] = still[merge.kept] || still[merge.gone];
}

void ForceLoop::update(const CellComplex& complex, const TopologyChange& change) {
  impl_->complex = &complex;
  impl_->operated |= !change.empty();
  impl_->follow_still(change);
  impl_->awake_rows.clear();
  const RestPlaces rest = impl_->attributes.rest_places(complex);
  for (RowNodes& nodes : impl_->row_nodes) nodes.update(rest, change);
  for (CompiledFunctor& functor : impl_->functors) functor.update(complex, change);
}

void ForceLoop::state(Archive& archive) {
  if (!archive.has_cells()) return;
  Impl& i = *impl_;
  archive("operated", i.operated);
  archive("still", i.still);
  archive.each("awake", i.awake_rows, [](Archive& a, auto& masks) { a.each("masks", masks); });
  const auto fits = [](std::size_t size, std::size_t all) { return size == 0 || size == all; };
  archive.require(fits(i.still.size(), i.attributes.vertex_count()) &&
                      fits(i.awake_rows.size(), i.attributes.instances().size()),
                  "what is still or asleep is of another body");
  if (auto nodes = std::views::all(i.row_nodes); i.operated) archive.each("row_nodes", nodes);
  auto functors = std::views::all(i.functors);
  archive.each("functors", functors, [&](Archive& a, CompiledFunctor& functor) {
    functor.state(a, i.still.empty() ? nullptr : &i.still);
  });
}

std::vector<ForceLoop::Summary> ForceLoop::summary() const {
  std::vector<Summary> lines;
  for (const CompiledFunctor& functor : impl_->functors) {
    const BatchList& list = functor.list();
    lines.push_back({functor.instance().name(), functor.functor().name, list.cell_count(),
                     list.batch_count(), list.chunk_count(), list.colour_count(), list.left_out(),
                     functor.reads(), functor.skipped(), functor.reason()});
  }
  return lines;
}

const Workers& ForceLoop::workers() const { return impl_->threads; }

unsigned ForceLoop::threads() const {
  for (const CompiledFunctor& functor : impl_->functors)
    if (!functor.skipped() && impl_->pays(functor)) return impl_->threads.threads();
  return 1;
}

std::string_view ForceLoop::isa() const { return impl_->loops.isa; }

}  // namespace suture
