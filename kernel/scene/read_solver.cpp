// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <vector>

#include "kernel/dynamics/integrator.hpp"
#include "kernel/scene/scene_parts.hpp"

namespace suture::scene_parts {
namespace {

/// When the last load, motion and gravity have their full values, s.
double last_ramp(const Scene& scene) {
  double last = scene.gravity_ramp.to;
  for (const Load& load : scene.loads) last = std::max(last, load.ramp.to);
  for (const Constraint& constraint : scene.constraints) last = std::max(last, constraint.ramp.to);
  return last;
}

constexpr const char* statics = "static";
constexpr const char* xpbd = "xpbd";
constexpr double default_step_error = 1e-3, default_softness = 0.05;

/// "static": equilibria instead of motion, `frames` of them until the end.
void read_static(ObjectReader& object, const Scene& scene, SolverOptions& solver) {
  const JsonValue* value = object.find(statics);
  if (value == nullptr) return;
  for (const char* key : {"integrator", "dt", "step_error", "safety", "until", "kick", "damping",
                          "sleep", "tolerance", "budget", "softness", "compensate"})
    if (object.find(key) != nullptr)
      object.complain(key, "cannot be combined with \"static\"; remove one of them");
  ObjectReader reader(*value, object.path_of(statics), object.mistakes());
  const Limits part{"1", 0, 1, true, true};
  const auto frames = static_cast<double>(reader.natural("frames", 1).value_or(1));
  solver.step_tolerance = reader.number("tolerance", part).value_or(solver.step_tolerance);
  static const std::array<std::string, 2> choices{"refuse", "hold"};
  solver.hold_free_pieces = reader.choice("free_pieces", choices).value_or(0) == 1;
  static const std::array<std::string, 2> paths{"load-steps", "arc-length"};
  solver.follow_path = reader.choice("path", paths).value_or(0) == 1;
  if (solver.hold_free_pieces && solver.follow_path)
    reader.complain("path",
                    "cannot be combined with \"free_pieces\": \"hold\"; remove one of them");
  reader.finish();
  solver.integrator = statics;
  solver.end = object.number("end", Limits::positive("s"));
  if (!solver.end) solver.end = last_ramp(scene) > 0 ? last_ramp(scene) : 1;
  solver.dt = *solver.end / frames;
}

/// The names of the integrators of a kind that estimate the error of a step. None takes a budget.
std::string names_with_estimate(bool implicit) {
  std::string names;
  for (const std::string& name : integrator_names())
    if (error_constant(name) > 0 && is_implicit(name) == implicit)
      names += (names.empty() ? "\"" : " or \"") + name + '"';
  return names;
}

/// Steps of "auto" follow their error where a tolerance says so, and with implicit integrators,
/// for which any step is stable.
void read_step_error(ObjectReader& object, bool automatic, SolverOptions& solver) {
  constexpr double smallest = 1e-9;  // rounding of the positions
  const bool given = object.find("step_error") != nullptr,
             implicit = is_implicit(solver.integrator),
             has_choice = object.find("budget") == nullptr;
  if (given && !automatic)
    object.complain("step_error", "is only used with \"dt\": \"auto\"; remove it or the fixed dt");
  else if (error_constant(solver.integrator) > 0 && automatic && (given || implicit))
    solver.step_error =
        object.number("step_error", {"", smallest, 1, false, true}).value_or(default_step_error);
  else if (given)
    object.complain(
        "step_error",
        "needs an estimate of the error of a step, and \"" + solver.integrator + "\" has none; " +
            (has_choice ? "choose " + names_with_estimate(implicit) + ", or " : "") + "remove it");
  else if (automatic && implicit && solver.integrator != xpbd)
    object.complain("dt", "'dt' must be a number (s) for \"" + solver.integrator +
                              "\": any step is stable, so choose it by the accuracy that you need" +
                              (has_choice ? ", or choose " + names_with_estimate(implicit) +
                                                ", which can choose it itself"
                                          : ""));
}

/// Steps of position based dynamics, which leave out a part of the stiffness.
void read_softness(ObjectReader& object, SolverOptions& solver) {
  const auto given = object.number("softness", {"1", 0, 1, true, true});
  if (solver.integrator == xpbd && !solver.dt)
    solver.softness = given.value_or(default_softness);
  else if (given)
    object.complain("softness",
                    solver.integrator == xpbd
                        ? "is only used with \"dt\": \"auto\"; remove it or the fixed dt"
                        : "is only used by \"xpbd\"; remove it, or choose that");
}

/// Cells of position based dynamics that are stiffer by what their steps leave out.
void read_compensate(ObjectReader& object, SolverOptions& solver) {
  solver.compensate = object.boolean("compensate").value_or(false);
  if (object.find("compensate") != nullptr && solver.integrator != xpbd)
    object.complain("compensate", "is only used by \"xpbd\"; remove it, or choose that");
}

/// "budget": a step of implicit Euler that is on time instead of solved.
void read_budget(ObjectReader& object, SolverOptions& solver) {
  const JsonValue* value = object.find("budget");
  if (value == nullptr) return;
  ObjectReader reader(*value, object.path_of("budget"), object.mistakes());
  StepBudget budget;
  budget.iterations = static_cast<unsigned>(reader.natural("iterations", 1, 100000).value_or(0));
  budget.seconds = reader.number("milliseconds", Limits::positive("ms")).value_or(0) / 1000;
  if (reader.is_object() && value->members.empty())
    reader.complain("is empty; give \"iterations\", \"milliseconds\" or both");
  reader.finish();
  if (solver.integrator != "implicit-euler")
    object.complain("budget", "is only used by \"implicit-euler\"; remove it, or choose that");
  solver.budget = budget;
}

void read_step(ObjectReader& object, SolverOptions& solver) {
  const JsonValue* dt = object.find("dt");
  const bool automatic =
      dt == nullptr || (dt->kind == JsonValue::Kind::string && dt->text == "auto");
  if (!automatic && dt->kind == JsonValue::Kind::string) {
    object.complain("dt", "must be a number (s) or \"auto\", is " + describe(*dt));
  } else if (!automatic) {
    solver.dt = object.number("dt", Limits::positive("s"));
  }
  const Limits share{"1", 0, 1, true, false};
  if (object.find("safety") != nullptr && !automatic) {
    object.complain("safety", "is only used with \"dt\": \"auto\"; remove it or the fixed dt");
  }
  solver.safety = object.number("safety", share).value_or(solver.safety);
  if (automatic && is_implicit(solver.integrator) && object.find("safety") != nullptr)
    object.complain("safety",
                    "is only used by explicit integrators; use '" +
                        std::string(solver.integrator == xpbd ? "softness" : "step_error") +
                        "' instead");
  read_step_error(object, automatic, solver);
}

void read_end(ObjectReader& object, SolverOptions& solver) {
  solver.end = object.number("end", Limits::positive("s"));
  static const std::array<std::string, 1> until{"rest"};
  solver.until_rest = object.choice("until", until).has_value();
  if (object.find("end") == nullptr && object.find("until") == nullptr && object.is_object()) {
    object.complain("has no end; give 'end' in s, or \"until\": \"rest\"");
  }
  const Limits part{"1", 0, 1, true, true};
  if (object.find("tolerance") != nullptr && object.find("until") == nullptr) {
    object.complain("tolerance", "is only allowed with \"until\": \"rest\"");
  }
  if (object.find("kick") != nullptr && object.find("until") == nullptr) {
    object.complain("kick", "is only allowed with \"until\": \"rest\"");
  }
  solver.kick = object.number("kick", Limits::positive("m")).value_or(0);
  solver.tolerance = object.number("tolerance", part).value_or(solver.tolerance);
  if (solver.dt && solver.end && *solver.dt > *solver.end) {
    object.complain("dt", "is longer than the whole run (/solver/end)");
  }
}

void read_damping(ObjectReader& object, SolverOptions& solver) {
  const JsonValue* damping = object.find("damping");
  solver.automatic_damping = solver.until_rest && damping == nullptr;
  if (damping == nullptr) return;
  if (damping->kind != JsonValue::Kind::string) {
    solver.damping = object.number("damping", Limits::not_negative("1/s")).value_or(0);
  } else if (damping->text != "auto") {
    object.complain("damping", "must be a number (1/s) or \"auto\", is " + describe(*damping));
  } else if (!solver.until_rest) {
    object.complain("damping",
                    "\"auto\" is only allowed with \"until\": \"rest\"; give a number in 1/s");
  } else {
    solver.automatic_damping = true;
  }
}

void read_sleep(ObjectReader& object, SolverOptions& solver) {
  const JsonValue* value = object.find("sleep");
  if (value == nullptr) return;
  ObjectReader sleep(*value, object.path_of("sleep"), object.mistakes());
  sleep.require("acceleration", "the threshold below which an island sleeps, in m/s^2");
  sleep.require("velocity", "the threshold below which an island sleeps, in m/s");
  solver.sleep_acceleration = sleep.number("acceleration", Limits::positive("m/s^2")).value_or(0);
  solver.sleep_velocity = sleep.number("velocity", Limits::positive("m/s")).value_or(0);
  sleep.finish();
  if (solver.until_rest)
    object.complain("sleep",
                    "cannot be combined with \"until\": \"rest\", which ends the run at rest; "
                    "remove one of them");
}

}  // namespace

OnInversion read_on_inversion(ObjectReader& object) {
  static const std::array<std::string, 2> words{"stop", "warn"};
  const auto choice = object.choice("on_inversion", words);
  if (!choice) return OnInversion::by_model;
  return *choice == 0 ? OnInversion::stop : OnInversion::warn;
}

OnFailure read_on_failure(ObjectReader& object) {
  static const std::array<std::string, 2> words{"skip", "stop"};
  const auto choice = object.choice("on_failure", words);
  if (!choice) return OnFailure::by_solver;
  return *choice == 0 ? OnFailure::skip : OnFailure::stop;
}

void read_solver(const JsonValue& value, Reading& reading) {
  SolverOptions& solver = reading.scene.solver;
  ObjectReader object(value, "/solver", reading.mistakes);
  const JsonValue* const named = object.find("integrator");
  if (named && named->kind == JsonValue::Kind::string && named->text == statics)
    return object.complain("integrator",
                           "equilibria have no integrator; replace it by \"static\": {}");
  std::vector<std::string> integrators = integrator_names();
  std::erase(integrators, statics);
  if (const auto choice = object.choice("integrator", integrators))
    solver.integrator = integrators[*choice];
  if (object.find(statics) != nullptr) {
    read_static(object, reading.scene, solver);
  } else {
    read_step(object, solver);
    read_softness(object, solver);
    read_compensate(object, solver);
    read_budget(object, solver);
    read_end(object, solver);
    read_damping(object, solver);
    read_sleep(object, solver);
  }
  solver.max_steps = object.natural("max_steps", 1).value_or(solver.max_steps);
  solver.threads = static_cast<unsigned>(object.natural("threads", 0, 1024).value_or(0));
  solver.on_inversion = read_on_inversion(object);
  if (read_on_failure(object) == OnFailure::stop) solver.on_failure = OnFailure::stop;
  object.finish();
}

}  // namespace suture::scene_parts
