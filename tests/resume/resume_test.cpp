// SPDX-License-Identifier: GPL-3.0-or-later
//
// A run that is stopped and resumed leaves the same bytes as an uninterrupted run.
//   SUTURE_FULL=1            all stops; otherwise one or two of every fourth kind, at random
//   SUTURE_RESUME_SEED=N     these stops; otherwise others in each run
//   SUTURE_RESUME_CASE=NAME  this one alone, "cut-3"
//   SUTURE_RESUME_OUT=FOLDER keeps the files of those that fail
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iostream>

#include "kernel/base/error.hpp"
#include "kernel/output/checkpoint_file.hpp"
#include "tests/base/sanitizer.hpp"
#include "tests/base/variable.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/resume/process.hpp"

namespace suture::test {
namespace {

namespace fs = std::filesystem;

#ifdef NDEBUG
constexpr bool is_slow = !sanitizer.empty();
#else
constexpr bool is_slow = true;
#endif

std::uint64_t seed() {
  static const std::uint64_t chosen = seed_of_variable("SUTURE_RESUME_SEED");
  return chosen;
}

std::vector<Kind>& kinds() {
  static std::vector<Kind> all = all_kinds();
  return all;
}

/// One case, run once without a stop; then stopped in one of four ways.
class Stops {
 public:
  Stops(const Kind& kind, unsigned index)
      : random_(seed(), kind.name, index),
        case_(kind.make(random_, index, seed())),
        way_(static_cast<int>(random_.between(0, 4))) {
    write_case(case_, files());
    whole_ = run_here(case_, files(), whole(), {threads()});
  }

  void make() {
    if (whole_.code == 3 || whole_.code == 4) {
      ADD_FAILURE() << "not run: " << whole_.end;
      return;
    }
    const auto reports = [&](const std::string& message) {
      return message.find(case_.reports) != std::string::npos;
    };
    if (!case_.reports.empty()) {
      EXPECT_TRUE(std::ranges::any_of(whole_.messages, reports)) << story() << case_.reports;
    }
    switch (way_) {
      case 0:
        return pass_by();
      case 1:
        return stop_here();
      case 2:
        return stop_program(SIGTERM);
      default:
        return stop_program(SIGKILL);
    }
  }

  std::string story() const {
    return case_.name + ", " + std::to_string(whole_.steps) + " steps: " + story_;
  }
  unsigned stops() const { return stops_; }
  void keep(const fs::path& to) const {
    fs::create_directories(to);
    fs::copy(folder_.path(), to,
             fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  }

 private:
  fs::path files() const { return folder_ / "case"; }
  fs::path whole() const { return folder_ / "whole"; }
  unsigned threads() { return random_.pick(std::vector<unsigned>{1, 2, 3, 8}); }
  void say(const std::string& text) { story_ += text + "; "; }

  /// One of the questions whether to stop: anywhere, or where something happens.
  std::uint64_t some_question() {
    const auto last = static_cast<double>(std::max<std::uint64_t>(whole_.questions, 2) - 1);
    if (whole_.reported_at.empty() || random_.chance(0.5))
      return static_cast<std::uint64_t>(random_.between(0, last));
    const double near = static_cast<double>(random_.pick(whole_.reported_at));
    return static_cast<std::uint64_t>(std::clamp(near + random_.between(-70, 10), 0.0, last));
  }

  void expect_same(const fs::path& out) {
    const std::string found = difference(whole(), out);
    EXPECT_EQ(found, "") << story();
  }
  void expect_same(const Ran& ran, const fs::path& out) {
    expect_same(out);
    EXPECT_EQ(ran.end, whole_.end) << story();
    // Messages of the steps that are left.
    const std::size_t left = ran.messages.size(), all = whole_.messages.size();
    ASSERT_LE(left, all) << story() << "last message: " << ran.messages.back();
    for (std::size_t i = 0; i < left; ++i)
      EXPECT_EQ(ran.messages[i], whole_.messages[all - left + i]) << story();
  }

  Ran resume(const fs::path& out, const fs::path& checkpoint, std::uint64_t every) {
    ++stops_;
    Way way{threads(), true, every};
    way.resume = checkpoint;
    say("resumed from " + checkpoint.filename().string() + " with " + std::to_string(way.threads) +
        " threads");
    return run_here(case_, files(), out, way);
  }

  /// Checkpoints are written while the run continues.
  void pass_by() {
    const fs::path out = folder_ / "out";
    const auto questions = std::max<std::uint64_t>(whole_.questions, 2);
    const std::uint64_t every = std::max(some_question(), questions / 25 + 1);
    say("every " + std::to_string(every) + " steps");
    expect_same(run_here(case_, files(), out, {threads(), true, every}), out);
    const std::vector<std::uint64_t> numbers = checkpoints_in(out);
    if (numbers.empty()) return;
    const fs::path checkpoint = out / checkpoint_name(random_.pick(numbers));
    for (int i = 0; i < 2; ++i) expect_same(resume(out, checkpoint, every), out);
  }

  void stop_here() {
    const fs::path out = folder_ / "out";
    Way way{threads(), true};
    if (whole_.questions_within > 0 && random_.chance(0.7)) {
      way.give_up = static_cast<std::uint64_t>(
          random_.between(0, static_cast<double>(whole_.questions_within - 1)));
      say("gave up a step at question " + std::to_string(*way.give_up));
    } else {
      way.stop = some_question();
      say("stopped at " + std::to_string(*way.stop));
    }
    Ran ran = run_here(case_, files(), out, way);
    while (ran.was_stopped) {
      ++stops_;
      way = {threads(), true};
      way.resume = newest_checkpoint(out);
      ASSERT_NE(way.resume, "") << story();
      if (random_.chance(0.4))
        way.stop =
            static_cast<std::uint64_t>(random_.between(0, static_cast<double>(whole_.questions)));
      say("resumed from " + way.resume.filename().string() + " with " +
          std::to_string(way.threads) + " threads" +
          (way.stop ? ", stopped " + std::to_string(*way.stop) + " later" : ""));
      ran = run_here(case_, files(), out, way);
    }
    expect_same(ran, out);
    if (const fs::path checkpoint = newest_checkpoint(out); !checkpoint.empty())
      expect_same(resume(out, checkpoint, 0), out);
  }

  void stop_program(int signal) {
    const fs::path folder = folder_ / "program", out = folder / "out";
    Case with = case_;
    with.scene["solver"]["threads"] = threads();
    Json& checkpoint = with.scene["checkpoint"] = Json::object();
    double count = 0;
    if (signal == SIGKILL) {
      const auto few = static_cast<std::uint64_t>(random_.decades(3, 60));
      const std::uint64_t every = std::max(std::uint64_t{1}, whole_.steps / few);
      checkpoint["every_steps"] = every;
      checkpoint["keep"] = 1 + static_cast<int>(random_.between(0, 3));
      count = static_cast<double>(whole_.steps / every);
      say("every " + std::to_string(every) + " steps");
    }
    write_case(with, files());  // which is where the mesh is said to be
    fs::create_directories(folder);
    const std::string scene = (files() / "scene.json").string();
    std::vector<std::string> arguments{"run", scene};
    if (!case_.skips) arguments.insert(arguments.begin() + 1, "--no-skip");
    for (int i = 0;; ++i) {
      const Child child(folder, arguments);
      const bool stops = i == 0 || (i < 4 && random_.chance(0.4));
      if (stops) child.send(signal, random_.number() * (whole_.seconds + 0.005 * count));
      const int code = child.wait();
      if (code < 128) {
        EXPECT_EQ(code, whole_.code) << story() << read_text(folder / ".err");
        return expect_same(out);
      }
      ASSERT_TRUE(stops) << story() << "ended by signal " << code - 128;
      const fs::path newest = newest_checkpoint(out);
      arguments = {"run", scene};
      if (!newest.empty()) {
        ++stops_;
        const unsigned number = threads();
        arguments = {"run", "--resume", "out/" + newest.filename().string(), "--set",
                     "/solver/threads=" + std::to_string(number)};
        say("signal " + std::to_string(signal) + ", resumed from " + newest.filename().string() +
            " with " + std::to_string(number) + " threads");
      }
      if (!case_.skips) arguments.insert(arguments.begin() + 1, "--no-skip");
    }
  }

  TemporaryFolder folder_;
  Random random_;
  Case case_;
  int way_;
  Ran whole_;
  std::string story_;
  unsigned stops_ = 0;
};

class Resume : public ::testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Kind, Resume, ::testing::Range(0u, unsigned(kinds().size())),
                         [](const auto& kind) {
                           std::string name = kinds()[kind.param].name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST_P(Resume, LeavesTheBytesOfARunThatWasNotStopped) {
  const Kind& kind = kinds()[GetParam()];
  std::cout << "seed " << seed() << '\n';
  const bool full = !is_slow && !value_of_variable("SUTURE_FULL").empty();
  const std::string only = value_of_variable("SUTURE_RESUME_CASE"),
                    out = value_of_variable("SUTURE_RESUME_OUT");
  const bool drawn = !value_of_variable("SUTURE_RESUME_SEED").empty() || seed() % 4 == 0;
  if (!full && only.empty() && !drawn) {
    std::cout << kind.name << " is not drawn this time\n";
    return;
  }
  unsigned stops = 0;
  for (unsigned index = 0; index < 1000; ++index) {
    const std::string name = kind.name + '-' + std::to_string(index);
    if (only.empty() ? index >= (full ? kind.stops_full : kind.stops) : only != name) continue;
    Stops run(kind, index);
    const int before =
        ::testing::UnitTest::GetInstance()->current_test_info()->result()->total_part_count();
    run.make();
    const int after =
        ::testing::UnitTest::GetInstance()->current_test_info()->result()->total_part_count();
    stops += run.stops();
    if (after == before && only.empty()) continue;
    std::cout << name << ", SUTURE_RESUME_SEED=" << seed() << ": " << run.story() << '\n';
    if (!out.empty()) run.keep(fs::path(out) / name);
  }
  std::cout << kind.name << ": " << stops << " stops\n";
}

}  // namespace
}  // namespace suture::test
