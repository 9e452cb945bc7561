// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace suture {

/// Gives the system what was freed and malloc keeps: after work that needed much more
/// memory than what is left of it. Some microseconds, and more per page given back.
void trim_heap() noexcept;

}  // namespace suture
