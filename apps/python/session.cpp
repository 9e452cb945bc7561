// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/python/session.hpp"

#include <pthread.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <sstream>

#include "apps/python/python_term.hpp"
#include "kernel/attributes/varied_parameter.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/live/json_text.hpp"
#include "kernel/output/output_folder.hpp"
#include "kernel/run/checkpoints.hpp"
#include "kernel/scene/scene_reader.hpp"

namespace suture::python {
namespace {

using Json = nlohmann::json;

/// How often this process was forked from the one that loaded the module.
unsigned forks() {
  static std::atomic<unsigned> count = 0;
  static const int registered = pthread_atfork(nullptr, nullptr, [] { ++count; });
  return registered == 0 ? count.load() : 0;
}

Scene read(const SessionOptions& options, PluginHost& host, Diagnostics& diagnostics) {
  const ModelLookup lookup = lookup_of(host);
  Scene scene = options.is_text ? read_scene_text(options.text, options.file, options.sets, lookup,
                                                  diagnostics, options.mesh, options.folder)
                                : read_scene(options.file, options.sets, lookup, diagnostics,
                                             options.mesh, options.folder);
  use(options.read, scene);
  if (!options.output) scene.output.enabled = scene.checkpoint.enabled = false;
  scene.output.on_request = true;
  return scene;
}

const char* name_of(RunSummary::Outcome outcome) {
  constexpr const char* names[] = {"finished", "at rest", "interrupted", "unstable equilibrium"};
  return names[static_cast<int>(outcome)];
}

/// Copies (n, 3) numbers to a column of positions or velocities.
void copy_to(Column& column, const py::array_t<double>& values) {
  const double* from = values.data();
  for (Index v = 0; v < column.size(); ++v, from += 3)
    std::copy_n(from, 3, column.rows() + std::size_t{v} * 4);
}

py::array_t<double> checked(const py::array& values, Index rows, const char* what) {
  if (values.ndim() != 2 || values.shape(0) != static_cast<py::ssize_t>(rows) ||
      values.shape(1) != 3)
    throw py::value_error(std::string(what) + " must have the shape (" + std::to_string(rows) +
                          ", 3), one row per vertex; has " +
                          py::str(values.attr("shape")).cast<std::string>());
  const char kind = values.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u')
    throw py::type_error(std::string(what) + " must be an array of real numbers; its dtype is " +
                         py::str(values.dtype()).cast<std::string>());
  return py::array_t<double, py::array::c_style | py::array::forcecast>(values);
}

}  // namespace

/// Marks the session as running on this thread, with the GIL released.
class Session::Running {
 public:
  explicit Running(Session& session) : session_(session) {
    session.runner_ = std::this_thread::get_id();
  }
  ~Running() { session_.runner_.reset(); }

 private:
  Session& session_;
};

Session::Session(const SessionOptions& options)
    : forks_(forks()), is_given_mesh_(options.mesh != nullptr) {
  {
    const py::gil_scoped_release others_may_run;
    scene_ = read(options, host_, diagnostics_);
    auto folder = std::make_shared<OutputFolder>(scene_.output.directory, scene_.output.root);
    if (scene_.output.enabled) folder->open();
    run_ = build(std::move(folder));
  }
  header_ = checkpoint_header(run_.simulation->built(), host_);
  warn_of_new();
}

Session::~Session() {
  // Its threads exist in the process that made it only.
  if (forks_ == forks()) return;
  run_.probes.reset();
  run_.views.reset();  // while its columns exist
  static_cast<void>(run_.simulation.release());
  static_cast<void>(live_.release());
  static_cast<void>(live_server_.release());
}

/// Probes are those of the body as it was built, as in tables.
Session::Run Session::build(std::shared_ptr<OutputFolder> folder) {
  Run run;
  run.simulation =
      std::make_unique<Simulation>(scene_, host_, diagnostics_, true, std::move(folder));
  BuiltScene& built = run.simulation->built();
  try {
    if (!scene_.output.probes.empty())
      run.probes = std::make_unique<ProbeTable>(built.scene().output, built);
  } catch (const InputError& error) {
    scene_.places.rethrow(error);
  }
  run.views = std::make_unique<Views>(built.body());
  return run;
}

// ------------------------------------------------------------------- checks --

void Session::require_own_process() const {
  if (forks_ == forks()) return;
  throw std::runtime_error(
      "this simulation belongs to the process that was forked; create it in the process that "
      "runs it (suture.sweep does), or use the multiprocessing start method 'spawn'");
}

void Session::require_alive() const {
  if (failure_)
    throw std::runtime_error(
        "this simulation has ended with an error (" + *failure_ +
        "); its arrays can still be read; restore() an earlier state, or create a new one to "
        "go on");
}

Simulation& Session::simulation() {
  // On the thread of the run, Python runs in callbacks and force functions only.
  if (runner_ && *runner_ != std::this_thread::get_id())
    throw std::runtime_error(
        "this simulation is running in another thread; wait for it, or read it in a callback "
        "(Simulation.every)");
  return *run_.simulation;
}

Simulation& Session::between_steps() {
  Simulation& checked = simulation();
  if (runner_ && !observer_.in_callback)
    throw std::runtime_error(
        "not possible in a force function, which is called within a step; use its arguments x, v "
        "and t, and a callback (Simulation.every) for operations");
  return checked;
}

const std::vector<std::string>& Session::messages() {
  simulation();
  return observer_.messages;
}

/// Warnings of the kernel become those of Python, which may turn them into exceptions.
void Session::warn_of_new() {
  const auto& warnings = diagnostics_.warnings();
  while (warned_ < warnings.size())
    if (PyErr_WarnEx(PyExc_UserWarning, warnings[warned_++].c_str(), 2) != 0)
      throw py::error_already_set();
}

// -------------------------------------------------------------------- steps --

void Session::require_steps() {
  if (runner_ && *runner_ == std::this_thread::get_id())
    throw std::runtime_error("a callback or force function cannot make steps of its own run");
  simulation();
  require_own_process();
  require_alive();
}

template <class F>
void Session::advance(F&& f) {
  require_steps();
  observer_.failure = nullptr;
  try {
    const Running running(*this);
    const py::gil_scoped_release others_may_run;
    f();
  } catch (const Error& error) {
    failure_ = error.what();
    throw;
  }
  if (observer_.failure) std::rethrow_exception(std::exchange(observer_.failure, nullptr));
  warn_of_new();
}

void Session::pause_at(const Pause& pause) {
  std::optional<RunSummary::Outcome> outcome;
  try {
    advance([&] { outcome = run_.simulation->advance(pause, observer_); });
  } catch (...) {
    if (live_) live_->show_last();
    throw;
  }
  if (outcome) outcome_ = name_of(*outcome);
  if (live_) live_->show_last();
}

std::uint64_t Session::step(std::uint64_t count) {
  const std::uint64_t before = run_.simulation->step();
  pause_at({{}, count});
  return run_.simulation->step() - before;
}

void Session::run_to(double time) {
  if (std::isnan(time)) throw py::value_error("run_to() needs a time in s; it is NaN");
  pause_at({time, {}});
}

RunSummary Session::run(py::object progress) {
  require_steps();
  RunSummary summary;
  const struct Shown {
    py::object& progress;
    ~Shown() { progress = py::object(); }
  } shown{observer_.progress};
  if (!progress.is_none()) observer_.progress = std::move(progress);
  pause_at({});
  // Only a run that has ended closes its tables: after an exception it can go on.
  advance([&] { summary = run_.simulation->run(observer_); });
  return summary;
}

double Session::dt() { return between_steps().next_dt(); }

// ------------------------------------------------------------------ between --

EventOutcome Session::apply(const std::string& text, const std::string& name) {
  const std::uint64_t step = between_steps().step();
  EventOutcome outcome = apply(read_event(text, name, scene_, diagnostics_));
  record(step, text);
  return outcome;
}

EventOutcome Session::cut(TriangleSurface surface, bool rest_shape,
                          std::optional<bool> along_blade) {
  Event event;
  event.path = "event";
  event.rest_shape = rest_shape;
  event.what = CutSurface{{},
                          1,
                          {},
                          std::make_shared<const TriangleSurface>(std::move(surface)),
                          along_blade.value_or(scene_.added_cuts_follow_blade())};
  EventOutcome outcome = apply(event);
  forgo_recording("a surface of arrays has cut");
  return outcome;
}

EventOutcome Session::apply(const Event& event) {
  Simulation& now = between_steps();
  require_own_process();
  require_alive();
  const EventOutcome outcome = now.apply(event, observer_);
  warn_of_new();
  return outcome;
}

void Session::set_position(const py::array& values) {
  const auto rows = checked(values, between_steps().attributes().vertex_count(), "position");
  require_alive();
  simulation().change_motion([&](Attributes& a) { copy_to(a.position(), rows); });
  forgo_recording("positions were assigned");
}

void Session::set_velocity(const py::array& values) {
  const auto rows = checked(values, between_steps().attributes().vertex_count(), "velocity");
  require_alive();
  simulation().change_motion([&](Attributes& a) { copy_to(a.velocity(), rows); });
  forgo_recording("velocities were assigned");
}

void Session::steer(const std::string& obstacle, const PoseTarget& target) {
  Simulation& now = between_steps();
  require_alive();
  now.steer(obstacle, target);
  Json steer{{"obstacle", obstacle}, {"at", target.at}};
  if (target.translation) steer["translation"] = *target.translation;
  if (target.rotation) steer["rotation"] = *target.rotation;
  record(now.step(), json_text(Json{{"steer", steer}}));
}

void Session::move_grasp(const std::string& name, const Vec3& translation, double at) {
  Simulation& now = between_steps();
  require_alive();
  const double during = at - now.time();
  now.move_grasp(name, translation, during);
  record(now.step(),
         json_text(
             Json{{"move", {{"grasp", name}, {"translation", translation}, {"during", during}}}}));
}

void Session::set_parameters(std::size_t model, const std::string& text) {
  Simulation& now = between_steps();
  require_alive();
  Instance& instance = *now.attributes().instances()[model];
  const std::vector<double> values = read_parameters(
      text, "parameters of '" + instance.name() + "'", instance.model(), instance.parameters());
  run_.views->hand_over();
  now.set_parameters(instance, values);
  observer_.on_message(timed(now.time(), "model '" + instance.name() + "' has " + text));
  record(
      now.step(),
      json_text(Json{{"parameters", {{"model", instance.name()}, {"values", Json::parse(text)}}}}));
  warn_of_new();
}

void Session::set_field(std::size_t model, const std::string& parameter, const py::array& values) {
  Simulation& now = between_steps();
  require_alive();
  Instance& instance = *now.attributes().instances()[model];
  const std::size_t place = VariedParameter::number_of(instance, parameter);
  if (instance.parameter_column(place) == nullptr)
    throw InputError(instance.title() + ": parameter '" + parameter +
                     "' is the same in all elements; give it one value");
  const py::array_t<double, py::array::c_style | py::array::forcecast> numbers(values);
  run_.views->hand_over();
  now.set_field(instance, place, {numbers.data(), numbers.data() + numbers.size()});
  observer_.messages.push_back(
      timed(now.time(), "model '" + instance.name() + "' has other " + parameter + " by element"));
  warn_of_new();
}

void Session::set_gravity(const Vec3& value) {
  Simulation& now = between_steps();
  require_alive();
  now.set_gravity(value);
  std::ostringstream text;
  text << "gravity is (" << value[0] << ", " << value[1] << ", " << value[2] << ") m/s^2";
  observer_.on_message(timed(now.time(), text.str()));
  record(now.step(), json_text(Json{{"gravity", value}}));
  warn_of_new();
}

void Session::equilibrate() {
  advance([&] { run_.simulation->equilibrate(observer_); });
}

void Session::keep_steps(const StepReplay::Limit& limit) {
  Simulation& now = between_steps();
  require_alive();
  run_.kept_steps = std::make_unique<KeptSteps>(now.built().dynamics(), limit);
}

void Session::follow(std::vector<ParameterDirection> parameters, double tolerance) {
  Simulation& now = between_steps();
  require_alive();
  run_.followed =
      std::make_unique<FollowedSlopes>(now.built().dynamics(), std::move(parameters), tolerance);
}

ProbeTable& Session::probes() {
  between_steps();
  if (run_.probes) return *run_.probes;
  throw InputError("the scene has no probes; give it /output/probes");
}

// ------------------------------------------------------------------- states --

std::vector<std::string> Session::term_names() const {
  std::vector<std::string> names;
  for (const PythonTerm* term : run_.terms) names.emplace_back(term->name());
  return names;
}

/// Files cannot go back to what they were, and records may be waiting to be written.
void Session::require_no_output(const char* what) const {
  if (scene_.output.enabled)
    throw InputError(std::string(what) +
                     " needs a simulation that writes nothing; create it with output=False");
}

std::shared_ptr<SessionState> Session::copy() {
  Simulation& now = between_steps();
  require_own_process();
  require_alive();
  require_no_output("copy()");
  auto state = std::make_shared<SessionState>();
  state->scene_hash = scene_.hash;
  state->mesh_hash = header_.mesh_hash;
  state->terms = term_names();
  state->outcome = outcome_;
  state->time = now.time();
  state->steps = now.step();
  state->state = now.save();
  return state;
}

void Session::save_checkpoint(const std::filesystem::path& file) {
  Simulation& now = between_steps();
  require_own_process();
  require_alive();
  require_no_output("save_checkpoint()");
  if (is_given_mesh_)
    throw InputError(
        "a checkpoint has no mesh, and the scene that reads it names no file for this one; write "
        "the mesh to a file and name it in the scene");
  if (!run_.terms.empty())
    throw InputError("a checkpoint cannot hold the force function '" +
                     std::string(run_.terms[0]->name()) + "'; copy() keeps states for this script");
  suture::save_checkpoint(now, header_, file);
}

void Session::require_fit(const SessionState& state) const {
  if (state.scene_hash != scene_.hash)
    throw InputError("the state belongs to another scene (" + state.scene_hash + ", this is " +
                     scene_.hash + "); restore it into a simulation of its own scene");
  if (state.mesh_hash != header_.mesh_hash)
    throw InputError("the state belongs to another mesh; restore it into a simulation of its own");
  const auto list = [](const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "'" : ", '") + name + "'";
    return text.empty() ? "none" : text;
  };
  if (const std::vector<std::string> names = term_names(); names != state.terms)
    throw InputError("the state has other force functions: " + list(state.terms) +
                     "; this simulation has " + list(names) +
                     "; copy it again after adding a force function");
}

void Session::restore(const SessionState& state) {
  if (runner_)
    throw std::runtime_error(
        "restore() is not possible while the simulation runs, nor in a callback or a force "
        "function; stop the run first, with step() or run_to()");
  require_own_process();
  if (live_)
    throw std::runtime_error("restore() is not possible while a live view is open; close() it");
  require_no_output("restore()");
  require_fit(state);
  Run restored;
  {
    const py::gil_scoped_release others_may_run;
    restored = build(std::make_shared<OutputFolder>(scene_.output.directory, scene_.output.root));
  }
  Simulation& simulation = *restored.simulation;
  if (mesh_hash(simulation.built().body()) != header_.mesh_hash)
    throw InputError("the mesh has changed since the simulation was created; restore the file");
  for (const PythonTerm* term : run_.terms)
    restored.terms.push_back(static_cast<PythonTerm*>(
        &simulation.add_term(std::make_unique<PythonTerm>(*term, simulation.attributes()))));
  simulation.load(state.state);
  for (PythonTerm* term : restored.terms) term->start();
  warned_ = diagnostics_.warnings().size();  // those of the scene are known
  run_.views.reset();                        // arrays keep their values
  run_ = std::move(restored);
  outcome_ = state.outcome;
  failure_.reset();
  forgo_recording("a state was restored");
  observer_.callbacks.rewind(state.steps, state.time);
  observer_.messages.push_back(
      timed(state.time, "restored to step " + std::to_string(state.steps)));
}

PythonTerm& Session::add_term(std::unique_ptr<PythonTerm> term) {
  require_alive();
  auto& added = static_cast<PythonTerm&>(between_steps().add_term(std::move(term)));
  run_.terms.push_back(&added);
  forgo_recording("a force function was added");
  return added;
}

// ----------------------------------------------------------- garbage collector --

int Session::traverse(visitproc visit, void* argument) {
  if (const int stop = observer_.callbacks.traverse(visit, argument)) return stop;
  for (const PythonTerm* term : run_.terms)
    if (const int stop = term->traverse(visit, argument)) return stop;
  return 0;
}

void Session::clear() {
  observer_.callbacks.clear();
  for (PythonTerm* term : run_.terms) term->clear();
}

}  // namespace suture::python
