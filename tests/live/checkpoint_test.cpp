// SPDX-License-Identifier: GPL-3.0-or-later
//
// Checkpoints that a page saves, and the runs that go on from them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kernel/base/error.hpp"
#include "kernel/live/hand.hpp"
#include "kernel/run/checkpoints.hpp"
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

/// A live run that goes on from a checkpoint, on a thread of its own, and a page.
class GoesOn {
 public:
  GoesOn(const Scene& scene, const std::filesystem::path& file, Diagnostics& diagnostics)
      : run(scene, host(), diagnostics, *server_, file.parent_path() / "second.jsonl") {
    Observer nobody;
    run.resume(read_checkpoint(file), file, nobody);
    thread_ = std::thread([&] { run.run(stop_); });
    EXPECT_TRUE(page.open());
  }
  ~GoesOn() { stop(); }
  void stop() {
    stop_.is_set = true;
    if (thread_.joinable()) thread_.join();
  }

 private:
  std::unique_ptr<LiveServer> server_ = open_live_server(0);
  Stop stop_;
  std::thread thread_;

 public:
  Client page{Address(server_->address())};
  LiveRun run;
};

// The scene begins at rest, and does what was done before and after the checkpoint.
TEST_F(SavesACheckpoint, AfterWhichASceneCanBeWritten) {
  make(20);
  page.send(cut);
  grab_and_pull();
  make(30);
  page.send(R"({"do":"checkpoint"})");
  message_with("saved ");
  stop();
  GoesOn second(scene_, file_, diagnostics_);
  second.page.send(R"({"do":"apply","event":{"pierce":{"where":{"nearest":[0.2,0.1,0.1]}}}})");
  for (int i = 0; i < 40; ++i) second.page.send(R"({"do":"step"})");
  second.page.send(R"({"do":"scene"})");
  const std::string text = second.page.until("scene")["scene"];
  second.stop();

  Scene written = read_scene(folder_.write("done.json", text), {}, host(), diagnostics_);
  EXPECT_EQ(written.events.size(), 4U);  // cut, grasp, release, pierce
  leave_out_results(written);
  Simulation same(written, host(), diagnostics_);
  Observer nobody;
  same.run(nobody);
  EXPECT_NEAR(same.time(), second.run.simulation().time(), 1e-12);
  EXPECT_LT(largest_difference(same, second.run.simulation()), 2e-3);  // m
}

TEST_F(SavesACheckpoint, WhichAloneSaysWhatWasDoneBefore) {
  stop();
  Simulation other(scene_, host(), diagnostics_);
  save_checkpoint(other, checkpoint_header(other.built(), host()), file_);
  GoesOn second(scene_, file_, diagnostics_);
  second.page.send(cut);
  second.page.send(R"({"do":"scene"})");
  EXPECT_THAT(second.page.until("error")["error"], HasSubstr("only those of suture live do"));
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
