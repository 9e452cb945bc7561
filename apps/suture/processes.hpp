// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "apps/suture/console.hpp"
#include "kernel/processes/communicator.hpp"

namespace suture {

/// Joins the other processes that a launcher of MPI has started; null if there are none. All but
/// process 0 show nothing from now on.
Communicator* enter_processes(Console& console);

/// One per core of a machine, divided among its processes.
unsigned threads_of_each(Communicator& processes);

/// Call at the end, with the exit code of this process. An error that not all processes have met
/// ends them, too.
int leave_processes(int code, Console& console);

}  // namespace suture
