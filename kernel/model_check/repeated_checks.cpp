// SPDX-License-Identifier: GPL-3.0-or-later
//
// Calls that are repeated: by several threads, in several steps, for a while.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <thread>

#include "kernel/model_check/checks.hpp"

namespace suture::checks {
namespace {

constexpr unsigned thread_count = 4;
using Values = AlignedVector<double>;

/// Another batch of the functor: the cells a little further deformed.
CellBatch another(const CellBatch& batch, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  CellBatch out = batch;
  for (double& x : out.position) x += between(random, -1e-3, 1e-3);
  for (double& v : out.velocity) v *= 1.5;
  return out;
}

bool same(const CellForces& a, const CellForces& b) {
  return a.force == b.force && a.trial == b.trial;
}

/// Alternates between two batches; whether every result has the bits of the first one.
bool repeats(BatchCaller caller, const CellBatch (&batches)[2], const CellForces (&expected)[2],
             unsigned first) {
  for (unsigned i = 0; i < 200; ++i) {
    const unsigned which = (first + i) % 2;
    if (!same(caller.force(batches[which]), expected[which])) return false;
  }
  return true;
}

/// The states after `steps` steps that take `time` s together; other columns are empty. `moving`:
/// the cells are deformed by equal parts in each step, from rest to where they are in the batch.
std::vector<Values> states_after(BatchCaller& caller, CellBatch batch, int steps, double time,
                                 bool moving = false) {
  batch.dt = time / steps;
  std::vector<Values> states;
  const Values end = batch.position;
  for (int i = 0; i < steps; ++i) {
    if (moving)
      for (std::size_t n = 0; n < end.size(); ++n)
        batch.position[n] = batch.rest[n] + (end[n] - batch.rest[n]) * (i + 1) / steps;
    states = caller.force(batch).trial;
    for (std::size_t c = 0; c < states.size(); ++c)
      if (!states[c].empty()) batch.cell_columns[c] = states[c];
    batch.time += batch.dt;
  }
  return states;
}

double largest_difference(const std::vector<Values>& a, const std::vector<Values>& b) {
  double difference = 0;
  for (std::size_t c = 0; c < b.size(); ++c)
    for (std::size_t i = 0; i < b[c].size(); ++i)
      difference = std::max(difference, std::abs(a[c][i] - b[c][i]));
  return difference;
}

double largest_of(const std::vector<Values>& columns) {
  double value = 0;
  for (const Values& column : columns) value = std::max(value, largest(column));
  return value;
}

/// At one deformation, a step without duration may take a state to where a law without rates has
/// it, and the next one must leave it there. A state that goes a part of the way in each step,
/// whatever dt is, gets there in the end with any steps: halving them does not show it.
void require_no_change_without_time(BatchCaller& caller, const CellBatch& batch) {
  const std::vector<Values> once = states_after(caller, batch, 1, 0),
                            twice = states_after(caller, batch, 2, 0);
  const double first = largest_difference(batch.cell_columns, once),
               second = largest_difference(once, twice);
  if (!(second > 0.01 * first + 1e-9 * largest_of(twice))) return;
  std::ostringstream text;
  text << "a second step of dt = 0 at the same deformation changes the state by " << second
       << ", the first by " << first
       << "; a state goes a part of the way in each step, however short: multiply its rate by dt";
  throw BrokenLaw(text.str());
}

}  // namespace

Result repetition(const BatchCase& of) {
  of.instance.set_workers(thread_count + 1);
  BatchCaller caller(of.instance);
  const CellBatch batches[2] = {of.batch, another(of.batch, of.seed)};
  const CellForces expected[2] = {caller.force(batches[0]), caller.force(batches[1])};
  if (!repeats(caller, batches, expected, 0))
    throw BrokenLaw(
        "the same batch gives another force in a later call; keep nothing between "
        "calls");
  bool good[thread_count] = {};
  {
    std::vector<std::jthread> threads;
    for (unsigned t = 0; t < thread_count; ++t)
      threads.emplace_back([&, t] {
        try {
          good[t] = repeats(BatchCaller(of.instance, t + 1), batches, expected, t);
        } catch (const std::exception&) {  // the same states were accepted before
          good[t] = false;
        }
      });
  }
  if (!std::ranges::all_of(good, [](bool g) { return g; }))
    throw BrokenLaw(
        "the same batch gives another force while other threads compute other "
        "batches; use no static or global variables");
  return Measured{};
}

// The state after a time must not depend on the number of steps: halved steps change it less and
// less.
Result state(const BatchCase& of) {
  BatchCaller caller(of.instance);
  const CellForces once = caller.force(of.batch);
  if (std::ranges::all_of(once.trial, [](const Values& t) { return t.empty(); })) return {};
  require_no_change_without_time(caller, of.batch);
  std::vector<Values> after[3];
  for (int i = 0; i < 3; ++i) after[i] = states_after(caller, of.batch, 8 << i, 0.01);
  const double coarse = largest_difference(after[0], after[1]),
               fine = largest_difference(after[1], after[2]);
  if (fine <= 1e-9 * largest_of(after[2])) return Measured{};
  return Measured{fine / coarse,
                  "halving the steps changes the state by this part of what the previous halving "
                  "changed; a state that follows time gives 0.5 or less"};
}

// Along a path on which the strain changes, a state whose strain is taken as constant within a step
// has an error of the first order: halved steps halve it. An error of the second order falls to a
// quarter. Both are sound; the text tells them apart.
Result order(const BatchCase& of) {
  BatchCaller caller(of.instance);
  const CellForces once = caller.force(of.batch);
  if (std::ranges::all_of(once.trial, [](const Values& t) { return t.empty(); })) return {};
  if (of.batch.rest.size() != of.batch.position.size()) return {};
  std::vector<Values> after[3];
  for (int i = 0; i < 3; ++i) after[i] = states_after(caller, of.batch, 16 << i, 0.01, true);
  const double coarse = largest_difference(after[0], after[1]),
               fine = largest_difference(after[1], after[2]);
  if (fine <= 1e-9 * largest_of(after[2])) return Measured{0, "no change with the step"};
  char text[160];
  std::snprintf(
      text, sizeof text, "order %.2g in the length of a step%s", std::log2(coarse / fine),
      fine > 0.35 * coarse ? "; a strain that is linear within a step gives 2 (docs/sdk.md)" : "");
  return Measured{fine / coarse, text};
}

Result speed(const BatchCase& of) {
  BatchCaller caller(of.instance);
  CellForces out = outputs_of(of.batch, of.instance.model(), 0);
  BatchView view(of.batch);
  view.write_to(out);
  const auto seconds_of = [&](int calls) {
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    caller.call("force", of.batch, view.batch(),
                [&](const suture_context* context, const suture_batch* batch) {
                  suture_status status = SUTURE_OK;
                  for (int i = 0; i < calls && status == SUTURE_OK; ++i)
                    status = of.batch.functor->force(context, batch);
                  return status;
                });
    return std::chrono::duration<double>(Clock::now() - begin).count();
  };
  // As many as the clock needs: builds for debugging may take a thousand times as long.
  int calls = 1;
  while (calls < 2048 && seconds_of(calls) < 1e-3) calls *= 2;
  double best = 1e9;
  for (int round = 0; round < 5; ++round)
    best = std::min(best, 1e9 * seconds_of(calls) / (calls * SUTURE_LANES));
  char text[64];
  std::snprintf(text, sizeof text, "%.3g ns per cell", best);
  return Measured{best, text};
}

}  // namespace suture::checks
