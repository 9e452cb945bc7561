// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "kernel/live/live_run.hpp"
#include "kernel/output/checkpoint_file.hpp"
#include "kernel/output/output_folder.hpp"
#include "kernel/scene/scene_reader.hpp"
#include "tests/live/client.hpp"
#include "tests/mesh/temporary_folder.hpp"

namespace suture::test {

inline constexpr const char* beam = R"({
  "suture": 1,
  "mesh": {"box": {"size": [1, 0.25, 0.25], "cells": [8, 4, 4]}},
  "models": [{"model": "tm-faure", "parameters": {"E": 4e5, "nu": 0.3, "rho": 1000}}],
  "gravity": [0, -9.8, 0],
  "constraints": [{"fix": "xyz", "where": {"set": "x0"}}, {"fix": "xyz", "where": {"set": "x1"}}],
  "contact": {"obstacles": [{"name": "ball", "sphere": {"centre": [0.5, 0.4, 0.125], "radius": 0.1}}]},
  "solver": {"dt": "auto", "end": 100, "damping": 2},
  "output": {"every": 0.7, "fields": ["displacement"], "energies": {"every_steps": 50}}
})";
inline constexpr const char* cut =
    R"({"do":"apply","event":{"cut":{"plane":{"point":[0.5,0,0],"normal":[1,0,0.1]}}}})";

inline PluginHost& host() {
  static PluginHost plugins;
  return plugins;
}

class Stop final : public Observer {
 public:
  bool stop_requested() override { return is_set; }
  std::atomic<bool> is_set = false;
};

/// A run on a thread of its own, and a page that controls it.
class Watched : public testing::Test {
 protected:
  /// `device`: as --device has it; "" for none.
  explicit Watched(const char* scene = beam, const std::string& device = "",
                   const std::string& hold = "")
      : text_(scene) {
    leave_out_results(scene_);
    if (!device.empty()) device_.emplace(device);
    thread_ = std::thread([this, hold] {
      LiveRun run(scene_, host(), diagnostics_, *server_, recording());
      if (device_) run.follow(*device_, hold);
      is_ready_ = true;
      run.run(stop_);
      run.end();
    });
    while (!is_ready_) std::this_thread::yield();
    EXPECT_TRUE(page.open());
    greeting = page.until("live");
  }
  ~Watched() override { stop(); }

  std::filesystem::path recording() const { return folder_ / "recording.jsonl"; }
  void stop() {
    stop_.is_set = true;
    if (thread_.joinable()) thread_.join();
  }
  /// The next state for which `is_so` holds.
  template <class F>
  Json state(F&& is_so) {
    for (;;)
      if (Json head = page.until("step"); is_so(head)) return head;
  }
  /// Single steps, of a run that is paused.
  void step(std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) page.send(R"({"do":"step"})");
  }
  void press_with_ball() {
    page.send(R"({"do":"take","tool":"ball","at":[0.5,0.4,0.1]})");
    page.send(R"({"do":"drag","to":[0.5,0.32,0.1]})");
  }
  void grab_and_pull() {
    page.send(R"({"do":"grab","at":[0.4,0.25,0.1]})");
    page.send(R"({"do":"drag","to":[0.4,0.3,0.1]})");
  }
  void stiffen() {
    page.send(R"({"do":"apply","event":{"parameters":{"model":"tm-faure","values":{"E":5e5}}}})");
  }
  /// Pulls the body apart.
  void fail_the_run() {
    page.send(R"({"do":"grab","at":[0.4,0.25,0.1]})");
    page.send(
        R"({"do":"apply","event":{"move":{"grasp":"live-hand","translation":[0,50,0],"during":0.001}}})");
    page.send(R"({"do":"play"})");
    EXPECT_THAT(page.until("error")["error"], testing::HasSubstr("The run has failed"));
  }
  Json state_at(std::uint64_t step) {
    return state([&](const Json& head) { return head["step"] == step; });
  }
  Json state_after(std::uint64_t step) {
    return state([&](const Json& head) { return head["step"] >= step; });
  }

  TemporaryFolder folder_;
  Diagnostics diagnostics_;
  const char* text_;
  Scene scene_ = read_scene(folder_.write("beam.json", text_), {}, host(), diagnostics_);
  std::unique_ptr<LiveServer> server_ = open_live_server(0);
  Client page{Address(server_->address())};
  Json greeting;

 private:
  std::optional<Device> device_;
  Stop stop_;
  std::atomic<bool> is_ready_ = false;
  std::thread thread_;
};

/// The largest difference of coordinates between the same corners of elements, m. Copies of nodes
/// at a cut may have other numbers.
inline double largest_difference(Simulation& a, Simulation& b) {
  double largest = 0;
  for (Index e = 0; e < a.complex().element_count(); ++e) {
    EXPECT_EQ(a.complex().exists(3, e), b.complex().exists(3, e));
    if (!a.complex().exists(3, e)) continue;
    for (std::size_t k = 0; k < 8; ++k)
      for (int c = 0; c < 3; ++c) {
        const auto place = [&](Simulation& run) {
          return run.attributes().position().get(run.complex().vertices_of(e)[k], c);
        };
        largest = std::max(largest, std::abs(place(a) - place(b)));
      }
  }
  return largest;
}

/// Repeats a recording on some threads, with results or without; the hash of its end.
inline std::string repeated_end(const std::filesystem::path& file, const std::string& threads,
                                bool has_output, std::vector<std::string>& warnings) {
  const Recording recording = read_recording(file);
  Diagnostics diagnostics;
  SceneSource source = recording.source;
  source.working_folder = std::filesystem::current_path();
  Scene scene = read_scene_source(source, {"/solver/threads=" + threads}, host(), diagnostics);
  if (!has_output) leave_out_results(scene);
  const auto folder = std::make_shared<OutputFolder>(file.parent_path() / "results");
  if (has_output) folder->open();
  Simulation simulation(scene, host(), diagnostics, true, folder);
  if (const auto& start = recording.checkpoint; !start.empty())
    simulation.resume(read_checkpoint(start), start);
  Observer nobody;
  EXPECT_TRUE(repeat(recording, scene, simulation, nobody, diagnostics));
  compare_end(recording, simulation, diagnostics);
  warnings = diagnostics.warnings();
  return state_hash(simulation);
}

/// Expects that a recording repeats its end, on any number of threads, with results or without.
inline void expect_same_bits(const std::filesystem::path& file) {
  const Recording recorded = read_recording(file);
  for (const std::string threads : {"1", "2"})
    for (const bool has_output : {false, true}) {
      std::vector<std::string> warnings;
      EXPECT_EQ(repeated_end(file, threads, has_output, warnings), recorded.end);
      EXPECT_TRUE(warnings.empty()) << warnings[0];
    }
}

}  // namespace suture::test
