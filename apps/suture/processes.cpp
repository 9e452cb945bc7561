// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture/processes.hpp"

#include <sched.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include "apps/suture/child_process.hpp"
#include "kernel/base/error.hpp"

namespace suture {
namespace {

std::unique_ptr<Communicator> joined;
volatile std::sig_atomic_t interrupted = 0;

/// Launchers may bind a process to some of them.
unsigned allowed_cores() {
  cpu_set_t cores;
  if (sched_getaffinity(0, sizeof cores, &cores) != 0) return 1;
  return static_cast<unsigned>(CPU_COUNT(&cores));
}

/// The words of this command.
std::vector<std::string> own_words() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> words;
  for (std::string word; std::getline(file, word, '\0');) words.push_back(word);
  return words;
}

/// More processes than cores are allowed, none is bound to a core, and root may do this, too. Other
/// launchers do not read these variables of Open MPI. The launcher adds no messages of its own,
/// because each process reports its errors.
[[noreturn]] void become_launcher(unsigned number) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  setenv("OMPI_MCA_rmaps_base_oversubscribe", "1", 0);
  setenv("OMPI_MCA_hwloc_base_binding_policy", "none", 0);
  setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 0);
  setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 0);
  std::vector<std::string> words{"mpirun", "--quiet", "-n", std::to_string(number)};
  std::vector<std::string> own = own_words();
  own.at(0) = std::filesystem::read_symlink("/proc/self/exe");
  words.insert(words.end(), own.begin(), own.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  execvp(argv[0], argv.data());
  throw InputError(
      "--processes needs mpirun, the launcher of MPI, which cannot be started (Debian: "
      "openmpi-bin)");
}

}  // namespace

int run_by_processes(unsigned number, Console& console) {
  const pid_t launcher = new_process();
  if (launcher == 0) become_launcher(number);
  // The launcher gets it, too, and ends the run.
  std::signal(SIGINT, [](int) { interrupted = 1; });
  const int status = status_at_end(launcher);
  if (interrupted) return 128 + SIGINT;
  const int code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  if (code > 128)
    console.error(
        "signal " + std::to_string(code - 128) +
        " ended a process, and the others with it: suture-unfinished.txt in the folder of "
        "the results says how to go on");
  return code;
}

Communicator* enter_processes(unsigned asked, Console& console) {
  if (!is_one_of_several()) return nullptr;
  joined = join_processes();
  if (joined->size() == 1) return nullptr;
  if (joined->rank() != 0) console.mute();
  if (asked > 1 && asked != joined->size())
    throw InputError("--processes is " + std::to_string(asked) +
                     ", but the launcher of this run has started " +
                     std::to_string(joined->size()) + "; leave --processes out");
  console.note(std::to_string(joined->size()) + " processes make this run");
  return joined.get();
}

unsigned threads_of_each(Communicator& processes) {
  const std::vector<std::string> machines = processes.gather(name_of_machine());
  const auto here = std::ranges::count(machines, machines[processes.rank()]);
  const auto share = std::thread::hardware_concurrency() / static_cast<unsigned>(here);
  return std::clamp(share, 1u, allowed_cores());
}

std::string describe_traffic(const Communicator& processes, std::uint64_t steps) {
  const Communicator::Traffic& sent = processes.traffic();
  const auto per_step = [&](std::uint64_t number) {
    return static_cast<double>(number) / static_cast<double>(std::max<std::uint64_t>(steps, 1));
  };
  return "process 0 sent per step " + memory(per_step(sent.bytes)) + " in " +
         short_number(per_step(sent.messages)) + " messages to single processes, and " +
         memory(per_step(sent.exchanged_bytes)) + " in " + short_number(per_step(sent.exchanges)) +
         " exchanges of all";
}

void leave_processes() { joined.reset(); }

void leave_processes_after_error(int code, Console& console) {
  if (joined && !joined->all_meet_error()) {
    console.speak_as("process " + std::to_string(joined->rank()) + " of " +
                     std::to_string(joined->size()));
    joined->abort(code);
  }
  leave_processes();
}

}  // namespace suture
