// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/runner.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <optional>

#include "kernel/base/error.hpp"
#include "kernel/run/simulation.hpp"
#include "kernel/scene/scene_reader.hpp"
#include "tests/stability/stress_check.hpp"
#include "tests/stability/stress_parts.hpp"

namespace suture::test {
namespace {

constexpr double allowed_growth = 0.02;
// Parts of the displacement, between runs at the step and at a quarter of it: phases of modes drift
// apart by (h w)^2/24 per radian, and a sudden load excites modes of all lengths.
constexpr double allowed_difference = 0.1, allowed_smooth_difference = 0.05;
// Parts of what was exchanged. The balance is h^2/8 sum F^2/m: (h w)^2/4 of the elastic energy of
// each mode, at 0.8 of the stable step 0.64 of that of the stiffest and next to nothing of slow
// ones.
constexpr double allowed_balance = 0.65, allowed_smooth_balance = 0.03;

PluginHost& host() {
  static PluginHost plugins;
  static const bool added = [] {
    for (const char* name : {"/naive-laws.so", "/not-finite.so"})
      plugins.add_file(std::string(TEST_PLUGINS) + name);
    return true;
  }();
  (void)added;
  return plugins;
}

struct Listener : Observer {
  explicit Listener(std::vector<std::string>& list) : messages(list) {}
  void on_message(const std::string& text) override { messages.push_back(text); }
  std::vector<std::string>& messages;
};

bool contains(const std::vector<std::string>& messages, const char* text) {
  return std::ranges::any_of(
      messages, [&](const std::string& m) { return m.find(text) != std::string::npos; });
}

/// Samples of an energy between two times.
class Level {
 public:
  void add(double value) {
    sum_ += value;
    ++count_;
  }
  double mean() const { return sum_ / count_; }

 private:
  double sum_ = 0;
  int count_ = 0;
};

constexpr int looks = 100;  ///< of each level

const char* kind_of(const Error& error) {
  if (dynamic_cast<const NumericalError*>(&error)) return "NumericalError";
  if (dynamic_cast<const TopologyError*>(&error)) return "TopologyError";
  if (dynamic_cast<const InputError*>(&error)) return "InputError";
  if (dynamic_cast<const PluginError*>(&error)) return "PluginError";
  return "Error";
}

std::string outcome_name(RunSummary::Outcome outcome) {
  switch (outcome) {
    case RunSummary::Outcome::finished:
      return "finished";
    case RunSummary::Outcome::at_rest:
      return "at rest";
    case RunSummary::Outcome::interrupted:
      return "interrupted";
    case RunSummary::Outcome::unstable_equilibrium:
      return "unstable equilibrium";
  }
  return "";
}

/// Energy in the beginning and at the end of what follows the last change of a load.
struct Growth {
  /// sum m v- . v+ / 2 + elastic + potential: what leapfrog conserves where forces are linear.
  Level first, last;
  /// The kinetic energy of (v- + v+) / 2 is larger by h^2/8 sum F^2/m, which comes and goes with
  /// the forces: that sum without h^2, and h^2.
  Level hidden, first_squared_dt, last_squared_dt;
  double scale = 0;  ///< J, largest kinetic and elastic energy

  /// Where a tear or a cut has changed h, what was hidden shows and is no growth.
  double energy() const {
    const double shown = first_squared_dt.mean() - last_squared_dt.mean();
    return last.mean() - first.mean() - shown * hidden.mean();
  }
};

std::vector<double> velocities(Simulation& simulation) {
  const Column& v = simulation.attributes().velocity();
  const auto rows = static_cast<std::size_t>(v.size()) * 4;
  return {v.rows(), v.rows() + rows};
}

/// Takes the step that leads from v- to v+; the same bits as without looking.
void add_look(Simulation& simulation, double time, double stable, Listener& listener, Level& level,
              Level& squared_dt, Growth& growth) {
  simulation.run_to(time, listener);
  const Energies energies = simulation.energies();
  const std::vector<double> before = velocities(simulation);
  std::vector<double> after = before;
  for (int i = 1; after == before && i < 200; ++i) {
    simulation.run_to(time + 0.02 * i * stable, listener);
    after = velocities(simulation);
  }
  double kinetic = 0, hidden = 0;
  const Column& mass = simulation.attributes().mass();
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double m = mass.get(static_cast<Index>(i / 4), 0), change = after[i] - before[i];
    kinetic += m * before[i] * after[i] / 2;
    hidden += m * change * change / 8;
  }
  const double h = simulation.built().dynamics().motion().last_step();
  growth.scale = std::max(growth.scale, energies.kinetic + std::abs(energies.elastic));
  growth.hidden.add(hidden / (h * h));
  squared_dt.add(h * h);
  level.add(kinetic + energies.elastic + energies.external);
}

Growth follow_energy(const Trial& trial, Simulation& simulation, Listener& listener) {
  Growth growth;
  const double end = trial.scene["solver"]["end"], start = trial.settled, span = end - start;
  const auto look_at = [&](double part, Level& level, Level& squared_dt) {
    add_look(simulation, start + part * span, trial.stable, listener, level, squared_dt, growth);
  };
  for (int i = 0; i < looks; ++i)
    look_at(0.02 + 0.2 * (i + 0.5) / looks, growth.first, growth.first_squared_dt);
  for (int i = 0; i < looks; ++i)
    look_at(0.78 + 0.2 * (i + 0.5) / looks, growth.last, growth.last_squared_dt);
  return growth;
}

Vec3 difference(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double length(const Vec3& a) { return std::hypot(a[0], a[1], a[2]); }

/// Follows the probed node up to the time of comparison.
struct Path {
  Path(const Trial& trial, const Scene& scene, double dt) {
    Diagnostics diagnostics;
    Simulation simulation(scene, host(), diagnostics);
    std::vector<std::string> ignored;
    Listener listener(ignored);
    Selection probe;
    probe.what = Selection::Nearest{trial.probe};
    const auto look = [&](double time) {
      simulation.run_to(time, listener);
      return simulation.mean_displacement(probe);
    };
    for (int i = 1; i < 10; ++i)
      largest = std::max(largest, length(look((trial.compare - dt) * i / 10)));
    before = look(trial.compare - dt);
    last = look(trial.compare);
    largest = std::max(largest, length(last));
  }
  Vec3 before{}, last{};  ///< at the end, and dt earlier
  double largest = 0;
};

/// Beyond what one step explains: run_to() ends with the step that reaches the time.
double difference_to_quarter_step(const Trial& trial, const Scene& scene) {
  Scene fine = scene;
  if (scene.solver.dt)
    fine.solver.dt = *scene.solver.dt / 4;
  else
    fine.solver.safety = scene.solver.safety / 4;
  const double dt = scene.solver.dt.value_or(scene.solver.safety * trial.stable);
  const Path coarse(trial, scene, dt), reference(trial, fine, dt);
  const double lag = length(difference(reference.last, reference.before));
  return std::max(0.0, length(difference(coarse.last, reference.last)) - lag) / reference.largest;
}

/// Whether a run at a tenth of the step is stopped, too.
bool stops_with_fine_step(const Scene& scene, double stable) {
  Scene fine = scene;
  fine.solver.dt = 0.08 * stable;
  fine.solver.max_steps = 0;
  Diagnostics diagnostics;
  std::vector<std::string> ignored;
  Listener listener(ignored);
  try {
    Simulation(fine, host(), diagnostics).run(listener);
  } catch (const NumericalError&) {
    return true;
  }
  return false;
}

void judge_right(const Trial& trial, const Scene& scene, Result& result) {
  const auto set = [&](Verdict verdict, const std::string& reason) {
    result.verdict = verdict;
    result.reason = reason;
  };
  if (result.outcome == "NumericalError") {
    if (stops_with_fine_step(scene, trial.stable))
      return set(Verdict::beyond_law, "a run at a tenth of the step stops, too");
    return set(Verdict::stopped, result.error);
  }
  if (result.outcome != "finished" && result.outcome != "at rest")
    return set(Verdict::wrong_outcome, result.outcome);
  const bool was_reported = contains(result.messages, "of the energy exchanged is unexplained");
  if (!std::isfinite(result.growth) || !std::isfinite(result.balance))
    return set(Verdict::grew, "not finite");
  if (result.growth > allowed_growth && !was_reported)
    return set(Verdict::grew, "energy grew by " + std::to_string(100 * result.growth) + " %");
  const double limit = trial.is_smooth ? allowed_smooth_balance : allowed_balance;
  if (std::abs(result.balance) > limit && !was_reported)
    return set(Verdict::inaccurate, "balance " + std::to_string(result.balance));
  if (trial.check.measure && result.difference > trial.check.tolerance)
    return set(Verdict::inaccurate, "differs by " + std::to_string(result.difference));
  if (result.difference > (trial.is_smooth ? allowed_smooth_difference : allowed_difference))
    return set(Verdict::inaccurate,
               std::to_string(100 * result.difference) + " % from a quarter of the step");
  if (was_reported && trial.is_conservative && result.growth < allowed_growth)
    set(Verdict::held, "reported or undone; no growth over the run");
  else if (was_reported)
    set(Verdict::reported, "growth was reported");
}

/// Whether the warning about the balance is issued where it must be, with the figure of the
/// summary.
std::string wrong_words_of_balance(const Result& result) {
  constexpr const char* words = "the energy balance closes only to ";
  const bool is_open = std::abs(result.stated_balance) > 0.1;
  for (const std::string& message : result.messages) {
    const std::size_t at = message.find(words);
    if (at == std::string::npos) continue;
    const double stated = std::stod(message.substr(at + std::strlen(words))) / 100;
    if (is_open && std::abs(stated - result.stated_balance) < 1e-5) return "";
    return "warns of " + std::to_string(stated) + ", and the summary states " +
           std::to_string(result.stated_balance);
  }
  return is_open ? "no warning of " + std::to_string(result.stated_balance) : "";
}

void judge_quiet(const Trial& trial, Result& result) {
  const auto wrong = [&](const std::string& reason) {
    result.verdict = Verdict::wrong_outcome;
    result.reason = reason;
  };
  if (result.outcome != "finished" && result.outcome != "at rest")
    return wrong(result.outcome + ": " + result.error);
  if (!result.quiet_message.empty()) return wrong("at rest: " + result.quiet_message);
  if (result.rollbacks > 4) return wrong(std::to_string(result.rollbacks) + " rollbacks");
  if (static_cast<double>(result.quiet_steps) > trial.quiet_steps)
    return wrong(std::to_string(result.quiet_steps) + " steps at rest, expected at most " +
                 std::to_string(trial.quiet_steps));
  if (!(result.quiet_motion <= 1e-12)) return wrong("moved before the motion began");
}

/// Whether a table of the trial has a number that is not finite.
bool has_bad_table(const std::filesystem::path& folder) {
  std::error_code none_exists;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none_exists)) {
    if (entry.path().extension() != ".csv") continue;
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);)
      if (!line.starts_with('#') && line.find('[') == std::string::npos &&
          (line.find("nan") != std::string::npos || line.find("inf") != std::string::npos))
        return true;
  }
  return false;
}

void judge(const Trial& trial, const Scene& scene, Result& result) {
  const auto expect = [&](bool good, Verdict otherwise) {
    if (good) return;
    result.verdict = otherwise;
    result.reason = "ended with " + result.outcome;
  };
  const bool stopped = result.outcome == "NumericalError";
  switch (trial.expected) {
    case Expected::right:
      return judge_right(trial, scene, result);
    case Expected::wrong:
      return expect(stopped, Verdict::finished_wrong);
    case Expected::warned:
      return expect(stopped || contains(result.messages, "/solver/dt"), Verdict::finished_wrong);
    case Expected::quiet:
      return judge_quiet(trial, result);
    case Expected::buckles:
      return expect(result.outcome == "unstable equilibrium", Verdict::finished_wrong);
    case Expected::refused:
      return expect(stopped && result.error.find("max_steps") != std::string::npos,
                    Verdict::wrong_outcome);
  }
}

/// Returns what the trial's check measures.
Values run(const Trial& trial, const Scene& scene, Result& result) {
  Values values;
  Diagnostics diagnostics;
  diagnostics.on_warning = [&](const std::string& text) { result.messages.push_back(text); };
  Listener listener(result.messages);
  try {
    Simulation simulation(scene, host(), diagnostics);
    if (trial.begin) trial.begin(simulation);
    if (trial.quiet > 0) {
      result.messages.clear();  // about the model
      simulation.run_to(trial.quiet, listener);
      if (!result.messages.empty()) result.quiet_message = result.messages.front();
      result.quiet_steps = simulation.step();
      result.quiet_motion =
          largest_displacement(simulation) / simulation.built().selector().diagonal();
    }
    std::optional<Growth> growth;
    const bool looks_in = trial.expected == Expected::right && trial.is_conservative &&
                          !scene.solver.until_rest && scene.solver.damping == 0;
    if (looks_in) growth = follow_energy(trial, simulation, listener);
    RunSummary summary;
    values = run_and_measure(trial.check, simulation, listener, summary);
    result.outcome = outcome_name(summary.outcome);
    result.steps = summary.steps;
    result.rollbacks = summary.rollbacks;
    if (summary.exchanged > 0) {
      result.stated_balance = summary.balance / summary.exchanged;
      result.balance = simulation.built().dynamics().balance().balance / summary.exchanged;
    }
    if (growth && growth->scale > 0) {
      const double part = 0.76 * (summary.time - trial.settled) / summary.time;
      const double of_10000 =
          10'000 / std::max(10'000.0, static_cast<double>(summary.steps) * part);
      result.growth = growth->energy() / std::max(growth->scale, summary.exchanged) * of_10000;
    }
  } catch (const Error& error) {
    result.outcome = kind_of(error);
    result.error = error.what();
  }
  return values;
}

/// What the check expects: by its law, or of another run.
Values expected_of(const Check& check, const std::filesystem::path& folder) {
  if (!check.reference) return check.expected;
  Result result;
  const Values values = run(*check.reference, read_trial(*check.reference, folder), result);
  if (!result.error.empty()) throw NumericalError("the reference: " + result.error);
  return values;
}

void run_stress(const Trial& trial, const std::filesystem::path& folder, Result& result) {
  Values values;
  try {
    values = run(trial, read_trial(trial, folder), result);
  } catch (const InputError& error) {
    result.outcome = kind_of(error);
    result.error = error.what();
  }
  if (result.error.empty() && trial.check.measure)
    result.difference = difference_to(trial.check, expected_of(trial.check, folder), values);
  judge_stress(trial, result);
}

void run_load(const Trial& trial, const std::filesystem::path& folder, bool compares,
              Result& result) {
  const Scene scene = read_trial(trial, folder);
  const Values values = run(trial, scene, result);
  if (result.outcome == "InputError" || result.outcome == "PluginError") {
    result.verdict = Verdict::not_run;
    result.reason = result.error;
    return;
  }
  if (compares && trial.compare > 0 && result.error.empty())
    result.difference = difference_to_quarter_step(trial, scene);
  if (trial.check.measure && result.error.empty())
    result.difference = difference_to(trial.check, trial.check.expected, values);
  judge(trial, scene, result);
  if (!scene.output.enabled || scene.output.directory.filename() != trial.name) return;
  if (has_bad_table(scene.output.directory)) {
    result.verdict = Verdict::finished_wrong;
    result.reason = "a table has a number that is not finite";
  }
  std::filesystem::remove_all(scene.output.directory);
}

}  // namespace

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::good:
      return "good";
    case Verdict::reported:
      return "reported";
    case Verdict::held:
      return "held";
    case Verdict::beyond_law:
      return "beyond the law";
    case Verdict::refused:
      return "refused";
    case Verdict::ended:
      return "stopped";
    case Verdict::warned:
      return "warned";
    case Verdict::absent:
      return "-";
    case Verdict::stopped:
      return "STOPPED";
    case Verdict::grew:
      return "GREW";
    case Verdict::inaccurate:
      return "INACCURATE";
    case Verdict::finished_wrong:
      return "FINISHED WRONG";
    case Verdict::wrong_outcome:
      return "WRONG OUTCOME";
    case Verdict::not_run:
      return "NOT RUN";
  }
  return "";
}

Scene read_trial(const Trial& trial, const std::filesystem::path& folder) {
  if (!trial.mesh.empty()) std::ofstream(folder / "mesh.mesh") << trial.mesh;
  Diagnostics ignored;
  const ModelLookup lookup{
      [](std::string_view id) -> const suture_model& { return host().model(id); },
      [](const std::filesystem::path&) {}};
  return read_scene_text(trial.scene.dump(), folder / (trial.name + ".json"), {}, lookup, ignored);
}

Result run_trial(const Trial& trial, const std::filesystem::path& folder, bool compares) {
  const auto start = std::chrono::steady_clock::now();
  Result result;
  try {
    if (trial.scene.is_null()) {
      result.verdict = Verdict::absent;
    } else if (!trial.model.empty()) {
      run_stress(trial, folder, result);
    } else {
      run_load(trial, folder, compares, result);
    }
  } catch (const Error& error) {
    result.verdict = Verdict::not_run;
    result.reason = error.what();
  }
  if (const std::string text = wrong_words_of_balance(result); !text.empty()) {
    result.verdict = Verdict::wrong_outcome;
    result.reason = text;
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace suture::test
