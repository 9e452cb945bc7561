// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <cstring>

#include "kernel/base/error.hpp"

namespace suture::bench {
namespace {

namespace fs = std::filesystem;

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

/// Starts the program in a folder; what it prints is dropped.
pid_t start(std::vector<std::string>& words, const fs::path& folder) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int failure =
      ::posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) throw IoError("cannot start " + words[0] + ": " + std::strerror(failure));
  return child;
}

}  // namespace

WorkingFolder::WorkingFolder() {
  std::string pattern = (fs::temp_directory_path() / "suture-bench-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) throw IoError("cannot create " + pattern);
  path_ = pattern;
}

WorkingFolder::~WorkingFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

ProcessUse run_process(std::vector<std::string> words, const fs::path& folder) {
  const auto begin = std::chrono::steady_clock::now();
  const pid_t child = start(words, folder);
  int status = 0;
  rusage used{};
  if (::wait4(child, &status, 0, &used) != child) throw IoError("lost the process " + words[0]);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  return {.cpu = seconds(used.ru_utime) + seconds(used.ru_stime),
          .wall = wall.count(),
          .code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status)};
}

fs::path suture_program() { return fs::read_symlink("/proc/self/exe").parent_path() / "suture"; }

}  // namespace suture::bench
