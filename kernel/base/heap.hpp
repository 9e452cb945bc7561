// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace suture {

/// Returns freed memory that malloc and allocate_bulk() retain to the system, after work that
/// needed much more memory than it leaves in use. Takes some microseconds, plus the time per page
/// returned.
void trim_heap() noexcept;

}  // namespace suture
