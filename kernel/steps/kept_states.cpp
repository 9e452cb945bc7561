// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/steps/kept_states.hpp"

#include <algorithm>

namespace suture {

void KeptStates::kept(std::uint64_t step) {
  if (count_ == 2) older_ = 1 - older_;
  count_ = count_ < 2 ? count_ + 1 : 2;
  kept_at_ = step;
  due_ = kept_at_ + steps_between;
}

void KeptStates::forget(std::uint64_t step) {
  count_ = 0;
  due_ = std::max(step, kept_at_ + steps_after_event);
}

const KeptStates::State& KeptStates::take_older() {
  count_ = 1;
  due_ = states_[older_].step + steps_between;
  return states_[older_];
}

void KeptStates::State::state(Archive& archive) {
  archive("step", step);
  archive("time", time);
  archive("buffer", buffer);
}

/// Those that are none any more are not worth their bytes.
void KeptStates::state(Archive& archive) {
  archive("older", older_);
  archive("count", count_);
  archive("due", due_);
  archive("kept at", kept_at_);
  archive.require(older_ < states_.size() && count_ <= states_.size(),
                  "there are more kept states than a run keeps");
  for (unsigned i = 0; i < count_; ++i)
    archive(i == 0 ? "first" : "second", states_[(older_ + i) % 2]);
}

}  // namespace suture
