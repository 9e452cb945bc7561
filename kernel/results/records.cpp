// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/results/records.hpp"

#include <algorithm>

namespace suture {

bool Records::frame_is_due() const {
  const OutputOptions& output = built_.scene().output;
  if (!recorder_.writes_frames()) return false;
  if (clock_.step() == 0) return true;
  if (output.every_steps > 0) return clock_.step() % output.every_steps == 0;
  return is_reached(recorder_.frames_written());
}

/// Whether the time of a frame has come, where frames have times.
bool Records::is_reached(std::size_t frame) const {
  const double every = built_.scene().output.every;
  return every > 0 && clock_.reached(static_cast<double>(frame) * every);
}

void Records::write_frame() {
  built_.dynamics().synchronise();
  recorder_.frame(clock_.step(), clock_.time(), gravity());
  last_frame_ = clock_.step();
}

void Records::record(double last_dt) {
  if (frame_is_due()) write_frame();
  record_tables(last_dt, false);
  recorded_ = clock_.step();
}

/// The rows that are due; `last`: of every table that has none of this step.
void Records::record_tables(double last_dt, bool last) {
  const OutputOptions& output = built_.scene().output;
  const auto due = [&](std::uint64_t every, std::uint64_t& row) {
    if (row == clock_.step() || (!last && clock_.step() % every != 0)) return false;
    row = clock_.step();
    return true;
  };
  if (recorder_.writes_energies() && due(output.energies_every, last_energies_))
    recorder_.energies(clock_.step(), clock_.time(), last_dt, built_.dynamics().balance());
  if (recorder_.writes_probes() && due(output.probes_every, last_probes_)) {
    built_.dynamics().synchronise(recorder_.probes_need(&FieldChoice::needs_force));
    recorder_.probes(clock_.step(), clock_.time(), gravity());
  }
  if (recorder_.writes_tools() && due(output.tools_every, last_tools_)) {
    if (recorder_.has_grasps()) built_.dynamics().synchronise();
    recorder_.tools(clock_.step(), clock_.time(), gravity());
  }
}

void Records::finish(double last_dt, bool records_state) {
  if (records_state) {
    if (recorder_.writes_frames() && last_frame_ != clock_.step()) write_frame();
    record_tables(last_dt, true);
  }
  recorder_.release(clock_.step());
  recorder_.finish();
}

void Records::roll_back() {
  for (std::uint64_t* mark : {&last_frame_, &last_energies_, &last_probes_, &last_tools_})
    if (*mark > clock_.step()) *mark = never;
  if (recorded_ != never) recorded_ = std::min(recorded_, clock_.step());
}

void Records::begin_here() {
  const std::uint64_t every_steps = built_.scene().output.every_steps;
  std::size_t frames = every_steps > 0 ? clock_.step() / every_steps + 1 : 1;
  while (every_steps == 0 && is_reached(frames)) ++frames;
  recorder_.skip_frames(frames);
}

void Records::state(Archive& archive) {
  archive("recorded", recorded_);
  archive("last frame", last_frame_);
  archive("last energies", last_energies_);
  archive("last probes", last_probes_);
  archive("last tools", last_tools_);
}

}  // namespace suture
