// SPDX-License-Identifier: GPL-3.0-or-later
//
// Position based dynamics with compliance on the cells of functors.
#include <array>
#include <cmath>
#include <cstdio>

#include "kernel/forces/force_loop_impl.hpp"

// A cell as a constraint
// ======================
//
// A cell with the energy U and the forces f is the constraint C = sqrt(2 U) with the compliance 1
// (Macklin, Mueller, Chentanez, XPBD, MIG 2016): its gradient is -f / C. One iteration in a step of
// length h, with the multiplier 0 before it, moves the nodes n of masses m_n by
//
//   dx_n = h^2 f_n / m_n / (1 + h^2 w),   w = sum_n |f_n|^2 / m_n / 2 U
//
// For a spring, U = k (l - l_0)^2 / 2, this is C = l - l_0 with the compliance 1 / k. The cells are
// visited one after the other, each where those before it have left the vertices.
//
// For one cell alone this is a step of implicit Euler. Of many, each misses what those after it
// will do. In a smooth deformation the forces of the others cancel its own, so that half of these
// misses about -h^2 w / 2: the pass keeps 1 / (1 + h^2 w / 2) of the stiffness. What it leaves out
// falls with h^2.
//
// A pass may compensate: with the compliance max(1 - h^2 w / 2, 0) in place of 1, such cells keep
// the stiffness 1, as long as h^2 w < 2. No cell moves beyond C = 0 (of a spring), so that steps
// stay bounded. One cell alone, which misses nothing, is then too stiff by h^2 w / 2.
//
// Forces that read velocities are the sum of f(x, 0), which the energy gives, and a viscous part
//   g = f(x, v) - f(x, 0),   v = (x' - x) / h as the cells before have left it
// that dissipates the power -g . v. It is the next constraint of the same cells, with the energy
// h R, R = -g . v / 2: for a linear dashpot, h R = c (l' - l)^2 / 2h.
//
// A state is the accepted one in all evaluations of a step. What its functor adds to the forces
// beside the gradient of the energy acts in full; only w does not know of it.
//
// Chunks come in the order of their list, in which each waits for those with which it shares
// vertices. The cells of a chunk are packed into batches of up to 8 that share none, first fit. So
// the bits are the same for any number of threads. Batches leave out what sleeps, and the order of
// the others stays.

namespace suture {
namespace {

/// Batches of rows that share no vertex.
class IndependentBatches {
 public:
  void add(Index row, std::span<const Index> vertices) {
    for (Open& open : open_)
      if (open.batch.valid < lanes && !open.shares(vertices)) return open.add(row, vertices);
    open_.emplace_back().add(row, vertices);
  }
  std::vector<loops::BatchRows> take() {
    std::vector<loops::BatchRows> batches;
    for (Open& open : open_) {
      loops::BatchRows& b = open.batch;
      std::sort(b.row, b.row + b.valid);
      std::fill(b.row + b.valid, b.row + lanes, b.row[b.valid - 1]);
      batches.push_back(b);
    }
    return batches;
  }

 private:
  struct Open {
    loops::BatchRows batch{};
    std::vector<Index> vertices;

    bool shares(std::span<const Index> others) const {
      return std::ranges::find_first_of(vertices, others) != vertices.end();
    }
    void add(Index row, std::span<const Index> others) {
      batch.row[batch.valid++] = row;
      vertices.insert(vertices.end(), others.begin(), others.end());
    }
  };
  std::vector<Open> open_;
};

loops::BatchRows awake_of(const loops::BatchRows& all, const std::uint8_t* live) {
  loops::BatchRows rows{};
  for (const Index row : std::span(all.row, all.valid))
    if (!live || (live[row / lanes] >> row % lanes & 1) != 0) rows.row[rows.valid++] = row;
  if (rows.valid > 0) std::fill(rows.row + rows.valid, rows.row + lanes, rows.row[rows.valid - 1]);
  return rows;
}

/// Moves the nodes of the cells of a batch, whose energies are given.
ForceLoop::Softness move_nodes(const ForceLoop::Projection& step, const loops::Job& job,
                               const loops::BatchRows& rows, const double* force,
                               const std::array<double, lanes>& energy, double* position) {
  const double square = step.dt * step.dt;
  ForceLoop::Softness sum;
  for (Index l = 0; l < rows.valid; ++l) {
    if (!(energy[l] > 0)) continue;
    const Index* nodes = nodes_of(job, rows.row[l]);
    const auto for_each_component = [&](auto visit) {
      for (Index n = 0; n < job.node_count; ++n)
        for (Index c = 0; c < 3; ++c)
          visit(std::size_t{nodes[n]} * 4 + c, force[(n * 3 + c) * lanes + l]);
    };
    double w = 0;
    for_each_component(
        [&](std::size_t row, double f) { w += f * f * step.inverse_mass[row] / (2 * energy[l]); });
    const double softness = square * w;
    const double compliance = step.compensates ? std::max(1 - softness / 2, 0.0) : 1;
    const double factor = square / (compliance + softness);
    sum.energy += energy[l];
    sum.missing += softness / (2 + softness) * energy[l];
    if (!step.moves) continue;
    for_each_component([&](std::size_t row, double f) {
      const double way = factor * step.inverse_mass[row] * f;
      position[row] += way;
      if (step.velocity) step.velocity[row] += way / step.dt;
    });
  }
  return sum;
}

/// False if a cell has an energy or a force that is not finite, which `error` then names.
bool are_finite(const suture_batch& batch, const std::array<double, lanes>& energy,
                suture_error& error) {
  for (Index l = 0; l < batch.valid; ++l) {
    double sum = energy[l];
    for (Index i = 0; i < batch.nodes * 3; ++i) sum += std::abs(batch.force[i * lanes + l]);
    if (std::isfinite(sum)) continue;
    error.cell = batch.cell_ids[l];
    std::snprintf(error.text, sizeof error.text, "its energy or a force is not finite");
    return false;
  }
  return true;
}

/// Velocities of the nodes of a batch that stands still.
alignas(64) constexpr double at_rest[8 * 3 * lanes] = {};

/// Moves the nodes by the part of the forces of a batch that its velocities give.
suture_status project_viscosity(const ForceLoop::Projection& step, const loops::Job& job,
                                const loops::Worker& worker, suture_batch& batch,
                                const loops::BatchRows& rows, double* position) {
  ForceLoop::Projection viscous_step = step;
  viscous_step.compensates = false;
  const std::size_t numbers = std::size_t{job.node_count} * 3 * lanes;
  const double* const velocity = batch.velocity;
  batch.force = worker.results_end - numbers;
  suture_status status = job.function(worker.context, &batch);
  if (status != SUTURE_OK) return status;
  std::array<double, 8 * 3 * lanes> viscous;
  std::copy_n(batch.force, numbers, viscous.begin());
  batch.velocity = at_rest;
  status = job.function(worker.context, &batch);
  if (status != SUTURE_OK) return status;
  std::array<double, lanes> energy{};
  for (std::size_t i = 0; i < numbers; ++i) {
    viscous[i] -= batch.force[i];
    energy[i % lanes] -= step.dt / 2 * viscous[i] * velocity[i];
  }
  batch.force = viscous.data();
  if (!are_finite(batch, energy, *worker.context->error)) return SUTURE_RETRY;
  move_nodes(viscous_step, job, rows, batch.force, energy, position);
  return status;
}

}  // namespace

const std::vector<std::vector<loops::BatchRows>>& ForceLoop::Impl::independent_batches(
    Index number, const loops::Job& job) {
  if (independent.empty()) independent.resize(functors.size());
  auto& of_functor = independent[number];
  const BatchList& list = functors[number].list();
  for (Index chunk = static_cast<Index>(of_functor.size()); chunk < list.chunk_count(); ++chunk) {
    IndependentBatches batches;
    for (const loops::Rows& range : list.ranges(chunk))
      for (Index row = range.begin; row < range.end; ++row)
        if (!job.live || (job.live[row / lanes] >> row % lanes & 1) != 0)
          batches.add(row, {nodes_of(job, row), job.node_count});
    of_functor.push_back(batches.take());
  }
  return of_functor;
}

ForceLoop::Softness ForceLoop::Impl::project(Index number, const Projection& step) {
  CompiledFunctor& functor = functors[number];
  const suture_energy_1& stored = *stored_energy(functor);
  const LiveMask& live = awake(functor);
  double* const position = attributes.position().rows();
  const bool is_viscous = step.velocity && (functor.reads() & SUTURE_READ_VELOCITY) != 0;
  const auto& batches = independent_batches(
      number,
      functor.job(attributes, *complex, functor.cells().live(), step.time, step.dt, position));
  std::vector<Softness> of_chunk(batches.size());
  run(number, "force", live, step.time, step.dt, position,
      [&](const loops::Job& job, const loops::Worker& worker, std::span<const loops::Rows>,
          Index chunk) {
        const auto project = [&](suture_batch& batch, const loops::BatchRows& rows) {
          double* const energies = worker.more_results_end - lanes;
          suture_status status = stored.energy(worker.context, &batch, energies);
          if (status != SUTURE_OK) return status;
          std::array<double, lanes> energy;
          std::copy_n(energies, lanes, energy.begin());
          batch.force = worker.results_end - job.node_count * 3 * lanes;
          batch.velocity = at_rest;
          status = job.function(worker.context, &batch);
          if (status != SUTURE_OK) return status;
          if (!are_finite(batch, energy, *worker.context->error)) return SUTURE_RETRY;
          const Softness here = move_nodes(step, job, rows, batch.force, energy, position);
          of_chunk[chunk].energy += here.energy;
          of_chunk[chunk].missing += here.missing;
          return status;
        };
        const auto project_viscous = [&](suture_batch& batch, const loops::BatchRows& rows) {
          return project_viscosity(step, job, worker, batch, rows, position);
        };
        for (const loops::BatchRows& all : batches[chunk]) {
          const loops::BatchRows rows = awake_of(all, job.live);
          if (rows.valid == 0) continue;
          visit_batch(job, worker, rows, project);
          if (is_viscous) visit_batch(job, worker, rows, project_viscous);
        }
      });
  Softness sum;
  for (const Softness& part : of_chunk) {
    sum.energy += part.energy;
    sum.missing += part.missing;
  }
  return sum;
}

ForceLoop::Softness ForceLoop::project(const Projection& step) {
  Softness sum;
  for (Index i = 0; i < impl_->functors.size(); ++i) {
    if (impl_->functors[i].skipped()) continue;
    const Softness here = impl_->project(i, step);
    sum.energy += here.energy;
    sum.missing += here.missing;
  }
  impl_->raise_failures(step.time);
  return sum;
}

std::string ForceLoop::without_projection() const {
  for (const CompiledFunctor& functor : impl_->functors) {
    if (functor.skipped() || stored_energy(functor)) continue;
    if ((functor.instance().model().flags & SUTURE_ACTIVE) != 0)
      return functor.title() + " is active: its forces have no energy";
    if (functor.reads_field())
      return functor.title() + " reads a field, with which its energy changes";
    return functor.title() + " has no energy (suture.energy/1)";
  }
  return "";
}

}  // namespace suture
