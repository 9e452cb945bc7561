// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/apps/program.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <ostream>

namespace suture::testing {

std::ostream& operator<<(std::ostream& stream, const Outcome& outcome) {
  return stream << "exit code " << outcome.code << "\n--- standard output\n"
                << outcome.out << "--- standard error\n"
                << outcome.err << "---";
}

Program::Program() {
  std::string pattern =
      (std::filesystem::temp_directory_path() / ("suture-apps-" + std::string(6, 'X'))).string();
  if (mkdtemp(pattern.data()) == nullptr) std::abort();
  folder_ = pattern;
}

Program::~Program() { std::filesystem::remove_all(folder_); }

pid_t Program::start(const std::vector<std::string>& arguments, const std::string& name) const {
  std::vector<std::string> words{SUTURE_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child != 0) return child;
  const auto redirect = [](const std::string& path, int to) {
    const int file = open(path.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0644);
    dup2(file, to);
    close(file);
  };
  if (chdir(folder_.c_str()) != 0) _exit(126);
  setenv("HOME", folder_.c_str(), 1);  // no plugins of the user
  redirect(name + ".out", STDOUT_FILENO);
  redirect(name + ".err", STDERR_FILENO);
  execv(argv[0], argv.data());
  _exit(127);
}

Outcome Program::finish(pid_t child, const std::string& name) const {
  int status = 0;
  waitpid(child, &status, 0);
  const int code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  messages_.add(read(name + ".err"), folder_);
  return {code, read(name + ".out"), read(name + ".err")};
}

Outcome Program::suture(const std::vector<std::string>& arguments) const {
  return finish(start(arguments));
}

Outcome Program::interrupted(const std::vector<std::string>& arguments, int signal,
                             const std::filesystem::path& file) const {
  const pid_t child = start(arguments);
  wait_for(file, child);
  kill(child, signal);
  return finish(child);
}

void Program::wait_for(const std::filesystem::path& file, pid_t child) const {
  siginfo_t ended{};
  while (!std::filesystem::exists(folder_ / file) && ended.si_pid == 0) {
    usleep(1000);
    waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT);
  }
}

void Program::write(const std::string& name, const std::string& text) const {
  std::ofstream(folder_ / name, std::ios::binary) << text;
}

std::string Program::read(const std::string& name) const {
  std::ifstream stream(folder_ / name, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

Outcome Program::scene(const std::string& command, const std::string& more,
                       const std::vector<std::string>& sets) const {
  write("s.json", R"({
  "suture": 1,
  "mesh": {"box": {"size": [1, 1, 1], "cells": [2, 2, 2]}},
  "models": [{"model": "tm-faure", "parameters": {"E": 1e5, "nu": 0.3, "rho": 1000}}],
  "solver": {"dt": 1e-3, "end": 0.01})" +
                      more + "\n}\n");
  std::vector<std::string> arguments{command, "s.json"};
  for (const std::string& set : sets) {
    arguments.push_back("--set");
    arguments.push_back(set);
  }
  return suture(arguments);
}

}  // namespace suture::testing
