// SPDX-License-Identifier: GPL-3.0-or-later
//
// A long run with many actions, as fast as possible and without a page, and its repetition. By
// default 6 s with 20 actions; SUTURE_LIVE_SECONDS=600 makes ten minutes with 200.
#include <cstdlib>
#include <deque>

#include "tests/live/watched.hpp"

namespace suture::test {
namespace {

/// Takes the place of pages: sends texts at times of the run, which ends with the last one.
class ScriptedServer final : public LiveServer {
 public:
  struct Input {
    double at;  ///< s
    std::string text;
  };
  explicit ScriptedServer(std::deque<Input> inputs) : inputs_(std::move(inputs)) {}
  void follow(LiveRun& run) { run_ = &run; }
  bool is_over() const { return inputs_.empty(); }
  std::vector<std::string> errors;
  std::size_t pictures = 0;

  const std::string& address() const override { return address_; }
  void greet(std::string) override {}
  void say(std::string text) override {
    if (text.find("\"error\"") != text.npos) errors.push_back(std::move(text));
  }
  void show(LivePicture) override { ++pictures; }
  bool is_watched() const override { return true; }
  bool wants_picture() const override { return true; }
  std::vector<std::string> take_inputs() override {
    std::vector<std::string> due;
    while (!inputs_.empty() && inputs_.front().at <= run_->simulation().time()) {
      due.push_back(std::move(inputs_.front().text));
      inputs_.pop_front();
    }
    return due;
  }
  void wait(std::chrono::milliseconds) override {}

 private:
  std::deque<Input> inputs_;
  LiveRun* run_ = nullptr;
  std::string address_ = "nowhere";
};

class UntilOver final : public Observer {
 public:
  explicit UntilOver(const ScriptedServer& server) : server_(server) {}
  bool stop_requested() override { return server_.is_over(); }

 private:
  const ScriptedServer& server_;
};

/// Ten kinds of actions in turn, one every 0.3 s or so; hands are led by four more inputs each.
std::deque<ScriptedServer::Input> actions(int count, double seconds) {
  const double every = seconds / count;
  const std::string cut = R"({"do":"apply","event":{"cut":{"plane":{"point":[0.5,0.2,0.1],)"
                          R"("normal":[1,0,0],"radius":0.1}}}})";
  const std::string kinds[] = {
      R"({"do":"grab","at":[0.4,0.25,0.1]})",
      R"({"do":"let_go"})",
      cut,
      R"({"do":"apply","event":{"suture":{}}})",
      R"({"do":"apply","event":{"gravity":[0,-5,1]}})",
      R"({"do":"apply","event":{"parameters":{"model":"tm-faure","values":{"E":3.5e5}}}})",
      R"({"do":"take","tool":"ball","at":[0.5,0.4,0.1]})",
      R"({"do":"let_go"})",
      cut,
      R"({"do":"back"})",
  };
  std::deque<ScriptedServer::Input> inputs{{0, R"({"do":"speed","value":0})"},
                                           {0, R"({"do":"play"})"}};
  for (int i = 0; i < count; ++i) {
    const double at = every * (i + 0.5);
    const std::string& kind = kinds[i % std::ssize(kinds)];
    inputs.push_back({at, kind});
    const bool holds = kind.find("grab") != kind.npos || kind.find("take") != kind.npos;
    for (int k = 1; holds && k <= 4; ++k) {
      const double way = (k % 2 - 0.5) * 0.02;
      inputs.push_back(
          {at + every * k / 5, Json{{"do", "drag"}, {"to", {0.45, 0.3 + way, 0.1}}}.dump()});
    }
    if (kind.find("back") != kind.npos) inputs.push_back({at, R"({"do":"play"})"});
  }
  inputs.push_back({seconds, R"({"do":"pause"})"});
  return inputs;
}

TEST(LongRecordings, RepeatBitForBit) {
  const char* given = std::getenv("SUTURE_LIVE_SECONDS");
  const double seconds = given ? std::strtod(given, nullptr) : 6;
  const int count = given ? 200 : 20;
  std::vector<std::string> sets;
  if (given) sets = {"/solver/end=1e6"};
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  Scene scene = read_scene(folder.write("beam.json", beam), sets, host(), diagnostics);
  leave_out_results(scene);
  ScriptedServer server(actions(count, seconds));
  const auto start = std::chrono::steady_clock::now();
  {
    LiveRun run(scene, host(), diagnostics, server, folder / "recording.jsonl");
    server.follow(run);
    UntilOver until(server);
    run.run(until);
    run.end();
  }
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
  EXPECT_TRUE(server.errors.empty()) << server.errors.front();
  EXPECT_GT(server.pictures, 2U);
  const Recording recorded = read_recording(folder / "recording.jsonl");
  ASSERT_FALSE(recorded.end.empty());
  EXPECT_GT(recorded.inputs.size(), static_cast<std::size_t>(count));
  std::printf("%g s, %d actions, %zu inputs, %llu steps, %ju bytes: made in %.1f s\n", seconds,
              count, recorded.inputs.size(), static_cast<unsigned long long>(recorded.last_step),
              std::filesystem::file_size(folder / "recording.jsonl"), spent.count());
  for (const char* threads : {"1", "2"}) {
    std::vector<std::string> warnings;
    EXPECT_EQ(repeated_end(folder / "recording.jsonl", threads, false, warnings), recorded.end);
  }
}

}  // namespace
}  // namespace suture::test
