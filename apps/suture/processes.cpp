// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture/processes.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <thread>

namespace suture {
namespace {

std::unique_ptr<Communicator> joined;

std::string name_of_machine() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

}  // namespace

Communicator* enter_processes(Console& console) {
  if (!is_one_of_several()) return nullptr;
  joined = join_processes();
  if (joined->rank() != 0) console.mute();
  console.note(std::to_string(joined->size()) + " processes make this run");
  return joined.get();
}

unsigned threads_of_each(Communicator& processes) {
  const std::vector<std::string> machines = processes.gather(name_of_machine());
  const auto here = std::ranges::count(machines, machines[processes.rank()]);
  const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
  return std::max(1u, cores / static_cast<unsigned>(here));
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
