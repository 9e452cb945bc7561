// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>

#include "apps/suture-bench/cantilever.hpp"

namespace suture::bench {

/// What another program, CalculiX (Debian: calculix-ccx), makes of a cantilever.
struct CalculixRun {
  double elements = 0, seconds = 0;  ///< CPU s of the whole process, one thread
  double wall = 0;                   ///< s
  double iterations = 0;             ///< of Newton's method, in all increments
  double tip = 0;                    ///< m
  double peak_bytes = 0;             ///< NaN if it is below that of this process
};

/// Whether `ccx` is installed.
bool has_calculix();

struct CalculixJob {
  std::string element = "C3D8";    ///< C3D8, C3D8I or C3D20R
  std::array<Index, 3> cells{};    ///< x along the beam
  double grading = 1;              ///< last cell along the beam / first
  std::string solver = "SPOOLES";  ///< CalculiX's default; or "ITERATIVE CHOLESKY"
};

/// Solves the cantilever in one increment. Throws UsageError for an unknown element, and IoError if
/// ccx fails.
CalculixRun run_calculix(const Cantilever& what, const CalculixJob& job);

}  // namespace suture::bench
