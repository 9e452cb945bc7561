// SPDX-License-Identifier: GPL-3.0-or-later
//
// Several processes that make a run together.
//   SUTURE_FULL=1              a scene of each kind, 50 of divided bodies, 50 of their frames
//                              in pieces, 20 kills;
//   otherwise                  as many scenes as some seconds hold, one solver, one kill
//   SUTURE_PROCESSES_SEED=N    these scenes; otherwise others in each run
//   SUTURE_PROCESSES_CASE=NAME this one alone, "twist-017-0"
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/mesh/temporary_folder.hpp"
#include "tests/resume/process.hpp"

namespace suture::test {

std::uint64_t scenes_seed();
bool is_full();
std::string only();  ///< the name of a case, or ""
bool is_chosen(const Case& what);

/// Also for root, and for more processes than cores. 0: none, for one process.
std::vector<std::string> launcher(unsigned processes);

class Together : public ::testing::Test {
 protected:
  /// Runs the case in a folder of its own; returns the exit code.
  int run(const Case& what, const std::vector<std::string>& words, unsigned processes,
          const std::filesystem::path& at);
  /// Writes the case to a folder and runs it there as one process, in the folder `0`. Returns the
  /// exit code, 0 or 5.
  int run_alone(const Case& what, const std::filesystem::path& at);
  /// What the run there has said.
  std::string said(const std::filesystem::path& at) const;

  TemporaryFolder folder_;
};

/// The beam of the tutorial, cut while it sags.
Case cut_beam();

/// All checkpoints in two folders, but for the identity of the run, its folder and the time.
void expect_same_checkpoints(const std::filesystem::path& one, const std::filesystem::path& other);

}  // namespace suture::test
