// SPDX-License-Identifier: GPL-3.0-or-later
//
// Checkpoints that a page saves, and the runs that go on from them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kernel/base/error.hpp"
#include "kernel/live/hand.hpp"
#include "tests/live/watched.hpp"

namespace suture::test {
namespace {

using testing::HasSubstr;

/// A run that has moved an obstacle, changed a parameter, and holds nodes beside a cut when it
/// saves a checkpoint.
class SavesACheckpoint : public Watched {
 protected:
  Json make(std::uint64_t steps) {
    step(steps);
    return state_at(step_ += steps);
  }
  void act_and_save() {
    make(20);
    press_with_ball();
    stiffen();
    page.send(cut);
    make(20);
    grab_and_pull();
    make(2);
    page.send(R"({"do":"checkpoint"})");
    EXPECT_THAT(message_with("saved "), HasSubstr(file_.string()));
  }
  std::string message_with(const std::string& words) {
    for (;;) {
      const std::string message = page.until("message")["message"];
      if (message.find(words) != message.npos) return message;
    }
  }

  std::filesystem::path file_ = folder_ / "beam-checkpoint.h5";

 private:
  std::uint64_t step_ = 0;
};

TEST_F(SavesACheckpoint, FromWhichARunGoesOnBitForBit) {
  act_and_save();
  make(60);
  stop();
  const std::string end = read_recording(recording()).end;
  for (const std::string threads : {"1", "2"})
    for (const bool has_output : {false, true}) {
      Checkpoint checkpoint = read_checkpoint(file_);
      const CheckpointHeader& header = checkpoint.header;
      Scene scene =
          read_scene_source({header.scene_text, header.scene_file, header.working_folder, {}},
                            {"/solver/threads=" + threads}, host(), diagnostics_);
      if (!has_output) leave_out_results(scene);
      const auto folder = std::make_shared<OutputFolder>(folder_ / ("results" + threads));
      Simulation simulation(scene, host(), diagnostics_, true, folder);
      simulation.resume(checkpoint, file_);
      Observer nobody;
      simulation.advance({{}, 60}, nobody);
      EXPECT_EQ(state_hash(simulation), end);
    }
}

TEST_F(SavesACheckpoint, FromWhichALiveRunGoesOn) {
  act_and_save();
  stop();
  Observer nobody;
  const auto server = open_live_server(0);
  const std::filesystem::path file = folder_ / "second.jsonl";
  LiveRun run(scene_, host(), diagnostics_, *server, file);
  run.resume(read_checkpoint(file_), file_, nobody);
  EXPECT_EQ(run.simulation().step(), 42U);
  EXPECT_TRUE(run.simulation().built().body().constraints().held_by(hand_name).empty());
  run.simulation().advance({{}, 50}, nobody);
  run.end();

  const Recording second = read_recording(file);
  EXPECT_EQ(second.checkpoint, file_);
  ASSERT_EQ(second.inputs.size(), 1U);
  EXPECT_EQ(second.inputs[0].value, release_input(hand_name));
  EXPECT_EQ(second.last_step, 92U);
  expect_same_bits(file);
}

// As a scene that writes results has them: the frame of 0.7 s is before the checkpoint.
TEST_F(SavesACheckpoint, AfterWhichFramesHaveTheNumbersOfTheWholeRun) {
  for (double time = 0; time < 0.8;) time = make(50)["time"];
  page.send(R"({"do":"checkpoint"})");
  message_with("saved ");
  stop();
  const Checkpoint checkpoint = read_checkpoint(file_);
  ASSERT_LT(checkpoint.header.time, 1.4);
  const CheckpointHeader& header = checkpoint.header;
  const std::filesystem::path results = folder_ / "results";
  const Scene scene =
      read_scene_source({header.scene_text, header.scene_file, header.working_folder, {}},
                        {"/solver/end=1.5"}, host(), diagnostics_);
  const auto folder = std::make_shared<OutputFolder>(results);
  Simulation simulation(scene, host(), diagnostics_, true, folder);
  simulation.resume(checkpoint, file_);
  Observer nobody;
  EXPECT_EQ(simulation.run(nobody).frames, 4U);  // as those of a whole run: 0, 0.7, 1.4, 1.5 s
  EXPECT_FALSE(std::filesystem::exists(results / "frame_0001.vtu"));
  EXPECT_TRUE(std::filesystem::exists(results / "frame_0002.vtu"));
  EXPECT_TRUE(std::filesystem::exists(results / "frame_0003.vtu"));
}

TEST_F(SavesACheckpoint, UnlessTheRunHasFailed) {
  fail_the_run();
  page.send(R"({"do":"checkpoint"})");
  EXPECT_THAT(page.until("error")["error"], HasSubstr("the run has failed; take the last action"));
  EXPECT_FALSE(std::filesystem::exists(file_));
}

TEST_F(SavesACheckpoint, ThatFitsItsSceneOnly) {
  act_and_save();
  stop();
  std::string other = beam;
  other.replace(other.find("[8, 4, 4]"), 9, "[9, 4, 4]");
  Scene scene = read_scene(folder_.write("other.json", other), {}, host(), diagnostics_);
  leave_out_results(scene);
  LiveRun run(scene, host(), diagnostics_, *server_, folder_ / "other.jsonl");
  Observer nobody;
  try {
    run.resume(read_checkpoint(file_), file_, nobody);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("beam-checkpoint.h5: it was written for a different mesh"));
  }
}

}  // namespace
}  // namespace suture::test
