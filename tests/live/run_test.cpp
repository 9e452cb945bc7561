// SPDX-License-Identifier: GPL-3.0-or-later
//
// Runs that a client controls, and what their recordings repeat.
#include <gmock/gmock.h>

#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "tests/live/watched.hpp"

namespace suture::test {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST_F(Watched, ShowsTheBodyAndItsObstacles) {
  EXPECT_EQ(greeting["elements"], 128);
  EXPECT_EQ(greeting["gravity"], Json({0, -9.8, 0}));
  EXPECT_EQ(greeting["obstacles"][0]["name"], "ball");
  const Json surface = page.until("corners");
  EXPECT_EQ(surface["corners"], 4);
  EXPECT_EQ(surface["faces"], 2 * 16 + 4 * 32);
  EXPECT_EQ(surface["points"], 2 * 16 + 4 * 32 + 2);  // Euler: each edge belongs to two faces
  EXPECT_EQ(surface["laid_open"], 0);
  const Json state = page.until("step");
  EXPECT_EQ(state["step"], 0);
  EXPECT_EQ(state["playing"], false);
  EXPECT_EQ(state["poses"][0], Json({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}));
}

TEST_F(Watched, PlaysPausesStepsAndStartsAgain) {
  page.send(R"({"do":"step"})");
  EXPECT_EQ(state_after(1)["step"], 1);
  page.send(R"({"do":"speed","value":0})");
  page.send(R"({"do":"play"})");
  state_after(200);
  page.send(R"({"do":"pause"})");
  const Json paused = state([](const Json& head) { return !head["playing"]; });
  page.send(R"({"do":"step"})");
  EXPECT_EQ(state_after(paused["step"].get<int>() + 1)["step"], paused["step"].get<int>() + 1);
  page.send(R"({"do":"reset"})");
  EXPECT_EQ(state([](const Json& head) { return head["step"] == 0; })["time"], 0);
}

TEST_F(Watched, FollowsTheWantedSpeed) {
  page.send(R"({"do":"speed","value":0.5})");
  page.send(R"({"do":"play"})");
  const auto start = std::chrono::steady_clock::now();
  const double time = state([](const Json& head) { return head["time"] > 0.3; })["time"];
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
  EXPECT_LT(time, 0.5 * spent.count() + 0.1);
}

TEST_F(Watched, RefusesWhatItDoesNotUnderstand) {
  for (const char* wrong :
       {"", "nonsense", "[]", "{}", "null", R"({"do":7})", R"({"do":"dance"})", R"({"do":"apply"})",
        R"({"do":"apply","event":{"cut":{}}})", R"({"do":"apply","event":{"release":"nobody"}})",
        R"({"do":"back","to":1e100})", R"({"do":"back","to":-1})",
        R"({"do":"apply","event":{"sweep":{"points":[[0,0,0]],"triangles":[[0,0,1e100]]}}})",
        R"({"do":"apply","event":{"sweep":{"points":[[0,0,0]],"triangles":[[0,0,1]]}}})",
        R"({"do":"field","name":"beauty"})", R"({"do":"speed","value":-1})", "\xff\xfe"}) {
    page.send(std::string(wrong) == "\xff\xfe" ? "\"" : wrong);
    const std::string error = page.until("error")["error"];
    EXPECT_FALSE(error.empty()) << wrong;
    EXPECT_EQ(error.find("json.exception"), std::string::npos) << error;
  }
  page.send(R"({"do":"grab","at":7})");
  EXPECT_THAT(page.until("error")["error"].get<std::string>(),
              HasSubstr(R"({"do":"grab","at":7}; expected {"do": "grab", "at": [x, y, z]})"));
  page.send(R"({"do":"graab"})");
  EXPECT_THAT(page.until("error")["error"].get<std::string>(), HasSubstr("did you mean 'grab'?"));
  page.send(R"({"do":"step"})");
  EXPECT_EQ(state_after(1)["step"], 1);
  stop();
  EXPECT_FALSE(std::filesystem::exists(recording()));
}

TEST_F(Watched, GoesOnWithoutItsPage) {
  page.send(R"({"do":"speed","value":0})");
  page.send(R"({"do":"play"})");
  const Json before = state_after(50);
  page.vanish();
  Client next{Address(server_->address())};
  ASSERT_TRUE(next.open());
  const auto later = before["step"].get<std::uint64_t>() + 500;
  while (next.until("step")["step"] < later) continue;
}

/// The beam as a program runs it.
struct ProgrammedRun {
  void apply(const std::string& event) {
    simulation.apply(read_event(event, "event", scene, diagnostics), nobody);
  }
  Index nearest(const Vec3& to) {
    Index best = 0;
    const auto off = [&](Index v) { return norm(minus(place(v), to)); };
    for (Index v = 0; v < simulation.attributes().vertex_count(); ++v)
      if (off(v) < off(best)) best = v;
    return best;
  }
  Vec3 place(Index v) {
    const Column& x = simulation.attributes().position();
    return {x.get(v, 0), x.get(v, 1), x.get(v, 2)};
  }

  TemporaryFolder folder;
  Diagnostics diagnostics;
  Scene scene = [&] {
    Scene read = read_scene(folder.write("beam.json", beam), {}, host(), diagnostics);
    leave_out_results(read);
    return read;
  }();
  Simulation simulation{scene, host(), diagnostics};
  Observer nobody;
};

TEST(MovedGrasp, GoesToItsTargetAndStaysThere) {
  ProgrammedRun run;
  run.simulation.run_to(0.1, run.nobody);
  run.apply(R"({"grasp":{"name":"hand","where":{"nearest":[0.5,0.25,0.125]}}})");
  const Index held = run.nearest({0.5, 0.25, 0.125});
  const Vec3 start = run.place(held);
  run.simulation.move_grasp("hand", {0, 0.04, 0}, 0.1);
  run.simulation.run_to(0.15, run.nobody);
  // Half of the way, to within a step.
  EXPECT_NEAR(run.place(held)[1], start[1] + 0.02, 0.4 * run.simulation.next_dt() + 1e-12);
  const Vec3 half = run.place(held);
  run.simulation.move_grasp("hand", {0.02, 0, 0}, 0.05);
  run.simulation.run_to(0.4, run.nobody);
  EXPECT_LT(norm(minus(run.place(held), plus(half, {0.02, 0, 0}))), 1e-15);
  EXPECT_LT(std::abs(run.simulation.balance()), 0.01);
  run.apply(R"({"release":"hand"})");
  run.simulation.run_to(0.5, run.nobody);
  EXPECT_GT(norm(minus(run.place(held), half)), 1e-3);
}

TEST(MovedGrasp, RefusesWhatCannotBe) {
  ProgrammedRun run;
  run.simulation.run_to(0.01, run.nobody);
  run.apply(R"({"grasp":{"name":"hand","where":{"nearest":[0.5,0.25,0.125]}}})");
  const std::string before = state_hash(run.simulation);
  EXPECT_THROW(run.simulation.move_grasp("foot", {0, 0.1, 0}, 0.1), InputError);
  EXPECT_THROW(run.simulation.move_grasp("hand", {0, NAN, 0}, 0.1), InputError);
  EXPECT_THROW(run.simulation.move_grasp("hand", {0, 0.1, 0}, 0), InputError);
  EXPECT_THROW(run.simulation.move_grasp("hand", {0, 0.1, 0}, INFINITY), InputError);
  EXPECT_EQ(state_hash(run.simulation), before);
}

TEST(Recordings, NameTheLineAtFault) {
  const TemporaryFolder folder;
  const std::string header =
      R"({"recording":1,"program":"p","isa":"base","file":"f","folder":"d","state":"0","scene":"{}"})"
      "\n";
  const auto message = [&](const std::string& text) -> std::string {
    try {
      read_recording(folder.write("r.jsonl", text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(header), "");
  EXPECT_EQ(message(header + R"({"step":3,"device":"page","value":{}})"
                             "\n"
                             R"({"step":)"),
            "");
  EXPECT_THAT(message(""), HasSubstr("no complete line"));
  EXPECT_THAT(message(R"({"recording":2})"
                      "\n"),
              HasSubstr("r.jsonl:1: it has version 2"));
  EXPECT_THAT(message(header + "nonsense\n"), HasSubstr("r.jsonl:2: "));
  EXPECT_THAT(message(header + R"({"step":-1,"device":"page","value":{}})"
                               "\n"),
              HasSubstr(":2: its step is not"));
  EXPECT_THAT(message(header + R"({"step":5,"device":"page","value":{}})"
                               "\n"
                               R"({"step":4,"device":"page","value":{}})"
                               "\n"),
              HasSubstr(":3: its step is before"));
  EXPECT_THAT(message(header + R"({"step":5,"end":true,"state":"1"})"
                               "\n"
                               R"({"step":6})"
                               "\n"),
              HasSubstr(":3: a line follows the end"));
}

TEST(Recordings, RefuseAnotherBody) {
  ProgrammedRun run;
  Recording recording;
  recording.start = "0123456789abcdef";
  EXPECT_THROW(repeat(recording, run.scene, run.simulation, run.nobody, run.diagnostics),
               InputError);
}

TEST_F(Watched, RecordsWhatRepeatsBitForBit) {
  page.send(cut);  // before a reset: no part of what is repeated
  page.until("message");
  page.send(R"({"do":"reset"})");
  state([](const Json& head) { return head["step"] == 0; });
  page.send(R"({"do":"speed","value":0})");
  page.send(R"({"do":"play"})");
  state_after(100);
  page.send(cut);
  EXPECT_THAT(page.until("message")["message"], HasSubstr("2 islands"));
  const Json surface = page.until("corners");
  EXPECT_GT(surface["laid_open"], 0);
  state_after(300);
  page.send(R"({"do":"grab","at":[0.4,0.25,0.1]})");
  EXPECT_THAT(page.until("message")["message"], HasSubstr("grasped"));
  state_after(400);
  page.send(R"({"do":"drag","to":[0.4,0.3,0.1]})");
  state_after(500);
  page.send(R"({"do":"drag","to":[0.35,0.3,0.1]})");
  state_after(700);
  page.send(R"({"do":"let_go"})");
  page.until("message");
  state_after(900);
  stop();

  const Recording recorded = read_recording(recording());
  ASSERT_EQ(recorded.inputs.size(), 5U);  // cut, grasp, two moves, release
  EXPECT_GE(recorded.last_step, 900U);
  expect_same_bits(recording());
}

// ------------------------------------------------------------------- failures --

/// The last quarter of a block is a piece of its own, in the air.
constexpr const char* with_piece = R"({
  "suture": 1,
  "mesh": {"box": {"size": [1, 0.25, 0.25], "cells": [8, 2, 2]}},
  "models": [{"model": "neo-hookean", "parameters": {"E": 4e5, "nu": 0.3, "rho": 1000}}],
  "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],
  "divisible": true,
  "events": [{"at": 0, "cut": {"plane": {"point": [0.875, 0, 0], "normal": [1, 0, 0]}}}],
  "solver": {"end": 100}
})";

class WithPiece : public Watched {
 protected:
  WithPiece() : Watched(with_piece) {}
  /// Presses the outer nodes of the piece through it.
  std::string fail_at_the_piece() {
    step(100);
    state_at(100);
    page.send(R"({"do":"grab","at":[1.05,0.125,0.125]})");
    page.send(
        R"({"do":"apply","event":{"move":{"grasp":"live-hand","translation":[-50,0,0],"during":0.001}}})");
    page.send(R"({"do":"play"})");
    return page.until("error")["error"];
  }
};

TEST_F(WithPiece, WhatFailedIsRemovedAndTheRunGoesOn) {
  EXPECT_THAT(fail_at_the_piece(),
              HasSubstr("The run has failed: a piece of 7.81e+03 ml (4 elements) collapsed."));
  const Json failed = state([](const Json& head) { return head.contains("remedy"); });
  EXPECT_EQ(failed["remedy"], "remove a piece of 7.81e+03 ml (4 elements) and go on");
  page.send(R"({"do":"drag","to":[1,0,0]})");  // says no more
  page.send(R"({"do":"remove_piece"})");
  EXPECT_THAT(page.until("message")["message"].get<std::string>(), Not(HasSubstr("failed")));
  const Json goes_on = state([](const Json& head) { return head["step"] >= 300; });
  EXPECT_FALSE(goes_on.contains("remedy"));
  page.send(R"({"do":"pause"})");
  state([](const Json& head) { return !head["playing"]; });
  stop();
  const Recording recorded = read_recording(recording());
  EXPECT_TRUE(recorded.failure.empty());
  EXPECT_THAT(recorded.inputs.back().value, HasSubstr("remove_islands"));
  expect_same_bits(recording());
}

TEST_F(WithPiece, TheRecordingOfAFailureFailsAgain) {
  fail_at_the_piece();
  stop();
  const Recording recorded = read_recording(recording());
  EXPECT_THAT(recorded.failure, HasSubstr("collapsed; \"debris\" removes such pieces"));
  std::vector<std::string> warnings;
  EXPECT_THROW(repeated_end(recording(), "1", false, warnings), NumericalError);
}

TEST_F(WithPiece, NothingIsRemovedWithoutAFailure) {
  page.send(R"({"do":"remove_piece"})");
  EXPECT_THAT(page.until("error")["error"].get<std::string>(), HasSubstr("has not failed"));
}

}  // namespace
}  // namespace suture::test
