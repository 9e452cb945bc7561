// SPDX-License-Identifier: GPL-3.0-or-later
//
// Runs that go back to earlier states, and what their recordings repeat.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kernel/base/error.hpp"
#include "kernel/forces/contact_law.hpp"
#include "kernel/live/live_states.hpp"
#include "tests/live/watched.hpp"

namespace suture::test {
namespace {

using testing::HasSubstr;

/// An upright blade around the end of the beam.
constexpr const char* bent_blade = R"({"do":"apply","event":{"sweep":{
  "points":[[0.8,-1,-0.1],[0.8,1,-0.1],[0.7,-1,0.1],[0.7,1,0.1],[0.8,-1,0.3],[0.8,1,0.3]],
  "triangles":[[0,1,3],[0,3,2],[2,3,5],[2,5,4]]}}})";

/// A run that makes only the steps it is asked for.
class GoesBack : public Watched {
 protected:
  void make(std::uint64_t steps) {
    step(steps);
    state_at(step_ += steps);
  }
  Json kept() { return page.until("kept")["kept"]; }
  void go_back(const Json& input, std::uint64_t step) {
    page.send(input.dump());
    EXPECT_EQ(page.until("kept").count("error"), 0U);
    state_at(step_ = step);
  }

 private:
  std::uint64_t step_ = 0;
};

TEST_F(GoesBack, TakesTheLastActionBack) {
  make(50);
  page.send(cut);
  const Json before = kept()[0];
  EXPECT_EQ(before["name"], "cut");
  EXPECT_EQ(before["step"], 50);
  EXPECT_GT(page.until("corners")["laid_open"], 0);
  make(100);
  page.send(R"({"do":"back"})");
  EXPECT_THAT(page.until("message")["message"], HasSubstr("cut was taken back"));
  EXPECT_EQ(kept(), Json::array());
  EXPECT_EQ(page.until("corners")["laid_open"], 0);
  EXPECT_EQ(state_at(50)["time"], before["time"]);
  page.send(R"({"do":"back"})");
  EXPECT_THAT(page.until("error")["error"], HasSubstr("no action to take back"));
  page.send(R"({"do":"step"})");
  state_at(51);
  stop();
  EXPECT_TRUE(read_recording(recording()).inputs.empty());
  EXPECT_EQ(read_recording(recording()).last_step, 51U);
  expect_same_bits(recording());
}

// Each with what it needs of the state: nodes that are held, faces that are open, obstacles on the
// way, models and gravity that were changed.
TEST_F(GoesBack, RepeatsWhatCountsBitForBit) {
  make(20);
  press_with_ball();
  make(20);
  page.send(R"({"do":"apply","event":{"gravity":[0,-5,1]}})");
  stiffen();
  page.send(cut);
  make(20);
  grab_and_pull();
  make(2);
  page.send(R"({"do":"keep","name":"while it is held"})");
  Json list;
  while (list.empty() || list.back()["name"] != "while it is held") list = kept();
  EXPECT_EQ(list.size(), 6U);
  page.send(R"({"do":"drag","to":[0.2,0.3,0.1]})");
  page.send(R"({"do":"let_go"})");
  page.send(R"({"do":"apply","event":{"pierce":{"where":{"nearest":[0.3,0.1,0.1]}}}})");
  make(30);
  go_back({{"do", "back"}, {"to", list.back()["id"]}}, 62);
  make(10);
  page.send(R"({"do":"drag","to":[0.45,0.3,0.1]})");
  make(20);
  page.send(bent_blade);
  page.send(R"({"do":"let_go"})");
  make(50);
  stop();
  const Recording recorded = read_recording(recording());
  // steer, gravity, E, cut, grasp, two moves, sweep, release
  EXPECT_EQ(recorded.inputs.size(), 9U);
  EXPECT_EQ(recorded.last_step, 142U);
  expect_same_bits(recording());
}

TEST_F(GoesBack, ContinuesARecording) {
  make(30);
  page.send(cut);
  make(20);
  stop();
  const Recording first = read_recording(recording());
  Diagnostics diagnostics;
  Observer nobody;
  const auto server = open_live_server(0);
  const std::filesystem::path file = folder_ / "second.jsonl";
  {
    LiveRun run(scene_, host(), diagnostics, *server, file);
    ASSERT_TRUE(run.continue_from(first, nobody));
    EXPECT_EQ(state_hash(run.simulation()), first.end);
    Stop at_once;
    at_once.is_set = true;
    run.run(at_once);
    run.end();
  }
  const Recording second = read_recording(file);
  EXPECT_EQ(second.inputs.size(), 1U);
  EXPECT_EQ(second.end, first.end);
  EXPECT_EQ(second.last_step, 50U);
  Recording wrong = first;
  wrong.start = "0123456789abcdef";
  LiveRun other(scene_, host(), diagnostics, *server, folder_ / "third.jsonl");
  EXPECT_THROW(other.continue_from(wrong, nobody), InputError);
}

// The scene makes other steps, which end at the times of the events.
TEST_F(GoesBack, WritesASceneThatDoesTheSame) {
  page.send(R"({"do":"scene"})");
  EXPECT_THAT(page.until("error")["error"], HasSubstr("nothing was done yet"));
  page.send(R"({"do":"take","tool":"ball","at":[0.5,0.4,0.1]})");
  page.send(R"({"do":"drag","to":[0.5,0.35,0.1]})");
  make(20);
  page.send(R"({"do":"drag","to":[0.5,0.36,0.12]})");
  make(30);
  for (const char* to : {"[0.4,0.28,0.1]", "[0.4,0.26,0.12]"}) {
    page.send(R"({"do":"grab","at":[0.4,0.25,0.1]})");
    page.send(std::string(R"({"do":"drag","to":)") + to + "}");
    make(20);
    page.send(R"({"do":"drag","to":[0.41,0.28,0.1]})");
    make(40);
    page.send(R"({"do":"let_go"})");
  }
  page.send(bent_blade);
  page.send(R"({"do":"apply","event":{"gravity":[0,-9.8,0.1]}})");
  make(60);
  page.send(R"({"do":"scene"})");
  EXPECT_THAT(page.until("warning")["warning"], HasSubstr("gravity: [0,-9.8,0.1]"));
  const std::string text = page.until("scene")["scene"];
  stop();

  const Recording recording = read_recording(this->recording());
  Diagnostics diagnostics;
  Observer nobody;
  Simulation played(scene_, host(), diagnostics);
  EXPECT_TRUE(repeat(recording, scene_, played, nobody, diagnostics));
  Scene written = read_scene(folder_.write("done.json", text), {}, host(), diagnostics);
  leave_out_results(written);
  Simulation same(written, host(), diagnostics);
  same.run(nobody);
  EXPECT_NEAR(same.time(), played.time(), 1e-12);
  EXPECT_EQ(same.attributes().vertex_count(), played.attributes().vertex_count());
  EXPECT_LT(largest_difference(same, played), 2e-3);  // m, of a beam of 1 m that sags by 0.03
  const Pose pose = same.contact()->pose(0, same.time());
  EXPECT_NEAR(pose.translation[1], -0.04, 1e-12);
}

// Steps that the run makes from the aim to the action are taken back, too.
TEST_F(GoesBack, TakesAnAimedActionBackToWhereItWasAimed) {
  make(20);
  page.send(R"({"do":"aim"})");
  make(10);
  std::string aimed = cut;
  aimed.insert(1, R"("aimed":true,)");
  page.send(aimed);
  EXPECT_EQ(kept()[0]["step"], 20);
  make(10);
  page.send(cut);  // not aimed
  page.send(R"({"do":"keep"})");
  Json list = kept();
  while (list.back()["name"] != "kept") list = kept();
  EXPECT_EQ(list[1]["step"], 40);
  page.send(R"({"do":"back"})");
  go_back({{"do", "back"}}, 20);
  make(30);
  stop();
  EXPECT_TRUE(read_recording(recording()).inputs.empty());
  expect_same_bits(recording());
}

TEST_F(GoesBack, KeepsNoStateForARefusedAction) {
  EXPECT_EQ(kept().size(), 0U);
  page.send(R"({"do":"apply","event":{"cut":{}}})");
  EXPECT_EQ(kept().size(), 1U);
  EXPECT_EQ(kept().size(), 0U);
  page.send(R"({"do":"back","to":7})");
  EXPECT_THAT(page.until("error")["error"], HasSubstr("'plane'"));
  EXPECT_THAT(page.until("error")["error"], HasSubstr("no kept state 7"));
}

TEST_F(GoesBack, EndsAFailure) {
  make(20);
  fail_the_run();
  page.send(R"({"do":"step"})");
  EXPECT_THAT(page.until("error")["error"], HasSubstr("take the last action back"));
  page.send(R"({"do":"back"})");
  go_back({{"do", "back"}}, 20);
  make(20);
  stop();
  expect_same_bits(recording());
}

LiveState state_of(const std::string& name, std::size_t bytes, bool is_before_action = true) {
  LiveState kept{name, is_before_action};
  StateTree::Array& array = kept.state.arrays["bytes"];
  array = {Archive::Scalar::u8, 1, bytes, nullptr};
  return kept;
}

TEST(LiveStates, AreBoundedAndOrdered) {
  LiveStates kept;
  for (int i = 0; i < 200; ++i) kept.keep(state_of(std::to_string(i), 10));
  ASSERT_EQ(kept.list().size(), 100U);
  EXPECT_EQ(kept.list()[0]["name"], "100");
  kept.keep(state_of("large", std::size_t{500} << 20));
  EXPECT_EQ(kept.list().size(), 100U);
  kept.keep(state_of("as large", std::size_t{500} << 20));
  EXPECT_EQ(kept.list().size(), 1U);
  kept.keep(state_of("asked for", 1, false));
  EXPECT_EQ(kept.take_last_action().name, "as large");
  EXPECT_EQ(kept.list().size(), 0U);
  EXPECT_THROW(kept.take_last_action(), InputError);
}

TEST_F(GoesBack, NeedsAPlaceForItsRecordingFromTheStart) {
  stop();
  Simulation simulation(scene_, host(), diagnostics_);
  const TemporaryFolder files;
  const std::filesystem::path folder = files.path();
  for (const std::filesystem::path& file :
       {folder / "none" / "r.jsonl", folder, std::filesystem::path("/proc/r.jsonl")})
    EXPECT_THROW(RecordingWriter(file, scene_, simulation), IoError) << file;
  EXPECT_FALSE(RecordingWriter(std::nullopt, scene_, simulation).is_on());
  RecordingWriter{folder / "r.jsonl", scene_, simulation};
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST(Recordings, GoBackToWhatTheyHave) {
  const TemporaryFolder folder;
  const std::string header =
      R"({"recording":1,"program":"p","isa":"base","file":"f","folder":"d","state":"0","scene":"{}"})"
      "\n";
  const auto input = [](int step) {
    return R"({"step":)" + std::to_string(step) + R"(,"device":"page","value":{}})" + "\n";
  };
  const auto back = [](int step, int inputs) {
    return R"({"step":)" + std::to_string(step) + R"(,"back":true,"inputs":)" +
           std::to_string(inputs) + "}\n";
  };
  const auto read = [&](const std::string& lines) {
    return read_recording(folder.write("r.jsonl", header + lines));
  };
  const Recording recording = read(input(3) + input(5) + input(9) + back(7, 2) + input(8));
  ASSERT_EQ(recording.inputs.size(), 3U);
  EXPECT_EQ(recording.inputs.back().step, 8U);
  EXPECT_EQ(read(input(3) + back(2, 0)).last_step, 2U);
  EXPECT_THROW(read(input(3) + back(2, 1)), InputError);
  EXPECT_EQ(read(input(3) + back(4, 1)).last_step, 4U);  // kept after the last input
  EXPECT_THROW(read(input(3) + back(4, 0)), InputError);
  EXPECT_THROW(read(input(3) + back(3, 2)), InputError);
  EXPECT_THROW(read(input(3) + R"({"step":3,"back":true})"
                               "\n"),
               InputError);
  const auto read_later = [&](const std::string& lines) {  // from a checkpoint at step 4
    std::string start = header;
    start.insert(start.find(R"("state")"), R"("checkpoint":"c.h5","step":4,)");
    return read_recording(folder.write("r.jsonl", start + lines));
  };
  EXPECT_EQ(read_later("").last_step, 4U);
  EXPECT_EQ(read_later(input(9) + R"({"step":4,"reset":true})"
                                  "\n")
                .last_step,
            4U);
  EXPECT_THROW(read_later(input(3)), InputError);
  EXPECT_THROW(read_later(input(9) + back(3, 0)), InputError);
}

}  // namespace
}  // namespace suture::test
