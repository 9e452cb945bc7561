// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "apps/suture-bench/cantilever.hpp"

namespace suture::bench {

/// What another program, CalculiX (Debian: calculix-ccx), makes of a cantilever.
struct CalculixRun {
  double elements = 0, seconds = 0;  ///< CPU s of the whole process, one thread
  double iterations = 0;             ///< of Newton's method, in all increments
  double tip = 0;                    ///< m
  double peak_bytes = 0;             ///< NaN if it is below that of this process
};

/// Whether `ccx` is installed.
bool has_calculix();

/// Solves the cantilever in one increment with SPOOLES, CalculiX's default solver. `element`: C3D8,
/// C3D8I or C3D20R. Throws UsageError for another one, and IoError if ccx fails.
CalculixRun run_calculix(const Cantilever& what, Index across, const std::string& element);

}  // namespace suture::bench
