// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/modal_run.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <vector>

#include "kernel/base/error.hpp"
#include "kernel/results/frame_parts.hpp"
#include "kernel/run/run_loop.hpp"
#include "kernel/steps/free_bodies.hpp"

namespace suture {
namespace {

/// Equilibria until `end`, so close to each other that events fall between them.
double static_step(const Scene& scene, double end) {
  constexpr double most_steps = 100;
  std::vector<double> times{0, end};
  for (const Event& event : scene.events)
    for (const double time : {event.start(), event.finish()})
      if (time > 0 && time < end) times.push_back(time);
  std::ranges::sort(times);
  double gap = end;
  for (std::size_t i = 1; i < times.size(); ++i)
    if (times[i] > times[i - 1]) gap = std::min(gap, times[i] - times[i - 1]);
  return end / std::min(std::ceil(end / gap * (1 - 1e-9)), most_steps);
}

/// The scene as a static run to its end without output.
Scene static_scene(const Scene& given, double last_change) {
  Scene scene = given;
  scene.output.enabled = scene.checkpoint.enabled = false;
  SolverOptions& solver = scene.solver;
  if (solver.integrator == "static") return scene;
  double last = last_change;
  for (const Event& event : scene.events)
    if (std::isfinite(event.finish())) last = std::max(last, event.finish());
  const double end = solver.end.value_or(last > 0 ? last : 1);
  const SolverOptions defaults;
  solver = defaults;
  solver.integrator = "static";
  solver.end = end;
  solver.dt = static_step(given, end);
  solver.threads = given.solver.threads;
  solver.on_inversion = given.solver.on_inversion;
  return scene;
}

void require_no_contact(const Scene& scene) {
  if (scene.contact.is_wanted())
    throw InputError(
        "/contact: modes do not include contact; remove /contact to compute those of "
        "the body alone");
}

void require_tangent(const BuiltScene& built) {
  const std::string without = built.body().models().without_tangent();
  if (!without.empty())
    throw InputError("modes need the derivatives of all forces, and " + without +
                     " has none (suture.tangent/1); add the extension to the model");
}

void require_held(BuiltScene& built) {
  if (built.scene().solver.hold_free_pieces) return;
  const std::string body = describe_unheld_body(built);
  if (!body.empty())
    throw InputError("/constraints: " + body +
                     ", so it has no equilibrium of its own; constrain it, or use --at rest");
}

std::string number(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

const char* name_of(NaturalMode::Kind kind) {
  switch (kind) {
    case NaturalMode::Kind::zero:
      return "zero";
    case NaturalMode::Kind::unstable:
      return "unstable";
    case NaturalMode::Kind::vibration:
      break;
  }
  return "vibration";
}

double frequency_of(const NaturalMode& mode) {
  return mode.kind == NaturalMode::Kind::vibration ? mode.frequency() : 0;
}

std::string table_of(const NaturalModes& modes) {
  std::string text = "mode,kind,frequency [Hz],omega^2 [1/s^2],residual\n";
  for (std::size_t i = 0; i < modes.modes.size(); ++i) {
    const NaturalMode& mode = modes.modes[i];
    text += std::to_string(i + 1) + ',' + name_of(mode.kind) + ',' + number(frequency_of(mode)) +
            ',' + number(mode.eigenvalue) + ',' + number(mode.residual) + '\n';
  }
  return text;
}

std::string title_of(const NaturalMode& mode, std::size_t number) {
  std::ostringstream text;
  text << "; mode " << number << ": " << name_of(mode.kind);
  if (mode.kind == NaturalMode::Kind::vibration) text << ", " << mode.frequency() << " Hz";
  return text.str();
}

void warn_of_instability(const NaturalModes& modes, Diagnostics& diagnostics) {
  const auto unstable =
      std::ranges::count(modes.modes, NaturalMode::Kind::unstable, &NaturalMode::kind);
  if (unstable == 0) return;
  std::ostringstream text;
  text << "the body is unstable in this state: " << unstable
       << (unstable == 1 ? " mode has" : " modes have") << " a negative omega^2, the lowest "
       << modes.modes[0].eigenvalue << " 1/s^2, so a disturbance grows at "
       << modes.modes[0].growth() << " 1/s";
  diagnostics.warn(text.str());
}

}  // namespace

ModalRun::ModalRun(const Scene& scene, PluginHost& host, Diagnostics& diagnostics,
                   const ModalOptions& options)
    : scene_(scene), host_(host), diagnostics_(diagnostics), options_(options) {
  try {
    build();
  } catch (const InputError& error) {
    scene_.places.rethrow(error);
  }
}

ModalRun::~ModalRun() = default;

void ModalRun::build() {
  Diagnostics ignored;  // what building the static run reports again
  rest_ = std::make_unique<BuiltScene>(scene_, options_.at_equilibrium ? ignored : diagnostics_);
  rest_->dynamics().start();
  require_no_contact(scene_);
  require_tangent(*rest_);
  require_modes(rest_->body(), options_.count);
  if (!options_.at_equilibrium) return;
  require_held(*rest_);
  const double last_change = rest_->body().last_change();
  rest_.reset();
  // The folder is never opened, because the run has no output.
  statics_ = std::make_unique<RunLoop>(
      static_scene(scene_, last_change), host_, diagnostics_, true,
      std::make_shared<OutputFolder>(scene_.output.directory, scene_.output.root));
}

BuiltScene& ModalRun::built() { return statics_ ? statics_->built() : *rest_; }

NaturalModes ModalRun::solve(Observer& observer) {
  bool is_reported = false;  // that the equilibrium is unstable
  if (statics_) {
    is_reported = statics_->run(observer).outcome == RunSummary::Outcome::unstable_equilibrium;
    if (!built().body().is_conservative(built().dynamics().time()))
      diagnostics_.warn(
          "the stiffness is not symmetric, because a pressure acts up to a free edge or a model "
          "has "
          "no energy; the modes are those of its symmetric part");
  }
  const auto report = [&](const ModalIteration& i) {
    std::ostringstream text;
    text << "LOBPCG iteration " << i.number << ": " << i.converged << " of " << options_.count
         << " modes, residual " << i.residual << ", lowest omega^2 " << i.lowest << " 1/s^2";
    observer.on_detail(text.str());
  };
  // At rest, before every ramp: the stiffness of a pressure belongs to the state under it.
  const double time = statics_ ? built().dynamics().time() : -1;
  NaturalModes modes = find_natural_modes(built().body(), time, options_.count, report);
  if (!is_reported) warn_of_instability(modes, diagnostics_);
  return modes;
}

std::string ModalRun::write(const NaturalModes& modes,
                            const std::shared_ptr<OutputFolder>& folder) {
  FrameWriterOptions options = frame_options(scene_.output, folder);
  options.prefix = "mode";
  options.collection = "modes";
  FrameWriter writer(options);
  const std::string provenance = provenance_line(scene_, host_, built());
  for (std::size_t i = 0; i < modes.modes.size(); ++i) {
    const NaturalMode& mode = modes.modes[i];
    Frame frame;
    frame.number = i + 1;
    frame.time = static_cast<double>(i + 1);
    set_geometry(frame, built());
    FrameField& field = frame.point_fields.emplace_back();
    field.name = "mode";
    field.components = 3;
    for (const Vec3& u : mode.shape) field.values.insert(field.values.end(), u.begin(), u.end());
    frame.field_data_provenance = provenance + title_of(mode, i + 1);
    leave_out(frame, built());
    writer.submit(std::move(frame));
  }
  writer.finish();
  folder->write("modes.csv", [&](OutputFile& file) { file.write(table_of(modes)); });
  return writer.collection();
}

}  // namespace suture
