// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/resume/process.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <set>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/output/checkpoint_file.hpp"
#include "kernel/run/simulation.hpp"
#include "kernel/scene/scene_reader.hpp"
#include "tests/mesh/temporary_folder.hpp"

namespace suture::test {
namespace {

namespace fs = std::filesystem;

struct Listener : Observer {
  Listener(Ran& result, const Way& way) : ran(result), stop(way.stop), give_up(way.give_up) {}
  void on_message(const std::string& text) override { report(text); }
  bool stop_requested() override {
    const bool stops = stop && ran.questions >= *stop;
    ++ran.questions;
    return stops;
  }
  bool gives_up_step() override {
    const bool gives_up = give_up && ran.questions_within >= *give_up;
    ++ran.questions_within;
    if (gives_up) stop = 0;
    return gives_up;
  }
  void report(const std::string& text) {
    if (text.starts_with("resume with")) return;
    ran.messages.push_back(text);
    ran.reported_at.push_back(ran.questions);
  }
  Ran& ran;
  std::optional<std::uint64_t> stop, give_up;
};

std::string text_of(const RunSummary& s) {
  std::ostringstream text;
  text.precision(17);
  text << "outcome " << static_cast<int>(s.outcome) << ", steps " << s.steps << ", frames "
       << s.frames << ", inverted " << s.inverted_elements << ", cut " << s.faces_cut << ", torn "
       << s.faces_torn << ", sewn " << s.faces_sewn << ", removed " << s.elements_removed
       << ", back " << s.rollbacks << ", balance " << s.balance << " of " << s.exchanged
       << ", time " << s.time << ", dt " << s.dt << ", eigenvalue "
       << s.lowest_eigenvalue.value_or(0);
  return text.str();
}

std::string without(std::string text, const std::string& part) {
  for (std::size_t at; (at = text.find(part)) != text.npos;) text.erase(at, part.size());
  return text;
}

void run(const Scene& scene, PluginHost& host, bool skips, const std::optional<Checkpoint>& from,
         const Way& way, Ran& ran) {
  Diagnostics diagnostics;
  Simulation simulation(scene, host, diagnostics, skips);
  if (from) simulation.resume(*from, way.resume);
  Listener listener(ran, way);
  diagnostics.on_warning = [&](const std::string& text) { listener.report(text); };
  const RunSummary summary = simulation.run(listener);
  ran.end = text_of(summary);
  ran.steps = summary.steps;
  ran.was_stopped = summary.outcome == RunSummary::Outcome::interrupted;
  if (summary.outcome == RunSummary::Outcome::unstable_equilibrium) ran.code = 5;
}

}  // namespace

Ran run_here(const Case& what, const fs::path& folder, const fs::path& out, const Way& way) {
  Ran ran;
  const auto start = std::chrono::steady_clock::now();
  try {
    PluginHost host;
    Diagnostics ignored;
    std::optional<Checkpoint> from;
    if (!way.resume.empty()) from = read_checkpoint(way.resume);
    Scene scene = from ? read_scene_source({from->header.scene_text, from->header.scene_file,
                                            from->header.working_folder},
                                           {}, host, ignored)
                       : read_scene(folder / "scene.json", {}, host, ignored);
    scene.output.directory = out;
    scene.solver.threads = way.threads;
    scene.checkpoint.enabled = way.checkpoints;
    scene.checkpoint.every_steps = way.every_steps;
    scene.checkpoint.keep = 1000;
    run(scene, host, what.skips, from, way, ran);
  } catch (const Error& error) {
    ran.end = without(error.what(), out.string());
    ran.code = error.exit_code();
  }
  for (std::string& text : ran.messages) text = without(text, out.string());
  ran.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return ran;
}

// ------------------------------------------------------------------ program --

Child::Child(const fs::path& folder, const std::vector<std::string>& arguments,
             const std::vector<std::string>& launcher) {
  std::vector<std::string> words = launcher;
  words.emplace_back(SUTURE_PROGRAM);
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_ = fork();
  if (pid_ != 0) return;
  if (chdir(folder.c_str()) != 0) _exit(126);
  for (const auto& [name, to] : {std::pair{".out", 1}, std::pair{".err", 2}})
    dup2(open(name, O_CREAT | O_WRONLY | O_TRUNC, 0644), to);
  execvp(argv[0], argv.data());
  _exit(127);
}

void Child::send(int signal, double after) const {
  using Clock = std::chrono::steady_clock;
  const auto until = Clock::now() + std::chrono::duration<double>(after);
  while (Clock::now() < until && !has_ended()) usleep(200);
  kill(pid_, signal);
}

bool Child::has_ended() const {
  siginfo_t ended{};
  waitid(P_PID, static_cast<id_t>(pid_), &ended, WEXITED | WNOHANG | WNOWAIT);
  return ended.si_pid != 0;
}

int Child::wait() const {
  int status = 0;
  waitpid(pid_, &status, 0);
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

// ------------------------------------------------------------------ folders --

namespace {

std::set<std::string> files_of(const fs::path& folder) {
  std::set<std::string> names;
  if (!fs::exists(folder)) return names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("checkpoint_") && name != ".suture-run") names.insert(name);
  }
  return names;
}

/// The first line of a text that differs.
std::string first_difference(const std::string& a, const std::string& b) {
  std::istringstream one(a), other(b);
  std::string line, with;
  for (int number = 1;; ++number) {
    const bool has = !std::getline(one, line).fail(), has_other = !std::getline(other, with).fail();
    if (has && has_other && line == with) continue;
    return "line " + std::to_string(number) +
           "\n    expected: " + (has ? line.substr(0, 300) : "(end)") +
           "\n    found:    " + (has_other ? with.substr(0, 300) : "(end)");
  }
}

/// provenance.json without the processes, which it names where there are several.
std::string without_processes(const std::string& text) {
  Json all = Json::parse(text);
  all.erase("processes");
  return all.dump(1);
}

/// The part of a file that does not depend on how many processes have written it.
std::string result_in(const fs::path& file) {
  const std::string text = read_text(file);
  return file.filename() == "provenance.json" ? without_processes(text) : text;
}

}  // namespace

std::string difference(const fs::path& expected, const fs::path& found) {
  const std::set<std::string> names = files_of(expected), others = files_of(found);
  std::string text;
  for (const std::string& name : names)
    if (!others.contains(name)) text += "  " + name + " is missing\n";
  for (const std::string& name : others) {
    if (!names.contains(name)) {
      text += "  " + name + " is too much\n";
      continue;
    }
    const std::string a = result_in(expected / name), b = result_in(found / name);
    if (a == b) continue;
    text += "  " + name + " differs";
    if (!name.ends_with(".vtu")) text += ": " + first_difference(a, b);
    text += '\n';
  }
  return text;
}

fs::path newest_checkpoint(const fs::path& folder) {
  const std::vector<std::uint64_t> numbers = checkpoints_in(folder);
  return numbers.empty() ? fs::path() : folder / checkpoint_name(numbers.back());
}

}  // namespace suture::test
