// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/python/session.hpp"

#include <pthread.h>

#include <atomic>
#include <cmath>
#include <limits>

#include "apps/python/python_term.hpp"
#include "kernel/base/error.hpp"
#include "kernel/output/output_folder.hpp"
#include "kernel/scene/scene_reader.hpp"

namespace suture::python {
namespace {

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

Session::Session(const SessionOptions& options) : forks_(forks()) {
  {
    const py::gil_scoped_release others_may_run;
    scene_ = read(options, host_, diagnostics_);
    auto folder = std::make_shared<OutputFolder>(scene_.output.directory, scene_.output.root);
    if (scene_.output.enabled) folder->open();
    simulation_ = std::make_unique<Simulation>(scene_, host_, diagnostics_, true, folder);
  }
  views_ = std::make_unique<Views>(simulation_->built().body());
  warn_of_new();
}

Session::~Session() {
  views_.reset();  // while its columns exist
  // Its threads exist in the process that made it only.
  if (forks_ != forks()) static_cast<void>(simulation_.release());
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
    throw std::runtime_error("this simulation has ended with an error (" + *failure_ +
                             "); its arrays can still be read; create a new one to go on");
}

Simulation& Session::simulation() {
  // On the thread of the run, Python runs in callbacks and force functions only.
  if (runner_ && *runner_ != std::this_thread::get_id())
    throw std::runtime_error(
        "this simulation is running in another thread; wait for it, or read it in a callback "
        "(Simulation.every)");
  return *simulation_;
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
  advance([&] { outcome = simulation_->advance(pause, observer_); });
  if (outcome) outcome_ = name_of(*outcome);
}

std::uint64_t Session::step(std::uint64_t count) {
  const std::uint64_t before = simulation_->step();
  pause_at({{}, count});
  return simulation_->step() - before;
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
  advance([&] { summary = simulation_->run(observer_); });
  return summary;
}

double Session::dt() { return between_steps().next_dt(); }

// ------------------------------------------------------------------ between --

EventOutcome Session::apply(const std::string& text, const std::string& name) {
  return apply(read_event(text, name, scene_, diagnostics_));
}

EventOutcome Session::cut(TriangleSurface surface, bool rest_shape) {
  Event event;
  event.path = "event";
  event.rest_shape = rest_shape;
  event.what = CutSurface{{}, 1, {}, std::make_shared<const TriangleSurface>(std::move(surface))};
  return apply(event);
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
}

void Session::set_velocity(const py::array& values) {
  const auto rows = checked(values, between_steps().attributes().vertex_count(), "velocity");
  require_alive();
  simulation().change_motion([&](Attributes& a) { copy_to(a.velocity(), rows); });
}

void Session::steer(const std::string& obstacle, const PoseTarget& target) {
  Simulation& now = between_steps();
  require_alive();
  now.steer(obstacle, target);
}

PythonTerm& Session::add_term(std::unique_ptr<PythonTerm> term) {
  require_alive();
  auto& added = static_cast<PythonTerm&>(between_steps().add_term(std::move(term)));
  terms_.push_back(&added);
  return added;
}

// ----------------------------------------------------------- garbage collector --

int Session::traverse(visitproc visit, void* argument) {
  if (const int stop = observer_.callbacks.traverse(visit, argument)) return stop;
  for (const PythonTerm* term : terms_)
    if (const int stop = term->traverse(visit, argument)) return stop;
  return 0;
}

void Session::clear() {
  observer_.callbacks.clear();
  for (PythonTerm* term : terms_) term->clear();
}

}  // namespace suture::python
