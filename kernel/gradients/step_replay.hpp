// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "kernel/base/archive.hpp"
#include "kernel/dynamics/dynamics.hpp"

// Which states are kept
// =====================
//
//   step   0       4       8       12   13 14       at most six states: three of the run,
//   run    A       B       C       D             A  every fourth; it becomes every eighth when
//   back                           D    .  .     v  a fifth would be kept
//
// Backward, the steps between two states are made again, with the same bits. What is left of the
// limit holds states between them, placed so that no step is made more often than needed
// (Griewank and Walther, ACM Trans. Math. Softw. 26 (2000) 19: binomial checkpointing).

namespace suture {

/// The steps of a run since a state, which can be visited again, backward. Half of the
/// limit is for states of the run; without a limit, every state is kept and no step is made again.
class StepReplay {
 public:
  /// At most so many states, or so many bytes; at least two states.
  struct Limit {
    std::size_t states = unlimited, bytes = unlimited;
  };
  static constexpr std::size_t unlimited = static_cast<std::size_t>(-1);

  StepReplay(Dynamics& dynamics, Limit limit);

  struct Step {
    double start, end, dt;  ///< s
  };
  /// To be called after every step. O(vertices and states of models).
  void keep(const Step& step);
  std::size_t count() const { return steps_.size(); }
  const Step& step(std::size_t number) const { return steps_[number - 1]; }  ///< from 1 on

  /// Visits the last step (count()) first. visit(step): the body is in the state before the step,
  /// and may be changed. When it returns, the body is as before, and so are the bits of later
  /// steps.
  using Visit = std::function<void(std::size_t step)>;
  void backward(const Visit& visit);
  std::size_t repeated() const { return repeated_; }  ///< steps made again so far

 private:
  using States = std::map<std::size_t, StateBuffer>;  ///< by the number of steps before them
  class Return;
  std::size_t most() const;
  void keep_state();
  void advance(std::size_t from, std::size_t to);
  void go_before(std::size_t step, States& between);

  Dynamics& dynamics_;
  Limit limit_;
  std::vector<Step> steps_;
  States kept_;
  std::size_t spacing_ = 1, repeated_ = 0;
};

}  // namespace suture
