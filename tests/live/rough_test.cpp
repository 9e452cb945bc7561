// SPDX-License-Identifier: GPL-3.0-or-later
//
// What clients cannot do to a run, whatever they send and however they leave.
#include <fstream>
#include <random>

#include "tests/base/sanitizer.hpp"
#include "tests/live/watched.hpp"

namespace suture::test {
namespace {

using namespace std::chrono_literals;
using Failure = boost::system::system_error;

/// Printed, and taken from SUTURE_SEED if that is set.
unsigned seed() {
  const char* given = std::getenv("SUTURE_SEED");
  const unsigned seed = given ? unsigned(std::strtoul(given, nullptr, 10)) : std::random_device{}();
  std::printf("SUTURE_SEED=%u\n", seed);
  return seed;
}

constexpr const char* good_inputs[] = {
    R"({"do":"play"})",
    R"({"do":"pause"})",
    R"({"do":"step"})",
    R"({"do":"reset"})",
    R"({"do":"back"})",
    R"({"do":"back","to":1})",
    R"({"do":"keep","name":"here"})",
    R"({"do":"speed","value":0.5})",
    R"({"do":"field","name":"von_mises"})",
    R"({"do":"grab","at":[0.4,0.25,0.1]})",
    R"({"do":"take","tool":"ball","at":[0.5,0.4,0.1]})",
    R"({"do":"drag","to":[0.4,0.3,0.1]})",
    R"({"do":"let_go"})",
    R"({"do":"apply","event":{"cut":{"plane":{"point":[0.5,0,0],"normal":[1,0,0]}}}})",
    R"({"do":"apply","event":{"grasp":{"name":"g","where":{"nearest":[0.5,0.2,0.1]}}}})",
    R"({"do":"apply","event":{"release":"g"}})",
    R"({"do":"apply","event":{"move":{"grasp":"g","translation":[0,0.1,0],"during":0.1}}})",
    R"({"do":"apply","event":{"steer":{"obstacle":"ball","translation":[0,0.1,0],"during":0.1}}})",
    R"({"do":"apply","event":{"gravity":[0,-9,0]}})",
    R"({"do":"apply","event":{"parameters":{"model":"tm-faure","values":{"E":3e5}}}})",
};
constexpr const char* pieces[] = {"{",    "}",     "[",  "]",   ",",    ":",    "\"",  "null",
                                  "1e99", "1e999", "-1", "0.3", "true", "[[[[", "\\u", "\"do\""};

class Fuzzer {
 public:
  explicit Fuzzer(unsigned seed) : random_(seed) {}
  std::size_t below(std::size_t n) { return random_() % n; }
  std::string bytes(std::size_t size) {
    std::string text(size, ' ');
    for (char& c : text) c = static_cast<char>(random_());
    return text;
  }
  /// An input with some mistakes, or none.
  std::string input() {
    std::string text = good_inputs[below(std::size(good_inputs))];
    for (std::size_t n = below(4); n > 0; --n) {
      const std::size_t at = below(text.size() + 1), length = below(8);
      switch (below(5)) {
        case 0:
          text.erase(at, length);
          break;
        case 1:
          text.insert(at, pieces[below(std::size(pieces))]);
          break;
        case 2:
          text.replace(at, length, pieces[below(std::size(pieces))]);
          break;
        case 3:
          text.insert(at, text.substr(at, length));
          break;
        default:
          text.replace(at, length, std::string(1, static_cast<char>(32 + below(95))));
      }
    }
    return text;
  }

 private:
  std::mt19937 random_;
};

/// The threads of this process.
std::size_t threads() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (std::size_t count = 0; word == "Threads:" && status >> count) return count;
  return 0;
}
std::size_t open_files() {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& file : std::filesystem::directory_iterator("/proc/self/fd"))
    ++count;
  return count;
}
double resident_megabytes() {
  std::ifstream status("/proc/self/statm");
  double pages = 0;
  status >> pages >> pages;
  return pages * 4096 / 1e6;
}

class Rough : public Watched {
 protected:
  /// Waits until the number of open files is that of before.
  void expect_all_closed(std::size_t before) {
    for (int i = 0; i < 1000 && open_files() > before; ++i) std::this_thread::sleep_for(5ms);
    EXPECT_EQ(open_files(), before);
  }
  void expect_steps() {
    page.send(R"({"do":"reset"})");
    page.send(R"({"do":"step"})");
    state([](const Json& head) { return head["step"] == 1; });
  }
  Address address{server_->address()};
};

TEST_F(Rough, GoesOnAfterAnyInput) {
  Fuzzer fuzzer(seed());
  for (int i = 0; i < 100; ++i) {
    for (int k = 0; k < 10; ++k) page.send(fuzzer.input());
    if (i % 10 == 0) page.send_bytes(fuzzer.bytes(fuzzer.below(1000)));
    const std::string mark = "mark " + std::to_string(i);  // else what is said remains unread
    page.send(Json{{"do", mark}}.dump());
    while (page.until("error")["error"].get<std::string>().find(mark) == std::string::npos)
      continue;
  }
  stop();
  if (!std::filesystem::exists(recording())) return;
  const std::string end = read_recording(recording()).end;
  std::vector<std::string> warnings;  // of the inputs
  if (end.empty()) return;            // the run has failed
  EXPECT_EQ(repeated_end(recording(), "2", false, warnings), end);
}

TEST_F(Rough, GoesOnAfterAnyBytes) {
  Fuzzer fuzzer(seed());
  const std::size_t before = open_files();
  const std::string request = "GET " + address.path + "socket HTTP/1.1\r\nHost: " + address.host() +
                              "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                              "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
                              "Sec-WebSocket-Version: 13\r\n\r\n";
  for (int i = 0; i < 100; ++i) try {
      Client client(address);
      std::string text = request;
      for (std::size_t n = fuzzer.below(3); n > 0; --n)
        text.replace(fuzzer.below(text.size()), 1, fuzzer.bytes(fuzzer.below(3)));
      client.send_raw(i % 4 == 0 ? fuzzer.bytes(500) : text);
      client.send_raw(fuzzer.bytes(fuzzer.below(200)));  // frames
      if (i % 2 == 0) client.vanish();
    } catch (const Failure&) {  // it was cut off
    }
  for (int i = 0; i < 20; ++i) try {
      Client client(address);
      ASSERT_TRUE(client.open());
      for (int k = 0; k < 10; ++k) client.send(fuzzer.bytes(1 + fuzzer.below(50)));  // no UTF-8
    } catch (const Failure&) {
    }
  expect_all_closed(before);
  expect_steps();
}

// Neither files nor threads nor memory of those who have left remain.
TEST_F(Rough, ForgetsViewersThatVanish) {
  page.send(R"({"do":"play"})");
  state_after(1);
  const std::size_t files = open_files(), running = threads();
  double memory = 0;
  for (int round = 0; round < 20; ++round) {
    std::vector<std::unique_ptr<Client>> viewers;
    for (int i = 0; i < 10; ++i) {
      viewers.push_back(std::make_unique<Client>(address));
      ASSERT_TRUE(viewers.back()->open());
    }
    for (std::size_t i = 0; i < viewers.size(); ++i)
      if (i % 2 == 0) viewers[i]->until("step");
    const auto step = page.until("step")["step"].get<std::uint64_t>();
    state_after(step + 1);
    for (auto& viewer : viewers) viewer->vanish();
    if (round == 4) memory = resident_megabytes();
  }
  expect_all_closed(files);
  EXPECT_EQ(threads(), running);
  if (sanitizer.empty()) {
    EXPECT_LT(resident_megabytes() - memory, 5);
  }
  const auto step = page.until("step")["step"].get<std::uint64_t>();
  state_after(step + 100);
}

}  // namespace
}  // namespace suture::test
