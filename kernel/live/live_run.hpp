// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

#include "kernel/live/device_hand.hpp"
#include "kernel/live/live_server.hpp"
#include "kernel/live/picture.hpp"
#include "kernel/live/recording.hpp"
#include "kernel/run/simulation.hpp"

namespace suture {

/// What changes a scene into one that is watched: it writes no results (a repetition of the
/// recording does), but makes the same steps as a run that does.
void leave_out_results(Scene& scene);

/// A run that pages show and control. It starts paused. Inputs act between two steps and are
/// recorded; a run that has failed shows its last state until it is reset.
///
/// Inputs are JSON objects (docs/live.md): {"do": "play"}, "pause", "step", "reset";
/// {"do": "speed", "value": 0.5}; {"do": "field", "name": "von_mises"};
/// {"do": "apply", "event": {...}}; {"do": "grab", "at": [x, y, z]}, {"do": "drag", "to": [x, y,
/// z]},
/// {"do": "let_go"}: a hand that holds the nodes around a place, m in the scene.
class LiveRun {
 public:
  /// Throws the errors of Simulation and of the recording, which is written to `recording` ("": a
  /// name of its own).
  LiveRun(const Scene& scene, PluginHost& host, Diagnostics& diagnostics, LiveServer& server,
          std::filesystem::path recording);
  ~LiveRun();

  /// Goes on until `observer` requests a stop. Throws IoError of the recording.
  void run(Observer& observer);
  Simulation& simulation() { return *simulation_; }
  const RecordingWriter& recording() const { return *recording_; }
  /// From now on a device moves what it holds (DeviceHand) while the run plays. It must outlive
  /// this. Throws the errors of DeviceHand.
  void follow(Device& device, std::string obstacle);

 private:
  using Wall = std::chrono::steady_clock;
  class Reporter;
  void build(std::uint64_t first_surface);
  void obey(const std::string& text, Observer& observer);
  void reset(Observer& observer);
  void play(bool plays);
  void make_due_steps(Observer& observer);
  void make_steps(std::uint64_t count, Observer& observer);
  void apply(const std::string& value, Observer& observer, const std::string& device = "page");
  void grab(const Vec3& at, Observer& observer);
  void drag(const Vec3& to, Observer& observer);
  void let_go(Observer& observer);
  void fail(const std::string& why);
  void show();
  void measure(std::uint64_t steps, double simulated);
  void report_warnings();
  void tell(const char* key, const std::string& text);

  // ---- device: live_device.cpp ----
  void engage_device();
  void move_device_hand(double steps, Observer& observer);
  void feel();
  void show_device();

  const Scene& scene_;
  PluginHost& host_;
  Diagnostics& diagnostics_;
  LiveServer& server_;
  std::unique_ptr<Simulation> simulation_;
  std::optional<Pictures> pictures_;
  std::optional<RecordingWriter> recording_;
  std::string field_ = "displacement";
  LiveStatus status_;
  bool has_failed_ = false, is_shown_ = false;
  /// What the mouse holds is on its way from one place to another.
  struct Hand {
    Vec3 from{}, to{};
    double start = 0, duration = 1;  ///< s
  };
  std::optional<Hand> hand_;
  Device* device_ = nullptr;
  std::string device_obstacle_;
  std::optional<DeviceHand> device_hand_;
  std::size_t reported_warnings_ = 0;
  /// Where and when playing began, which the speed counts from.
  double played_from_ = 0;
  Wall::time_point playing_since_, next_picture_;
  double seconds_per_step_ = 0, dt_ = 0;
  /// Since status_ was last measured.
  struct Measured {
    Wall::time_point since;
    std::uint64_t steps = 0, exchanges = 0;
    double simulated = 0;
  } measured_;
};

}  // namespace suture
