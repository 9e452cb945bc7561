// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace suture {

/// The memory that can be used now without swapping, in bytes: what the system has available,
/// within the limits of the control group and of the process (ulimit -v). Infinite where nothing
/// states it.
double available_memory();

}  // namespace suture
