// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "apps/suture/console.hpp"
#include "kernel/processes/communicator.hpp"

namespace suture {

/// Starts this command again as several processes, by the launcher of MPI, and waits for it.
/// Returns its exit code: that of the run, or 128 and the signal that has ended a process, which it
/// tells.
int run_by_processes(unsigned number, Console& console);

/// Joins the other processes that a launcher of MPI has started; null if there are none. All but
/// process 0 show nothing from now on. Throws InputError if `asked`, unless 0 or 1, is not their
/// number.
Communicator* enter_processes(unsigned asked, Console& console);

/// One per core of a machine, divided among its processes; at most one per core that the launcher
/// allows this process.
unsigned threads_of_each(Communicator& processes);

/// "process 0 sent per step 245 kB in 1 messages to single processes, and 31 kB in 3.1 exchanges of
/// all"; in so many steps.
std::string describe_traffic(const Communicator& processes, std::uint64_t steps);

/// Waits until all processes leave. Nothing happens if there are no others.
void leave_processes();
/// Call it instead after an error, with its exit code. If the others have not met the error, ends
/// them, too, and does not return.
void leave_processes_after_error(int code, Console& console);

}  // namespace suture
