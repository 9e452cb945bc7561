// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/steps/step_control.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "kernel/base/box.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/base/saturate.hpp"
#include "kernel/dynamics/motion.hpp"
#include "kernel/forces/contact_law.hpp"
#include "kernel/implicit/newton.hpp"
#include "kernel/results/evidence.hpp"
#include "kernel/steps/free_bodies.hpp"

namespace suture {
namespace {

// Steps between checks of energy and inversion, which then cost 1 % of the forces.
constexpr std::uint64_t guard_steps = 64;
// Energy from nowhere, as a part of what was exchanged, that is worth a word. Right runs stay
// below 0.014.
constexpr double notable_growth = 0.02;
// The balance of the whole run, either way; sudden loads reach some per cent at a safety of 0.8.
constexpr double notable_balance = 0.1;
// How often a step is halved before it is given up, and attempts to pass a place where
// elements or models fail, which a smaller step may not help.
constexpr unsigned max_halvings = 10, max_attempts = 2;
// More frames than these are not held back: the state is kept sooner.
constexpr std::size_t frames_held = 2;

/// The diagonal of the box around the body at rest, m.
double size_of(Body& body) {
  Box box = no_box;
  const Column& rest = body.attributes().rest();
  for (Index v = 0; v < rest.size(); ++v)
    if (body.complex().exists(0, v)) include(box, {rest.get(v, 0), rest.get(v, 1), rest.get(v, 2)});
  return std::hypot(box.length(0), box.length(1), box.length(2));
}

}  // namespace

StepControl::StepControl(const Scene& scene, BuiltScene& built, Recorder& recorder,
                         EventSchedule& schedule, EventRunner& events, Clock clock,
                         Diagnostics& diagnostics)
    : scene_(scene),
      built_(built),
      recorder_(recorder),
      schedule_(schedule),
      events_(events),
      diagnostics_(diagnostics),
      clock_(std::move(clock)),
      guard_(built, diagnostics),
      watch_(scene, built, diagnostics),
      error_(built.dynamics().motion(), error_constant(scene.solver.integrator)) {
  if (scene.solver.step_error) accuracy_.emplace(*scene.solver.step_error, size_of(built.body()));
}

void StepControl::start() {
  watch_.start();
  guard_.start();
  if (accuracy_) accuracy_->start(error_.time_to_move(accuracy_->tolerated()));
}

double StepControl::next_dt() {
  clock_.divide(watch_.halvings());
  const double accurate = accuracy_ ? accuracy_->wanted() : watch_.wanted();
  const double stable = std::min(watch_.wanted(), accurate);
  const ContactLaw* contact = built_.body().contact();
  return contact ? clock_.next_dt(stable, contact->next_change(clock_.reached_until()))
                 : clock_.next_dt(stable);
}

void StepControl::after_event() {
  commit();
  watch_.after_event(clock_.step());
}

void StepControl::after_jump() {
  commit();
  watch_.after_jump(clock_.step());
  guard_.after_jump();
}

void StepControl::commit() {
  recorder_.release(clock_.step());
  kept_.forget(clock_.step());
}

// -------------------------------------------------------------------- steps --

void StepControl::step(const Notify& notify) {
  if (kept_.keep_if_due(clock_.step(), clock_.time(), *this, recorder_.frames_held() > frames_held))
    recorder_.release(kept_.older().step);
  try {
    make_step();
    check_step(notify);
  } catch (const NumericalError& error) {
    roll_back(error, notify);
  }
}

void StepControl::balance() {
  try {
    step_body(0);
  } catch (const NumericalError& error) {
    give_up(error);
  }
}

/// Only while a step is made may it be given up: what solves equations between steps changes the
/// state of the solver.
void StepControl::step_body(double dt) {
  struct Asking {
    Newton* newton;
    ~Asking() {
      if (newton) newton->is_abandoned = {};
    }
  };
  const Asking asking{built_.dynamics().newton()};
  if (asking.newton) asking.newton->is_abandoned = is_abandoned;
  built_.dynamics().step(dt, clock_.time());
}

void StepControl::make_step() {
  if (accuracy_)
    make_accurate_step();
  else
    make_one_step();
}

void StepControl::make_one_step() {
  const double dt = next_dt();
  if (!(dt > 0))
    throw NumericalError("the stable step is " + std::to_string(dt) +
                         " s, so the run cannot continue");
  clock_.advance();
  // And not the difference of two times: forces stay good while dt is the same.
  const double before = std::exchange(last_dt_, dt);
  try {
    step_body(dt);
  } catch (const Error&) {
    throw;         // roll_back() decides
  } catch (...) {  // of a term from outside, or the step was given up: the run may go on
    if (built_.dynamics().time() < clock_.time()) {
      clock_.undo_advance();
      last_dt_ = before;
    }
    throw;
  }
}

/// Repeats the step until its error is within the tolerance. Only the last attempt leaves a trace.
void StepControl::make_accurate_step() {
  before_.save(*this);
  error_.begin();
  try {
    while (!try_accurate_step()) continue;
  } catch (const StepAbandoned&) {
    before_.load(*this);
    throw;
  }
}

/// False if the step has to be repeated, from the state at its start.
bool StepControl::try_accurate_step() {
  const double start = clock_.time();
  StepError error;
  try {
    make_one_step();
    error = error_.measure(last_dt_);
    const bool accepted = accuracy_->accepts(error, last_dt_);
    std::ostringstream judgement;
    judgement << "error " << accuracy_->error() << " of the tolerance";
    tell_step(start, (accepted ? "" : "rejected: ") + judgement.str());
    if (accepted) return true;
  } catch (const StepRejected& rejected) {
    if (!built_.dynamics().is_implicit()) throw;
    tell_step(start, std::string("rejected: ") + rejected.what());
    accuracy_->shorten(last_dt_, rejected.step_factor);
    if (accuracy_->is_stuck(start)) throw InaccurateStep(rejected.what(), rejected.element);
  }
  const StepAccuracy judged = *accuracy_;
  before_.load(*this);
  accuracy_ = judged;
  if (accuracy_->is_stuck(clock_.time())) refuse_step(error);
  return false;
}

void StepControl::tell_step(double start, const std::string& judgement) const {
  if (!on_detail) return;
  std::ostringstream text;
  text << "step of " << last_dt_ << " s, " << judgement;
  on_detail(timed(start, text.str()));
}

void StepControl::refuse_step(const StepError& step) {
  const Index element = element_of(built_.body().complex().dart_of(0, step.vertex));
  std::ostringstream text;
  text << "no step is short enough: after " << accuracy_->rejections()
       << " rejections in succession, a step of " << last_dt_ << " s has an error of " << step.error
       << " m, and " << accuracy_->tolerated() << " m are tolerated (/solver/step_error is "
       << *scene_.solver.step_error << "); the error is largest at element "
       << built_.element_name(element) << ", " << built_.place_of(element);
  throw InaccurateStep(text.str());
}

void StepControl::check_contact() const {
  const ContactLaw* contact = built_.body().contact();
  const std::optional<ContactLaw::Failure> failure = contact ? contact->failure() : std::nullopt;
  if (!failure) return;
  const auto element = [&](Index vertex) {
    return built_.element_name(element_of(built_.body().complex().dart_of(0, vertex)));
  };
  std::ostringstream text;
  text << "contact did not hold: the pieces of elements " << element(failure->vertices[0])
       << " and " << element(failure->vertices[1]) << " are " << failure->depth
       << " m in each other (" << failure->depth / contact->mean_edge() << " of a typical edge)";
  throw UnstableStep(text.str());
}

void StepControl::check_step(const Notify& notify) {
  check_contact();
  if (watch_.is_alarming(clock_.step()) && watch_.is_unstable(clock_.step(), last_dt_)) {
    const Index vertex = built_.dynamics().motion().fastest_vertex();
    const Index element = element_of(built_.body().complex().dart_of(0, vertex));
    std::ostringstream text;
    text << "the step is unstable: the motion reaches omega dt = "
         << built_.dynamics().motion().sums().apparent_frequency()
         << " (the limit is 2) at element " << built_.element_name(element) << ", "
         << built_.place_of(element);
    throw UnstableStep(text.str());
  }
  if (clock_.step() % guard_steps == 0) check_state(notify);
  if (watch_.halvings() > 0 && clock_.time() <= latest_failure_time_) watch_.stay(clock_.step());
  watch_.after_step(clock_.step());
}

/// Throws for numbers that are wrong; energy that grows slowly is reported.
void StepControl::check_state(const Notify& notify) {
  guard_.check(clock_.step(), clock_.time());
  if (built_.dynamics().is_implicit()) return;  // growth cannot come from the step
  const double last_growth = std::exchange(last_growth_, guard_.growth());
  if (guard_.growth() <= notable_growth) return;
  std::ostringstream text;
  text << 100 * guard_.growth() << " % of the energy exchanged is unexplained";
  if (watch_.is_unstable(clock_.step(), last_dt_))
    throw UnstableStep("the step is unstable: " + text.str());
  if (guard_.growth() - last_growth > notable_growth / 2 && should_retry_smaller()) {
    last_growth_ = last_growth;
    throw UnstableStep(text.str());
  }
  guard_.forgive_growth();
  last_growth_ = 0;
  const std::string growth = timed(clock_.time(), text.str());
  if (watch_.lower_safety()) {
    notify(growth + "; dt is half the stable step from now on");
  } else if (!growth_was_reported_) {
    growth_was_reported_ = true;
    diagnostics_.warn(growth +
                      " although the step is stable: it is too coarse for this motion, or a model "
                      "adds energy that its suture.energy/1 does not include; reduce " +
                      step_setting() +
                      " to find out which (the balance in energies.csv decreases with its square)");
  }
}

/// "newmark" refuses contact, budgets and fields that are solved in turns with the motion.
bool StepControl::may_use_newmark() const {
  const auto takes_turns = [](const FieldEquation& equation) {
    return equation.field().rate || equation.field().relaxation;
  };
  return !built_.body().contact() && !scene_.solver.budget &&
         std::ranges::none_of(built_.body().fields(), takes_turns);
}

std::string StepControl::balance_warning() const {
  const double open = guard_.open_balance();
  if (!built_.dynamics().has_balance() || !(std::abs(open) > notable_balance)) return "";
  std::ostringstream text;
  text << "the energy balance closes only to " << 100 * open << " % of the energy exchanged: ";
  if (scene_.solver.integrator == "implicit-euler")
    text << "implicit Euler damps motion that its steps do not follow; "
         << (may_use_newmark() ? "set /solver/integrator to \"newmark\", or " : "") << "reduce ";
  else
    text << "the step is stable, but too coarse for a sudden load or motion; reduce ";
  text << step_setting();
  return text.str();
}

/// What a scene reduces to make shorter steps.
const char* StepControl::step_setting() const {
  if (scene_.solver.step_error) return "/solver/step_error";
  if (scene_.solver.softness) return "/solver/softness";
  const bool is_fixed = scene_.solver.dt || built_.dynamics().is_implicit();
  return is_fixed ? "/solver/dt" : "/solver/safety";
}

/// Energy grew between two checks, though the step is stable now: a wave broke, or an element
/// snapped through. Each place is tried twice with smaller steps.
bool StepControl::should_retry_smaller() {
  if (scene_.solver.dt || kept_.empty() || watch_.halvings() >= max_halvings) return false;
  growth_attempts_ = clock_.time() <= latest_growth_time_ ? growth_attempts_ + 1 : 1;
  latest_growth_time_ = std::max(latest_growth_time_, clock_.time());
  return growth_attempts_ <= max_attempts;
}

bool StepControl::try_check(const std::function<void()>& check, const Notify& notify) {
  try {
    check();
    return true;
  } catch (const NumericalError& error) {
    roll_back(error, notify);
    return false;
  }
}

/// Without an earlier state, the same one would follow.
void StepControl::take_back(const NumericalError& error, const Notify& notify) {
  if (kept_.empty()) give_up(error);
  roll_back(error, notify);
}

bool StepControl::check_last_state(const Notify& notify) {
  return try_check([&] { check_state(notify); }, notify);
}

// -------------------------------------------------------------------- steps back --

/// Goes back to the older state that is kept, with a smaller step; throws what is final.
void StepControl::roll_back(const NumericalError& error, const Notify& notify) {
  const auto* rejected = dynamic_cast<const StepRejected*>(&error);
  const bool unstable = dynamic_cast<const UnstableStep*>(&error) != nullptr;
  const double failed_at = clock_.time();
  const bool same_place = failed_at <= latest_failure_time_ + 64 * last_dt_;
  attempts_ = same_place ? attempts_ + 1 : 1;
  latest_failure_time_ = std::max(latest_failure_time_, failed_at);
  if (dynamic_cast<const InaccurateStep*>(&error) != nullptr) give_up(error);
  const bool may_help = rejected || (!scene_.solver.dt && (unstable || attempts_ <= max_attempts));
  // Right after an operation the run continues from here: a step that a model rejects has moved
  // nothing yet, and the energy of an unstable one is in the balance.
  const bool implicit = built_.dynamics().is_implicit();
  const bool continues_here =
      built_.dynamics().is_whole() && ((rejected && (kept_.empty() || implicit)) ||
                                       (kept_.empty() && unstable && !scene_.solver.dt));
  if (!may_help || (kept_.empty() && !continues_here) || watch_.halvings() >= max_halvings)
    give_up(error);
  if (!continues_here)
    restore(kept_.take_older());
  else if (built_.dynamics().time() < clock_.time())
    clock_.undo_advance();
  const double factor = rejected ? rejected->step_factor : 0.5;
  const auto halvings = saturate<unsigned>(std::ceil(-std::log2(factor) - 1e-9));
  watch_.roll_back(clock_.step(), std::min(halvings, max_halvings));
  if (accuracy_) accuracy_->shorten(last_dt_, factor);
  std::ostringstream text;
  text << timed(failed_at, error.what());
  if (continues_here && implicit)
    text << "; tried again with dt = " << next_dt() << " s";
  else if (continues_here)
    text << "; an operation cannot be undone, so dt is " << next_dt() << " s from here on";
  else
    text << "; rolled back to " << time_text(clock_.time()) << " with dt = " << next_dt() << " s";
  notify(text.str());
  ++rollbacks_;
}

void StepControl::restore(const KeptStates::State& kept) {
  kept.buffer.load(*this);
  events_.roll_back(clock_.time());
  recorder_.roll_back(clock_.step());
}

/// The element with this number of the user, or its copies, if a blade has divided it.
std::vector<Index> StepControl::elements_now(std::uint64_t number) const {
  const Selector& selector = built_.selector();
  if (number == NumericalError::nowhere || selector.element_with_id(number) == none) return {};
  return selector.elements_now({Selection::Ids{{number}}, ""},
                               built_.body().attributes().position().rows());
}

void StepControl::give_up(const NumericalError& error) {
  std::ostringstream text;
  text << "step " << clock_.step() << ", " << timed(clock_.time(), error.what());
  const std::vector<Index> elements = elements_now(error.element);
  if (!elements.empty()) text << "; the element is at " << built_.place_of(elements.front());
  failed_piece_ = find_failed_piece(
      built_, events_.debris(),
      guard_.fatal_element() != none ? std::vector{guard_.fatal_element()} : elements);
  if (failed_piece_)
    failed_piece_->good_step =
        kept_.empty() ? std::max<std::uint64_t>(clock_.step(), 1) - 1 : kept_.older().step;
  Evidence evidence(built_, clock_.time());
  if (kept_.empty()) {
    recorder_.roll_back(clock_.step() - 1);
  } else {
    const KeptStates::State& good = kept_.take_older();
    const Clock failed = clock_;
    good.buffer.load(*this);
    clock_ = failed;
    recorder_.roll_back(good.step);
    evidence.add_last_good(built_, good.time);
    if (scene_.solver.dt) watch_.search_for_report();
  }
  text << ". " << (failed_piece_ ? failed_piece_->advice() : advice(error));
  if (dynamic_cast<const NotFinite*>(&error) != nullptr)
    text << ". If a plugin may be at fault, `suture run --check-plugins` names the one whose "
            "results are not finite or never set";
  if (scene_.output.enabled) text << ". " << evidence.write(recorder_.folder());
  throw NumericalError(text.str());
}

void StepControl::state(Archive& archive) {
  const bool is_kept = !archive.loads() && !archive.has_cells();
  if (is_kept && scene_.checkpoint.enabled)  // which may have this state in it, with all rows
    built_.body().attributes().gather_motion();
  archive("clock", clock_);
  archive("schedule", schedule_);
  archive("dynamics", built_.dynamics());
  if (accuracy_) archive("accuracy", *accuracy_);
  if (!archive.has_cells()) return archive.group("events", [&] { events_.motion(archive); });
  archive("limits", built_.limits());
  archive("guard", guard_);
  archive("watch", watch_);
  archive("kept", kept_);
  archive("last dt", last_dt_);
  archive("furthest failure", latest_failure_time_);
  archive("attempts", attempts_);
  archive("last growth", last_growth_);
  archive("furthest growth", latest_growth_time_);
  archive("growth attempts", growth_attempts_);
  archive("growth was reported", growth_was_reported_);
  archive("steps back", rollbacks_);
}

/// What fits the scene, and is not in it yet.
std::string StepControl::advice(const NumericalError& error) const {
  const bool may_be_loose = built_.dynamics().is_static() && built_.body().contact();
  const std::string loose = may_be_loose ? describe_body_without_constraints(built_) : "";
  if (!loose.empty())
    return "Constraints do not hold all pieces: " + loose +
           ", unless contact holds it; let it touch what holds it from the start, with friction "
           "or constraints against motions that are left, or replace /solver/static by an "
           "integrator";
  if (dynamic_cast<const Unsettled*>(&error) != nullptr)
    return "Another material does not help: give more \"frames\" in /solver/static, refine the "
           "mesh "
           "there, round sharp edges of the obstacle, or reduce the friction";
  if (built_.dynamics().is_static() && built_.body().contact())
    return "Reduce the loads or motions, or refine the mesh there; where the body slides off an "
           "obstacle or snaps through, there is no equilibrium nearby: replace /solver/static by "
           "an integrator with damping";
  if (built_.dynamics().is_static())
    return "Reduce the loads or motions, refine the mesh there, or choose another law: some have "
           "no equilibrium beyond a limit (St Venant-Kirchhoff softens below a stretch of 0.58)";
  if (!built_.dynamics().is_whole() && kept_.empty())
    return "The end of a step was refused right after an operation, which cannot be undone, so no "
           "smaller step was tried: reduce " +
           std::string(step_setting());
  std::ostringstream text;
  if (dynamic_cast<const InaccurateStep*>(&error) != nullptr)
    return "Ramp loads and motions that begin suddenly there, check the parameters of the model, "
           "or increase /solver/step_error";
  if (scene_.solver.dt && !(*scene_.solver.dt < watch_.stable())) {
    text << "/solver/dt is " << *scene_.solver.dt << " s";
    if (watch_.stable() > 0)
      text << ", and the stable step of the last good state is about " << watch_.stable() << " s";
    text << ": reduce it, or set it to \"auto\"";
    return text.str();
  }
  if (scene_.solver.dt && dynamic_cast<const StepRejected*>(&error) == nullptr)
    return "Set /solver/dt to \"auto\", which tries smaller steps; if that fails too, the load "
           "exceeds the range of the material law or the mesh";
  text << "Smaller steps do not help: ";
  if (guard_.fatal_element() != none) {
    text << "the load exceeds the range of the material law or the mesh. Reduce or ramp it, refine "
            "the mesh there, choose another model, ";
    const std::string stiffer = stiffer_element(built_, guard_.fatal_element());
    if (!stiffer.empty()) text << "set " << stiffer << ", ";
    text << "or set on_inversion of the model to \"warn\"";
  } else {
    text << "reduce or ramp the loads, or check the parameters of the model there";
  }
  return text.str();
}

}  // namespace suture
