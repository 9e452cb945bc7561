// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/ending.hpp"

#include <sstream>
#include <utility>

#include "kernel/base/error.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/implicit/newton.hpp"
#include "kernel/steps/free_bodies.hpp"

namespace suture {
namespace {

constexpr std::uint64_t rest_step_limit = 10'000'000;
// An eigenvalue of the tangent below this multiple of the mean may be zero and is computed closely.
// A cantilever of 100 x 8 x 8 elements with a slenderness of 50 has 1e-9.
constexpr double small_eigenvalue = 1e-8;

}  // namespace

Ending::Ending(BuiltScene& built, const EventSchedule& schedule, StepControl& control,
               Recorder& recorder, Diagnostics& diagnostics)
    : built_(built),
      scene_(built.scene()),
      control_(control),
      diagnostics_(diagnostics),
      stability_(scene_, built, recorder, diagnostics) {
  built.body().add_follower(*this);
  cells_changed_ = scene_.solver.hold_free_pieces;  // reports those of the mesh, too
  if (!scene_.solver.until_rest) return;
  rest_.emplace(scene_.solver.tolerance, scene_.solver.automatic_damping);
  rest_->wait_until(schedule.last_change());
}

std::optional<RunSummary::Outcome> Ending::check(const StepControl::Notify& notify) {
  const Clock& clock = control_.clock();
  check_pieces(notify);
  if (clock.finished()) {
    if (!control_.check_last_state(notify)) return std::nullopt;
    if (rest_) warn_of_motion();
    return built_.dynamics().is_static() ? examine_equilibrium() : Outcome::finished;
  }
  if (rest_ && clock.step() > 0)
    if (const auto outcome = check_rest(notify)) return outcome;
  const std::uint64_t limit = scene_.solver.max_steps ? scene_.solver.max_steps
                              : rest_                 ? rest_step_limit
                                                      : 0;
  if (limit != 0 && clock.step() >= limit) fail_at_step_limit(limit);
  return std::nullopt;
}

/// The last equilibrium of a static run.
RunSummary::Outcome Ending::examine_equilibrium() {
  const Clock& clock = control_.clock();
  if (clock.step() == 0) return Outcome::finished;
  const Newton::TangentCheck check = built_.dynamics().newton()->check_tangent(clock.time());
  const bool may_be_neutral = check.lowest < small_eigenvalue && !built_.body().contact();
  if (!check.is_indefinite && !may_be_neutral) return Outcome::finished;
  const auto verdict =
      stability_.examine(0, clock.step(), clock.time(), built_.body().acceleration(clock.time()));
  return verdict == Stability::Verdict::unstable ? Outcome::unstable_equilibrium
                                                 : Outcome::finished;
}

void Ending::warn_of_motion() {
  std::ostringstream text;
  text << "not at rest at /solver/end, " << time_text(control_.clock().time())
       << ": the residual is " << rest_->residual() << ", requested " << rest_->tolerance();
  diagnostics_.warn(text.str());
}

/// An event may have cut a piece off that now falls for ever.
void Ending::require_supported() {
  cells_changed_ = false;
  const std::string body = describe_falling_body(scene_, built_);
  if (!body.empty())
    throw NumericalError("the body cannot come to rest: " + body +
                         "; remove it (remove_islands), constrain it, or give /solver/end");
}

/// An event may have cut a piece off that nothing holds.
void Ending::check_pieces(const StepControl::Notify& notify) {
  if (!built_.dynamics().is_static() || !std::exchange(cells_changed_, false)) return;
  if (scene_.solver.hold_free_pieces) {
    for (const std::string& text : held_pieces_.added(built_))
      notify(timed(control_.clock().time(), text));
    return;
  }
  const std::string body = describe_unheld_body(built_);
  if (!body.empty())
    throw NumericalError(body +
                         ", so it has no equilibrium; remove it (remove_islands), constrain it, "
                         "set /solver/static/free_pieces to \"hold\", or replace /solver/static "
                         "by an integrator");
}

std::optional<RunSummary::Outcome> Ending::check_rest(const StepControl::Notify& notify) {
  if (cells_changed_ && !scene_.solver.end) require_supported();
  bool rests = false;
  if (!control_.try_check([&] { rests = rest_->at_rest(built_.dynamics()); }, notify))
    return std::nullopt;
  if (rests) {
    if (!control_.check_last_state(notify)) return std::nullopt;
    if (rest_->limited_by_rounding()) diagnostics_.warn(rest_->explanation(built_.dynamics()));
    return examine(notify);
  }
  if (rest_->stagnates() && !scene_.solver.end)
    throw NumericalError(rest_->explanation(built_.dynamics()));
  return std::nullopt;
}

/// None after a kick.
std::optional<RunSummary::Outcome> Ending::examine(const StepControl::Notify& notify) {
  const Clock& clock = control_.clock();
  const auto verdict = stability_.examine(rest_->unbalanced_force(), clock.step(), clock.time(),
                                          built_.body().acceleration(clock.time()));
  if (verdict == Stability::Verdict::kicked) {
    control_.commit();
    rest_->restart();
    return std::nullopt;
  }
  if (verdict == Stability::Verdict::stable) notify(stability_.text());
  return verdict == Stability::Verdict::unstable ? Outcome::unstable_equilibrium : Outcome::at_rest;
}

void Ending::fail_at_step_limit(std::uint64_t limit) const {
  std::ostringstream text;
  if (rest_)
    text << "not at rest after " << limit << " steps: the residual is " << rest_->residual()
         << ", requested " << rest_->tolerance() << "; raise /solver/max_steps"
         << (scene_.solver.automatic_damping ? " or /solver/tolerance"
                                             : ", /solver/tolerance or /solver/damping");
  else
    text << time_text(control_.clock().time()) << " after " << limit
         << " steps, and /solver/end is " << *scene_.solver.end << " s; raise /solver/max_steps"
         << (scene_.solver.dt ? " or dt" : "");
  throw NumericalError(text.str());
}

void Ending::state(Archive& archive) {
  archive("stability", stability_);
  archive("cells changed", cells_changed_);
  archive("held pieces", held_pieces_);
  if (rest_) archive("rest", *rest_);
}

}  // namespace suture
