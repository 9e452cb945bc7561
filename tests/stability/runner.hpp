// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kernel/scene/scene.hpp"
#include "tests/stability/trial.hpp"

namespace suture::test {

enum class Verdict {
  good,            ///< as expected
  reported,        ///< right, and its energy grew by more than 2 %, which was reported
  held,            ///< growth was reported or undone, and over the run there is none
  beyond_law,      ///< stopped, and a run at a tenth of the step stops, too
  refused,         ///< a scene that may be refused, with a message
  ended,           ///< a run that may or must be stopped, with its reason
  warned,          ///< not as asked for, which a warning says
  absent,          ///< the stress does not apply to the model or the solver
  stopped,         ///< a right run was stopped
  grew,            ///< energy grew by more than 2 % per 10,000 steps without a word
  inaccurate,      ///< far from a run at a quarter of the step, or a balance that is too large
  finished_wrong,  ///< a wrong run finished without a word
  wrong_outcome,   ///< ended in another way than expected
  not_run,         ///< the scene was refused
};
const char* name_of(Verdict verdict);
inline bool is_good(Verdict v) { return v <= Verdict::absent; }

/// The result of a trial.
struct Result {
  Verdict verdict = Verdict::good;
  std::string reason;
  std::string outcome;  ///< "finished", or the kind of error
  std::string error;
  std::vector<std::string> messages;  ///< of the observer and the diagnostics
  std::uint64_t steps = 0, rollbacks = 0;
  double balance = 0;             ///< of the ledger at the end, part of what was exchanged
  double stated_balance = 0;      ///< the same in the summary, without what is recoverable
  std::uint64_t quiet_steps = 0;  ///< until Trial::quiet
  double quiet_motion = 0;        ///< the largest displacement then, part of the diagonal
  std::string quiet_message;      ///< the first one until then
  double growth = 0;              ///< of kinetic + elastic + potential per 10,000 steps, the same
  double difference = 0;          ///< to a run at a quarter of the step, part of the displacement
  double seconds = 0;
};

/// Runs the trial and judges it. `folder`: for its files.
Result run_trial(const Trial& trial, const std::filesystem::path& folder, bool compares);

/// The scene as the program would read it.
Scene read_trial(const Trial& trial, const std::filesystem::path& folder);

}  // namespace suture::test
