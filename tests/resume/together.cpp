// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/resume/together.hpp"

#include <algorithm>
#include <stdexcept>

#include "kernel/output/checkpoint_file.hpp"
#include "tests/base/variable.hpp"

namespace suture::test {

namespace fs = std::filesystem;

std::uint64_t scenes_seed() {
  static const std::uint64_t chosen = seed_of_variable("SUTURE_PROCESSES_SEED");
  return chosen;
}

bool is_full() { return !value_of_variable("SUTURE_FULL").empty(); }

std::string only() { return value_of_variable("SUTURE_PROCESSES_CASE"); }
bool is_chosen(const Case& what) { return only().empty() || what.name == only(); }

std::vector<std::string> launcher(unsigned processes) {
  if (processes == 0) return {};
  return {SUTURE_LAUNCHER, "--allow-run-as-root", "--oversubscribe", "-n",
          std::to_string(processes)};
}

int Together::run(const Case& what, const std::vector<std::string>& words, unsigned processes,
                  const fs::path& at) {
  fs::create_directories(at);
  std::vector<std::string> arguments{"run"};
  arguments.insert(arguments.end(), words.begin(), words.end());
  if (!what.skips) arguments.push_back("--no-skip");
  return Child(at, arguments, launcher(processes)).wait();
}

int Together::run_alone(const Case& what, const fs::path& at) {
  write_case(what, at);
  const int code = run(what, {at / "scene.json"}, 0, at / "0");
  EXPECT_TRUE(code == 0 || code == 5) << said(at / "0");
  return code;
}

std::string Together::said(const fs::path& at) const { return read_text(at / ".err"); }

Case cut_beam() {
  for (const Kind& kind : all_kinds()) {
    Random random(1, kind.name, 0);
    if (kind.name == "scene_cut-beam") return kind.make(random, 0, 1);
  }
  throw std::logic_error("no scene cut-beam");
}

void expect_same_checkpoints(const fs::path& one, const fs::path& other) {
  constexpr std::size_t of_run = 200;  // bytes
  EXPECT_EQ(checkpoints_in(one), checkpoints_in(other));
  for (const std::uint64_t number : checkpoints_in(other)) {
    const std::string name = checkpoint_name(number);
    const std::string a = read_text(one / name), b = read_text(other / name);
    ASSERT_EQ(a.size(), b.size()) << name;
    std::size_t differ = 0;
    for (std::size_t i = 0; i < a.size(); ++i) differ += a[i] != b[i] ? 1 : 0;
    EXPECT_LT(differ, of_run) << name;
  }
}

}  // namespace suture::test
