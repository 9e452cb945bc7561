// SPDX-License-Identifier: GPL-3.0-or-later
//
// Devices: what their hands move in a run and feel of it, and what is wrong with them.
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "tests/live/watched.hpp"

namespace suture::test {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

/// The beam below a ball that hangs on a spring.
const std::string& beam_and_tool() {
  static const std::string text = [] {
    std::string beam_text = beam;
    const std::string end = R"("radius": 0.1})";
    beam_text.insert(beam_text.find(end) + end.size(),
                     R"(, "coupling": {"mass": 0.5, "stiffness": 2000})");
    return beam_text;
  }();
  return text;
}

/// The other end of a socket of poses.
class Hand {
 public:
  Hand() {
    sockaddr_un address{.sun_family = AF_UNIX, .sun_path = {}};
    path().copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(listen(listener_, 1), 0);
  }
  ~Hand() {
    leave();
    close(listener_);
  }
  std::string path() const { return (folder_ / "hand").string(); }
  void accept() { socket_ = ::accept(listener_, nullptr, nullptr); }
  void leave() {
    if (socket_ >= 0) close(socket_);
    socket_ = -1;
  }
  void send(const std::string& line) { send_bytes(line + "\n"); }
  void send_bytes(const std::string& text) {
    EXPECT_EQ(::send(socket_, text.data(), text.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(text.size()));
  }
  /// From one position to another, m, in so many milliseconds.
  void move(const Vec3& from, const Vec3& to, int ms, int buttons = 0) {
    for (int i = 1; i <= ms; ++i) {
      const Vec3 at = plus(from, scaled(i / double(ms), minus(to, from)));
      std::ostringstream line;
      line << "0 " << at[0] << ' ' << at[1] << ' ' << at[2] << " 0 0 0 " << buttons;
      send(line.str());
      std::this_thread::sleep_for(1ms);
    }
  }
  /// Those that have come since the last call.
  std::vector<Vec3> forces() {
    std::string text;
    char part[4096];
    for (ssize_t got = 0; (got = recv(socket_, part, sizeof part, MSG_DONTWAIT)) > 0;)
      text.append(part, static_cast<std::size_t>(got));
    std::vector<Vec3> found;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      std::istringstream numbers(line);
      Vec3 force{};
      numbers >> force[0] >> force[1] >> force[2];
      if (numbers) found.push_back(force);
    }
    return found;
  }

 private:
  TemporaryFolder folder_;
  int listener_ = socket(AF_UNIX, SOCK_STREAM, 0), socket_ = -1;
};

class InHand : private Hand, public Watched {
 protected:
  InHand(const char* scene, const std::string& hold)
      : Watched(scene, "poses:" + Hand::path(), hold) {
    hand.accept();
    page.send(R"({"do":"play"})");
    state_after(1);
  }
  Hand& hand = *this;
};

class ToolInHand : public InHand {
 protected:
  ToolInHand() : InHand(beam_and_tool().c_str(), "") {}
};

class BodyInHand : public InHand {
 protected:
  BodyInHand() : InHand(beam, "") {}
};

class ObstacleInHand : public InHand {
 protected:
  ObstacleInHand() : InHand(beam, "ball") {}
};

/// Why a device cannot be used; "" if it can.
std::string refusal(const std::string& device) {
  try {
    Device open(device);
  } catch (const PluginError& error) {
    return error.what();
  }
  return "";
}

/// What a device says when it sends nothing more.
std::string problem_of(Device& device) {
  std::string problem;
  for (int i = 0; i < 3000 && (problem = device.take_problem()).empty(); ++i)
    std::this_thread::sleep_for(1ms);
  return problem;
}

bool comes_from_device(const RecordedInput& input) { return input.device == "poses"; }

TEST_F(ToolInHand, PushesTheBodyAndIsPushed) {
  hand.move({}, {0, -0.12, 0}, 300);  // 0.07 m into the beam
  const Json pressed = state([](const Json& head) {
    return head["device"]["place"][1] < 0.281 && head["device"]["force"][1] > 5;
  });
  EXPECT_EQ(pressed["device"]["name"], "poses");
  hand.forces();
  std::vector<Vec3> forces;
  const auto end = std::chrono::steady_clock::now() + 1s;
  while (std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(5ms);
    std::ranges::copy(hand.forces(), std::back_inserter(forces));
  }
  EXPECT_GT(forces.size(), 500U);
  EXPECT_LT(forces.size(), 1100U);
  EXPECT_GT(forces.back()[1], 5);
  const Json later = state_after(pressed["step"].get<std::uint64_t>() + 200);
  EXPECT_GT(later["device"]["poses_per_second"], 500);
  EXPECT_GT(later["device"]["exchanges_per_second"], 50);
  EXPECT_EQ(later["device"]["rotation"], Json({0, 0, 0}));
  hand.move({0, -0.12, 0}, {0.05, 0, 0}, 100);
  hand.send("0 0.05 0 0 0 0 0.3 0");
  state([](const Json& head) { return head["device"]["rotation"][2] > 0.2; });
  state([](const Json& head) { return std::abs(head["device"]["force"][1].get<double>()) < 5; });
  stop();
  EXPECT_GT(std::ranges::count_if(read_recording(recording()).inputs, comes_from_device), 50);
  expect_same_bits(recording());
}

TEST_F(ToolInHand, FeelsNothingWhileTheRunIsPausedAndDoesNotJumpAfterwards) {
  page.send(R"({"do":"pause"})");
  const Json paused = state([](const Json& head) { return !head["playing"]; });
  hand.move({}, {0, -0.12, 0}, 50);
  std::this_thread::sleep_for(50ms);
  hand.forces();
  std::this_thread::sleep_for(50ms);
  for (const Vec3& force : hand.forces()) EXPECT_EQ(force, Vec3{});
  page.send(R"({"do":"play"})");
  const Json later = state_after(paused["step"].get<std::uint64_t>() + 20);
  EXPECT_EQ(later["device"]["place"], paused["device"]["place"]);
}

TEST_F(ObstacleInHand, MovesAsNamed) {
  hand.move({}, {0, -0.1, 0.01}, 300);
  state([](const Json& head) { return head["device"]["force"][1] > 1; });
  hand.leave();
  EXPECT_THAT(page.until("warning")["warning"],
              HasSubstr("device 'poses' has stopped sending: its poses ended after 300 lines"));
  stop();
  expect_same_bits(recording());
}

TEST_F(BodyInHand, IsGraspedAndPulled) {
  hand.move({}, {}, 20, 1);
  EXPECT_THAT(page.until("message")["message"], HasSubstr("grasped"));
  hand.move({}, {0, 0.05, 0}, 300, 1);
  state([](const Json& head) { return head["device"]["force"][1] < -20; });
  hand.move({0, 0.05, 0}, {0, 0.05, 0}, 20, 0);
  EXPECT_THAT(page.until("message")["message"], HasSubstr("released"));
  state([](const Json& head) { return head["device"]["force"][1] == 0; });
  stop();
  expect_same_bits(recording());
}

// Its own hold is part of the state: it goes on while the button is down, or ends by an input.
TEST_F(BodyInHand, HoldsAgainWhatItHeldWhereTheRunGoesBack) {
  const auto pause = [&] {
    page.send(R"({"do":"pause"})");
    return state([](const Json& head) { return !head["playing"]; });
  };
  const auto back = [&](const Json& id) {
    page.send(Json{{"do", "back"}, {"to", id}}.dump());
    for (;;)
      if (const Json kept = page.until("kept")["kept"]; !kept.empty()) return kept.back()["id"];
  };
  hand.move({}, {}, 20, 1);
  EXPECT_THAT(page.until("message")["message"], HasSubstr("grasped"));
  hand.move({}, {0, 0.03, 0}, 300, 1);
  state([](const Json& head) { return head["device"]["force"][1] < -5; });
  const Json held = pause();
  page.send(R"({"do":"keep","name":"held"})");
  Json id = page.until("kept")["kept"].back()["id"];
  page.send(R"({"do":"play"})");
  hand.move({0, 0.03, 0}, {0.2, -0.2, 0}, 50, 0);
  EXPECT_THAT(page.until("message")["message"], HasSubstr("released"));
  pause();

  id = back(id);
  Json now = state([&](const Json& head) { return head["step"] == held["step"]; });
  EXPECT_EQ(now["device"]["place"], held["device"]["place"]);
  page.send(R"({"do":"play"})");  // with the button up
  while (page.until("message")["message"].get<std::string>().find("released") == std::string::npos)
    continue;
  pause();

  back(id);
  hand.move({}, {0, 0, 0}, 20, 1);  // pressed while paused
  std::this_thread::sleep_for(20ms);
  page.send(R"({"do":"play"})");
  state([](const Json& head) -> bool { return head["playing"]; });  // moves count from now on
  hand.move({}, {0, 0.02, 0}, 200, 1);
  now = state_after(held["step"].get<std::uint64_t>() + 500);
  EXPECT_NEAR(now["device"]["place"][1].get<double>(),
              held["device"]["place"][1].get<double>() + 0.02, 1e-6);
  EXPECT_LT(now["device"]["force"][1], -500);  // N: about twice that
  stop();
  const Recording recorded = read_recording(recording());
  EXPECT_EQ(std::ranges::count_if(
                recorded.inputs,
                [](const RecordedInput& input) { return input.value.starts_with(R"({"grasp")"); }),
            1);
  expect_same_bits(recording());
}

TEST(DeviceHands, MoveNoFasterThanTheBodyCanFollow) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  const Scene scene =
      read_scene(folder.write("beam.json", beam_and_tool()), {}, host(), diagnostics);
  Simulation simulation(scene, host(), diagnostics);
  constexpr double edge = 0.05, dt = 1e-3;
  DeviceHand of_hand(simulation, "", edge);
  EXPECT_EQ(of_hand.input({}, 1, dt), "");
  const Json far = Json::parse(of_hand.input({{1, 0, 0}, {}, 0, 0}, 3, dt))["steer"];
  EXPECT_NEAR(far["translation"][0].get<double>(), 3 * hand_reach * edge, 1e-15);
  EXPECT_EQ(far["during"], 3 * dt);
  const Json turned = Json::parse(of_hand.input({{}, {0, 0, 1e-3}, 0, 0}, 3, dt))["steer"];
  EXPECT_NEAR(turned["rotation"][2].get<double>(), 1e-3, 1e-15);
  EXPECT_THROW(DeviceHand(simulation, "bal", edge), InputError);
}

// What the hand feels between two exchanges is the spring of its tool.
TEST(FeltForces, FollowTheHandAtOnce) {
  FeltForce felt;
  felt.force = {1, 2, 3};
  felt.at.position[1] = 0.1;
  felt.at.rotation[2] = 0.2;
  felt.stiffness = 500;
  felt.turning_stiffness = 2;
  const auto now = felt.at_pose({{0, 0.09, 0}, {0, 0, 0.3}, 0, 0});
  EXPECT_NEAR(now.force[0], 1, 1e-12);
  EXPECT_NEAR(now.force[1], 2 + 500 * 0.01, 1e-12);
  EXPECT_NEAR(now.torque[2], -2 * 0.1, 1e-12);
}

TEST(Poses, AreThoseOfAFileInTime) {
  const TemporaryFolder folder;
  const auto file = folder.write("path.txt", "# a path\n0 1 2 3 0.1 0.2 0.3 5\n\n0.2, 4, 5, 6\n");
  Device device("poses:" + file.string());
  EXPECT_EQ(device.name(), "poses");
  const auto wait_for = [&](double x) {
    for (int i = 0; i < 1000 && device.pose().position[0] != x; ++i)
      std::this_thread::sleep_for(1ms);
    return device.pose();
  };
  const auto start = std::chrono::steady_clock::now();
  const suture_device_pose first = wait_for(1), last = wait_for(4);
  EXPECT_EQ(first.rotation[2], 0.3);
  EXPECT_EQ(first.buttons, 5U);
  EXPECT_EQ(last.position[2], 6);
  EXPECT_EQ(last.rotation[2], 0);
  EXPECT_GT(std::chrono::steady_clock::now() - start, 150ms);
  EXPECT_THAT(problem_of(device), HasSubstr("its poses ended after 4 lines"));
  EXPECT_EQ(device.take_problem(), "");
}

#ifdef HAS_SPACEMOUSE
// With what spacenavd would send: eight numbers of 32 bits.
TEST(Spacemouse, SumsUpDeflections) {
  Hand daemon;
  setenv("SPNAV_SOCKET", daemon.path().c_str(), 1);
  Device device("spacemouse:0.1");
  daemon.accept();
  const auto tell = [&](const std::array<std::int32_t, 8>& event) {
    daemon.send_bytes({reinterpret_cast<const char*>(event.data()), sizeof event});
  };
  tell({0, 350, 0, -175});  // x and z
  tell({1, 2});             // button 2 is down
  for (int i = 0; i < 1000 && device.pose().position[0] < 0.01; ++i)
    std::this_thread::sleep_for(1ms);
  const suture_device_pose pose = device.pose();
  EXPECT_GT(pose.position[0], 0.01);
  EXPECT_EQ(pose.position[1], 0);
  EXPECT_NEAR(pose.position[2], -pose.position[0] / 2, 1e-3);
  EXPECT_EQ(pose.buttons, 4U);
  daemon.leave();
  EXPECT_THAT(problem_of(device), HasSubstr("spacenavd has ended the connection"));
}
#endif

TEST(Poses, NameTheLineAtFault) {
  const TemporaryFolder folder;
  for (const char* wrong : {"0 1 2\n", "0 1 2 3 0 0 0 -1\n", "0 a b c\n", "1 2 3 4 5 6 7 8 9\n"}) {
    Device device("poses:" + folder.write("path.txt", std::string("0 0 0 0\n") + wrong).string());
    EXPECT_THAT(problem_of(device), HasSubstr("line 2 is not 'seconds x y z rx ry rz buttons'"))
        << wrong;
  }
}

std::string bad(const std::string& name) { return BAD_DEVICES "/" + name + ".so"; }

TEST(Devices, AreRefusedWithAReason) {
  EXPECT_THAT(refusal("pose:x"), HasSubstr("no device 'pose' (did you mean 'poses'?)"));
  EXPECT_THAT(refusal("nowhere.so"), HasSubstr("nowhere.so: no such file"));
  EXPECT_THAT(refusal("poses"), HasSubstr("poses:PATH"));
  EXPECT_THAT(refusal("poses:/no/such/file"),
              HasSubstr("cannot open /no/such/file: No such file or directory"));
  EXPECT_THAT(refusal(bad("no_symbol")), HasSubstr("it exports no function suture_device_v1"));
  EXPECT_THAT(refusal(bad("other_version")), HasSubstr("built for version 7 of suture/device.h"));
  EXPECT_THAT(refusal(bad("short_table")), HasSubstr("its table has 16 bytes"));
  EXPECT_THAT(refusal(bad("incomplete")),
              HasSubstr("lacks a name, or one of open, read and close"));
  EXPECT_THAT(refusal(bad("closed") + ":there"),
              HasSubstr("device 'bad' cannot be opened: 'there' is out of reach"));
  const TemporaryFolder folder;
  EXPECT_THAT(refusal(folder.write("text.so", "not a library").string()),
              HasSubstr("it cannot be loaded"));
}

TEST(Devices, SayThatTheyStop) {
  Device quiet(bad("quiet")), hanging(bad("hanging"));
  EXPECT_THAT(problem_of(quiet), HasSubstr("has stopped sending: the cable is gone"));
  EXPECT_THAT(problem_of(hanging), HasSubstr("has not answered for 1 s"));
}

TEST(Devices, SendNoPoseThatIsNotFinite) {
  Device device(bad("wild"));
  std::this_thread::sleep_for(20ms);
  EXPECT_EQ(device.pose().position[0], 0);
}

}  // namespace
}  // namespace suture::test
