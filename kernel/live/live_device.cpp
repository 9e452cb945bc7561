// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a live run and a device exchange.
#include "kernel/base/error.hpp"
#include "kernel/live/live_run.hpp"

namespace suture {

void LiveRun::follow(Device& device, std::string obstacle) {
  device_hand_.emplace(*simulation_, obstacle, pictures_->edge_length());
  device_ = &device;
  device_obstacle_ = std::move(obstacle);
  status_.device.name = device.name();
}

/// Call when the run begins to play or pauses. A paused run gives no force.
void LiveRun::engage_device() {
  if (!device_) return;
  device_hand_->engage(device_->pose());
  if (!status_.is_playing) device_->set_force({});
}

/// Leads what the device holds to where the device is, during the next steps.
void LiveRun::move_device_hand(double steps, Observer& observer) {
  if (!device_ || !(dt_ > 0)) return;  // until the first step is made
  const std::string input = device_hand_->input(device_->pose(), steps, dt_);
  if (input.empty()) return;
  try {
    apply(input, observer, device_->name());
  } catch (const InputError& error) {
    tell("error", error.what());
  }
}

void LiveRun::feel() {
  if (!device_ || status_.has_failed) return;
  device_->set_force(device_hand_->force());
  ++measured_.exchanges;
}

void LiveRun::show_device() {
  if (!device_) return;
  if (const std::string problem = device_->take_problem(); !problem.empty())
    diagnostics_.warn(problem);
  LiveStatus::Device& shown = status_.device;
  shown.place = device_hand_->place();
  shown.rotation = device_hand_->rotation();
  shown.force = device_->force();
  shown.poses_per_second = device_->rate();
}

}  // namespace suture
