// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/within_steps.hpp"

#include <utility>

#include "kernel/run/notes_on_steps.hpp"

namespace suture {

WithinSteps::WithinSteps(StepControl& control, Dynamics& dynamics, Observer& observer,
                         std::function<void(const Newton::Iteration&)> on_iteration)
    : control_(control), newton_(dynamics.newton()) {
  const auto detail = [&observer](const std::string& text) { observer.on_detail(text); };
  control_.on_detail = detail;
  control_.is_abandoned = [&observer] { return observer.gives_up_step(); };
  if (!newton_) return;
  newton_->on_iteration = [&observer, newton = newton_,
                           next = std::move(on_iteration)](const Newton::Iteration& iteration) {
    observer.on_detail(note_on(iteration, *newton));
    if (next && iteration.coarse_nodes == 0) next(iteration);
  };
  newton_->on_note = detail;
  newton_->on_message = [&observer](const std::string& text) { observer.on_message(text); };
}

WithinSteps::~WithinSteps() {
  control_.on_detail = {};
  control_.is_abandoned = {};
  if (!newton_) return;
  newton_->on_iteration = {};
  newton_->on_note = {};
  newton_->on_message = {};
}

}  // namespace suture
