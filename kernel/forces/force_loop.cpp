// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "kernel/attributes/cell_nodes.hpp"
#include "kernel/forces/force_loop_impl.hpp"
#include "kernel/plugin_host/part_functors.hpp"

namespace suture {

ForceLoop::ForceLoop(Attributes& attributes, const CellComplex& complex, unsigned threads,
                     const VertexField* field)
    : impl_(std::make_unique<Impl>(attributes, complex, threads, field)) {}

ForceLoop::~ForceLoop() = default;

namespace {

bool has_energy(const CompiledFunctor& functor) { return stored_energy(functor) != nullptr; }

bool belongs(const CompiledFunctor& functor, ForceLoop::Part part) {
  if (functor.skipped()) return false;
  return part == ForceLoop::Part::all ||
         has_energy(functor) == (part == ForceLoop::Part::with_energy);
}

bool reads_velocity_now(const CompiledFunctor& functor) {
  return !functor.skipped() && (functor.reads() & SUTURE_READ_VELOCITY) != 0;
}

bool keeps_state(const CompiledFunctor& functor) {
  const suture_functor& f = functor.functor();
  const std::span columns(f.cell_columns, f.cell_column_count);
  return !functor.skipped() && std::ranges::any_of(columns, [&](std::uint32_t place) {
    return (cell_attribute(functor.instance().model(), place).flags & SUTURE_TRIAL) != 0;
  });
}

}  // namespace

/// Adds those of the share, if there is one.
Failure ForceLoop::Impl::add_forces(double time, double dt, Part part, double* rows) {
  if (share && !others) find_share();
  for (Index i = 0; i < functors.size(); ++i) {
    if (!belongs(functors[i], part)) continue;
    CompiledFunctor& functor = functors[i];
    run(i, own_list(functor), "force", awake(functor), time, dt, rows,
        [&](const loops::Job& job, const loops::Worker& worker, std::span<const loops::Rows> ranges,
            Index) {
          loops.forces(&job, &worker, ranges.data(), static_cast<std::uint32_t>(ranges.size()));
        });
  }
  return take_failure();
}

void ForceLoop::add_forces(double time, double dt, Part part, double* rows) {
  if (rows == nullptr) rows = impl_->attributes.force().rows();
  Failure first = impl_->add_forces(time, dt, part, rows);
  if (impl_->is_divided()) {
    impl_->share->join_forces({rows, 4}, first);
    impl_->share->complete({rows, 4});
  }
  impl_->raise(first, time);
}

void ForceLoop::add_own_forces(const StepTimes& step, double* rows) {
  const PartialRows::OwnIsEnough own(impl_->attributes.partial_rows());
  Failure first = impl_->add_forces(step.time, step.dt, Part::all, rows);
  impl_->share->join_forces({rows, 4}, first);
  impl_->raise(first, step.time);
}

void ForceLoop::add_forces(double time, const LiveMask&, double* rows) {
  add_forces(time, 0, Part::all, rows);
}

void ForceLoop::add_forces_in_step(const StepTimes& step, const LiveMask&, double* rows) {
  if (!books_work()) return add_forces(step.time, step.dt, Part::all, rows);
  add_forces(step.time, step.dt, Part::without_energy, rows);
  impl_->book_unstored(step.last, rows);
  add_forces(step.time, step.dt, Part::with_energy, rows);
}

void require_finite(std::span<const double> results, std::span<const std::uint32_t> cells) {
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (i % lanes >= cells.size() || std::isfinite(results[i])) continue;
    throw PluginError(describe(*present_call()) + ": result " + std::to_string(i / lanes) +
                      " of cell " + std::to_string(cells[i % lanes]) +
                      " is not finite; see that no division, root or logarithm leaves its range");
  }
}

/// W += (f + f') / 2 . h v-, the rows being f' and nothing else.
void ForceLoop::Impl::book_unstored(double last_dt, const double* force) {
  const std::size_t size = std::size_t{attributes.vertex_count()} * 4;
  const double* velocity = attributes.velocity().rows();
  const bool first = unstored_force.empty();
  unstored_force.resize(size);
  double work = 0;
  for (std::size_t i = 0; i < size; ++i) {
    work += (unstored_force[i] + force[i]) * velocity[i];
    unstored_force[i] = force[i];
  }
  if (!first && !unstored_is_booked) unstored_work += work * last_dt / 2;
  unstored_is_booked = true;
}

double ForceLoop::work() const { return impl_->unstored_work; }
void ForceLoop::forget_last() { impl_->unstored_force.clear(); }
void ForceLoop::restart() {
  impl_->unstored_work = 0;
  forget_last();
}

bool ForceLoop::has(Part part) const {
  return std::ranges::any_of(
      impl_->functors, [&](const CompiledFunctor& functor) { return belongs(functor, part); });
}

bool ForceLoop::dissipates() const {
  return std::ranges::any_of(impl_->functors, [](const CompiledFunctor& functor) {
    return (reads_velocity_now(functor) || keeps_state(functor)) && has_energy(functor);
  });
}

void ForceLoop::accept() {
  impl_->unstored_is_booked = false;  // the forces to come are those of another state
  impl_->attributes.accept_trials();
}

// ------------------------------------------------------------------- shares --

void ForceLoop::share(BodyShare& share, std::function<void(std::vector<bool>&)> mark_others) {
  impl_->share = &share;
  impl_->mark_others = std::move(mark_others);
  find_share();
}

void ForceLoop::find_share() {
  impl_->forget_shares();
  impl_->find_share();
}

bool ForceLoop::knows_share() const { return impl_->others.has_value(); }

bool ForceLoop::may_divide() const {
  return impl_->share && !keeps_states() && !reads_fields() && !books_work();
}

void ForceLoop::Impl::find_share() {
  others = share->others(*complex);
  std::vector<bool> read(others->size());
  for (CompiledFunctor& functor : functors) {
    if (functor.skipped()) continue;
    const Connectivity cells = functor.connectivity(*complex);
    const BatchList& list = own_list(functor);
    for (Index chunk = 0; chunk < list.chunk_count(); ++chunk)
      for (const loops::Rows& rows : list.ranges(chunk))
        for (Index row = rows.begin; row < rows.end; ++row)
          for (const Index vertex : cells.of(row)) read[vertex] = true;
  }
  mark_others(read);
  share->read(read);
  find_sums();
}

/// The chunks that each process sums, at its elements.
void ForceLoop::Impl::find_sums() {
  std::vector<bool> read(others->size());
  const loops::Rows own = share->elements();
  for (Index e = own.begin; e < std::min(own.end, complex->element_count()); ++e) {
    if (!complex->exists(3, e)) continue;
    for (const Index vertex : complex->vertices_of(e)) read[vertex] = true;
  }
  processes_of_sums.assign(functors.size(), {});
  for (Index i = 0; i < functors.size(); ++i) {
    const CompiledFunctor& functor = functors[i];
    if (functor.skipped() ||
        !(energy_function(functor).function || dissipation_function(functor).function))
      continue;
    const Connectivity cells = functor.connectivity(*complex);
    for (Index chunk = 0; chunk < functor.list().chunk_count(); ++chunk) {
      const auto for_each_vertex = [&](auto visit) {
        for (const loops::Rows& rows : functor.list().ranges(chunk))
          for (Index row = rows.begin; row < rows.end; ++row)
            for (const Index vertex : cells.of(row))
              if (!visit(vertex)) return;
      };
      unsigned process = 0;
      for_each_vertex([&](Index vertex) {
        process = share->process_at(*complex, vertex);
        return false;
      });
      processes_of_sums[i].push_back(process);
      if (process == share->number())
        for_each_vertex([&](Index vertex) { return read[vertex] = true; });
    }
  }
  share->read_at_cells(read);
}

void ForceLoop::Impl::forget_shares() {
  others.reset();
  for (CompiledFunctor& functor : functors) functor.forget_list_without();
}

/// Functors that keep states are computed by all processes.
bool ForceLoop::Impl::is_divided() const {
  return share && std::ranges::any_of(functors, [](const CompiledFunctor& functor) {
           return !functor.skipped() && !functor.has_states();
         });
}

/// The part of a functor that this process runs.
const BatchList& ForceLoop::Impl::own_list(CompiledFunctor& functor) {
  if (!others || functor.has_states()) return functor.list();
  return functor.list_without(*others, *complex);
}

// -------------------------------------------------------------------- reads --

bool ForceLoop::reads_velocity() const {
  return std::ranges::any_of(impl_->functors, reads_velocity_now);
}

bool ForceLoop::keeps_states() const {
  return std::ranges::any_of(impl_->functors, [](const CompiledFunctor& functor) {
    return !functor.skipped() && functor.has_states();
  });
}

bool ForceLoop::reads_fields() const {
  return std::ranges::any_of(impl_->functors, [](const CompiledFunctor& functor) {
    return !functor.skipped() && functor.reads_field();
  });
}

bool ForceLoop::reads_motion() const {
  return std::ranges::any_of(impl_->functors, [](const CompiledFunctor& functor) {
    return !functor.skipped() &&
           (functor.reads() & (SUTURE_READ_POSITION | SUTURE_READ_VELOCITY)) != 0;
  });
}

bool ForceLoop::depends_on_positions_alone() const {
  return !reads_velocity() && !keeps_states() && !reads_fields();
}

bool ForceLoop::reads_summed_columns() const {
  return std::ranges::any_of(impl_->functors, [](const CompiledFunctor& functor) {
    return !functor.skipped() &&
           (functor.dimension() != 3 || functor.functor().vertex_column_count != 0);
  });
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
  for (const Index e : elements)
    for (int d = 0; d < 4; ++d)
      if (instance.table(d).cells.size() != 0)
        for (const Index cell : cells_of_element(*complex, d, e)) put_to_sleep(d, cell);
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

Index ForceLoop::Impl::skip_fixed() {
  Index skipped = 0;
  for (CompiledFunctor& functor : functors) {
    functor.leave_out(&fixed, *complex);
    skipped += functor.list().left_out();
  }
  return skipped;
}

Index ForceLoop::skip_fixed(std::vector<bool> fixed) {
  impl_->fixed = std::move(fixed);
  impl_->forget_shares();
  return impl_->skip_fixed();
}

/// The parts of a held vertex stay held; a vertex sewn to a held one becomes held.
void ForceLoop::Impl::follow_fixed(const TopologyChange& change) {
  if (fixed.empty()) return;
  fixed.resize(complex->count(0));
  for (const Split& split : change.splits[0]) fixed[split.new_cell] = fixed[split.old_cell];
  for (const Merge& merge : change.merges[0])
    fixed[merge.kept] = fixed[merge.kept] || fixed[merge.gone];
}

void ForceLoop::follow(const CellComplex& complex, const TopologyChange& change) {
  impl_->complex = &complex;
  impl_->operated |= !change.empty();
  impl_->forget_shares();
  // Until the next evaluation the first part of a split vertex carries the force of all.
  if (!impl_->unstored_force.empty())
    impl_->unstored_force.resize(std::size_t{impl_->attributes.vertex_count()} * 4);
  impl_->follow_fixed(change);
  impl_->awake_rows.clear();
  impl_->independent.clear();
  const RestPlaces rest = impl_->attributes.rest_places(complex);
  for (RowNodes& nodes : impl_->row_nodes) nodes.update(rest, change);
  for (CompiledFunctor& functor : impl_->functors) functor.update(complex, change);
}

void ForceLoop::make_room(Index faces) {
  for (RowNodes& nodes : impl_->row_nodes)
    nodes.make_room(cells_of_cut(faces)[static_cast<std::size_t>(nodes.dimension())]);
}

namespace {

/// Items that a state reads into but of which it makes none.
template <class Items>
struct FixedList {
  explicit FixedList(Items& list) : items(list) {}
  std::size_t size() const { return items.size(); }
  auto& operator[](std::size_t i) { return items[i]; }
  Items& items;
};

}  // namespace

void ForceLoop::state(Archive& archive) {
  Impl& i = *impl_;
  archive("unstored work", i.unstored_work);
  archive("unstored force", i.unstored_force);
  archive("unstored is booked", i.unstored_is_booked);
  if (!archive.has_cells()) return;
  if (archive.loads()) i.independent.clear();
  archive("operated", i.operated);
  archive("fixed", i.fixed);
  archive.each("awake", i.awake_rows, [](Archive& a, auto& masks) { a.each("masks", masks); });
  const auto fits = [](std::size_t size, std::size_t all) { return size == 0 || size == all; };
  archive.require(fits(i.fixed.size(), i.attributes.vertex_count()) &&
                      fits(i.awake_rows.size(), i.attributes.instances().size()),
                  "the masks of fixed and sleeping cells belong to a different body");
  if (FixedList nodes{i.row_nodes}; i.operated) archive.each("row_nodes", nodes);
  FixedList functors{i.functors};
  archive.each("functors", functors, [&](Archive& a, CompiledFunctor& functor) {
    functor.state(a, i.fixed.empty() ? nullptr : &i.fixed);
  });
  if (!archive.loads()) return;
  i.forget_shares();
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

void ForceLoop::check_plugins() {
  impl_->checks = true;
  for (CompiledFunctor& functor : impl_->functors) functor.check_calls();
}

void ForceLoop::measure() { impl_->times.emplace(); }

std::vector<FunctorCost> ForceLoop::costs() const {
  std::vector<FunctorCost> costs;
  if (!impl_->times) return costs;
  for (const FunctorTimes::Entry& entry : impl_->times->entries()) {
    const CompiledFunctor& functor = impl_->functors[entry.functor];
    costs.push_back({functor.instance().name() + "/" + functor.functor().name,
                     std::string(entry.function), entry.calls, entry.cells,
                     std::chrono::duration<double>(entry.time).count()});
  }
  return costs;
}

const Workers& ForceLoop::workers() const { return impl_->threads; }

unsigned ForceLoop::threads() const {
  for (const CompiledFunctor& functor : impl_->functors)
    if (!functor.skipped() && impl_->pays(functor, functor.list())) return impl_->threads.threads();
  return 1;
}

std::string_view ForceLoop::isa() const { return impl_->loops.isa; }

}  // namespace suture
