// SPDX-License-Identifier: GPL-3.0-or-later
//
// What functions read: what they declare, and states that have no result.
#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/model_check/checks.hpp"

namespace suture::checks {
namespace {

using Values = AlignedVector<double>;

/// The same batch with other values of what the functor does not declare.
CellBatch with_other_undeclared(const CellBatch& batch, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  CellBatch out = batch;
  const auto replace = [&](std::uint32_t read, Values& values) {
    if ((batch.functor->reads & read) == 0)
      for (double& x : values) x = between(random, -1, 1);
  };
  replace(SUTURE_READ_REST, out.rest);
  replace(SUTURE_READ_POSITION, out.position);
  replace(SUTURE_READ_VELOCITY, out.velocity);
  for (auto& id : out.ids) id += 1000;
  return out;
}

struct BadState {
  const char* name;
  CellBatch batch;
};

std::vector<BadState> bad_states_of(const CellBatch& batch) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<BadState> states;
  const auto add = [&](const char* name, auto change) {
    states.push_back({name, batch});
    change(states.back().batch.position);
  };
  add("all nodes in one place", [](Values& x) { std::ranges::fill(x, 0); });
  add("an inverted cell", [&](Values& x) {
    for (std::size_t n = 0; n < batch.nodes(); ++n)
      for (std::size_t l = 0; l < SUTURE_LANES; ++l) x[CellBatch::place(n, 0, l)] *= -1;
  });
  add("a node that is infinitely far away", [&](Values& x) { x[x.size() - 1] = infinity; });
  add("a node whose position is not a number", [](Values& x) { x[2] = std::nan(""); });
  add("a cell of 1e200 m", [](Values& x) {
    for (double& value : x) value *= 1e200;
  });
  return states;
}

}  // namespace

Result declared_inputs(const BatchCase& of) {
  BatchCaller caller(of.instance);
  const CellBatch other = with_other_undeclared(of.batch, of.seed);
  const Values expected = caller.force(of.batch).force, found = caller.force(other).force;
  return compare(of.batch, found, expected, largest(expected),
                 "with other values of what the functor does not declare, the force");
}

Result bad_states(const BatchCase& of) {
  if ((of.batch.functor->reads & SUTURE_READ_POSITION) == 0) return {};
  BatchCaller caller(of.instance);
  for (const BadState& state : bad_states_of(of.batch)) {
    CellForces out;
    if (caller.try_force(state.batch, out) != SUTURE_OK) continue;
    const auto bad = std::ranges::find_if_not(out.force, [](double x) { return std::isfinite(x); });
    if (bad != out.force.end())
      throw BrokenLaw(std::string("with ") + state.name + ", the force on " +
                      place_text(of.batch, static_cast<std::size_t>(bad - out.force.begin())) +
                      " is not finite, but the function returns SUTURE_OK");
  }
  return Measured{};
}

}  // namespace suture::checks
