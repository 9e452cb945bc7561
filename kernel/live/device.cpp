// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/live/device.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <future>
#include <mutex>
#include <span>
#include <thread>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/plugin_host/plugin_call.hpp"

namespace suture {
namespace {

using DeviceClock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto period = 1ms, measured_every = 500ms, patience = 1000ms;
/// A thread that was kept from running does not catch up on more than this.
constexpr auto most_late = 10ms;

bool is_finite(const suture_device_pose& pose) {
  const auto good = [](double a) { return std::isfinite(a); };
  return std::ranges::all_of(pose.position, good) && std::ranges::all_of(pose.rotation, good);
}

}  // namespace

//   F = F_at - k (x - x_at),   T = T_at - k_r log(R R_at^T)
suture_device_force FeltForce::at_pose(const suture_device_pose& pose) const {
  const Vec3 way = minus(position_of(pose), position_of(at));
  const Vec3 turn = rotation_between(turn_of(at), turn_of(pose));
  suture_device_force felt{};
  for (std::size_t c = 0; c < 3; ++c) {
    felt.force[c] = force[c] - stiffness * way[c];
    felt.torque[c] = torque[c] - turning_stiffness * turn[c];
  }
  return felt;
}

/// The device, and what its thread and that of the run exchange.
struct Device::Shared {
  std::string file, argument, name;
  const suture_device* device = nullptr;
  // Used by the thread only:
  void* handle = nullptr;
  std::string why = std::string(512, '\0');
  suture_device_pose current{};
  DeviceClock::time_point measured_since;
  std::uint64_t reads = 0;

  mutable std::mutex mutex;
  std::condition_variable changed;
  suture_device_pose pose{};
  FeltForce force;
  suture_device_force felt{};
  double rate = 0;
  std::string problem;
  DeviceClock::time_point last_read;
  bool is_stopping = false, has_ended = false, hangs = false, is_done = false;

  void run(std::promise<std::string> opened);
  bool exchange();
  template <class F>
  auto call(const char* function, F&& f) {
    const PluginCall description{.function = function, .file = file.c_str()};
    return call_plugin(description, std::forward<F>(f));
  }
  std::string reason() const {
    return why.front() == '\0' ? "it gives no reason" : std::string(why.c_str());
  }
  void end(const std::string& reason) {
    const std::scoped_lock lock(mutex);
    has_ended = true;
    rate = 0;
    problem = "device '" + name + "' has stopped sending: " + reason +
              "; what it holds stays where it is";
  }
};

void Device::Shared::run(std::promise<std::string> opened) {
  try {
    handle = call("open", [&] { return device->open(argument.c_str(), why.data(), why.size()); });
    opened.set_value(handle ? "" : "cannot be opened: " + reason());
  } catch (const Error& error) {
    opened.set_value(error.what());
  }
  if (handle) {
    try {
      for (auto next = measured_since = DeviceClock::now(); exchange();) {
        next = std::max(next + period, DeviceClock::now() - most_late);
        std::this_thread::sleep_until(next);
      }
      call("close", [&] { device->close(handle); });
    } catch (const Error& error) {
      end(error.what());
    }
  }
  const std::scoped_lock lock(mutex);
  is_done = true;
  changed.notify_all();
}

/// False at the end.
bool Device::Shared::exchange() {
  why.assign(why.size(), '\0');
  suture_device_pose next = current;
  const auto status =
      call("read", [&] { return device->read(handle, &next, why.data(), why.size()); });
  if (status != SUTURE_DEVICE_SAME && status != SUTURE_DEVICE_NEW) {
    end(reason());
    return false;
  }
  if (status == SUTURE_DEVICE_NEW && is_finite(next)) current = next;
  suture_device_force now_felt;
  {
    const std::scoped_lock lock(mutex);
    pose = current;
    felt = now_felt = force.at_pose(current);
    last_read = DeviceClock::now();
    ++reads;
    if (const auto spent = last_read - measured_since; spent >= measured_every) {
      rate = static_cast<double>(reads) / std::chrono::duration<double>(spent).count();
      measured_since = last_read;
      reads = 0;
    }
    if (is_stopping) return false;
  }
  if (device->write) call("write", [&] { device->write(handle, &now_felt); });
  return true;
}

Device::Device(const std::string& text) : shared_(std::make_shared<Shared>()) {
  const std::size_t colon = text.find(':');
  const std::filesystem::path file = device_file(text.substr(0, colon));
  shared_->file = file.string();
  shared_->device = &load_device(file);
  shared_->name = shared_->device->name;
  if (colon != text.npos) shared_->argument = text.substr(colon + 1);
  shared_->last_read = DeviceClock::now();
  std::promise<std::string> opened;
  auto problem = opened.get_future();
  thread_ = std::thread(
      [shared = shared_, opened = std::move(opened)]() mutable { shared->run(std::move(opened)); });
  if (const std::string why = problem.get(); !why.empty()) {
    thread_.join();
    throw PluginError("device '" + shared_->name + "' " + why);
  }
}

Device::~Device() {
  std::unique_lock lock(shared_->mutex);
  shared_->is_stopping = true;
  const bool ends = shared_->changed.wait_for(lock, patience, [&] { return shared_->is_done; });
  lock.unlock();
  ends ? thread_.join() : thread_.detach();
}

const std::string& Device::name() const { return shared_->name; }

suture_device_pose Device::pose() const {
  const std::scoped_lock lock(shared_->mutex);
  return shared_->pose;
}

void Device::set_force(const FeltForce& force) {
  const std::scoped_lock lock(shared_->mutex);
  shared_->force = force;
}

Vec3 Device::force() const {
  const std::scoped_lock lock(shared_->mutex);
  return std::to_array(shared_->felt.force);
}

std::string Device::take_problem() {
  const std::scoped_lock lock(shared_->mutex);
  if (!shared_->has_ended && !shared_->hangs &&
      DeviceClock::now() - shared_->last_read > patience) {
    shared_->hangs = true;
    return "device '" + shared_->name + "' has not answered for 1 s: its read or write waits";
  }
  return std::exchange(shared_->problem, "");
}

double Device::rate() const {
  const std::scoped_lock lock(shared_->mutex);
  return shared_->rate;
}

}  // namespace suture
