// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "kernel/base/types.hpp"
#include "kernel/plugin_host/plugin_call.hpp"
#include "suture/plugin.h"

namespace suture {

/// The failure to report among those that one worker encountered: faults of a plugin come
/// before failures that stop the run, these before those that ask for a smaller step; then the
/// first functor counts, then the lowest cell. Merging the failures of all workers gives the same
/// result for any number of workers.
class Failure {
 public:
  /// Notes that a call of functor number `functor` returned `status` for `batch`.
  void note(suture_status status, Index functor, const suture_error& error,
            const suture_batch& batch);
  /// The plugin broke its contract in `call` of functor number `functor`: `text` names both.
  void note_fault(Index functor, const PluginCall& call, std::string text);
  void merge(const Failure& other);
  void clear() { *this = {}; }

  /// For another process.
  std::string packed() const;
  static Failure unpacked(const std::string& text);

  bool any() const { return status_ != SUTURE_OK; }
  Index functor() const { return functor_; }
  /// Throws NumericalError, StepRejected or, for a fault of the plugin, PluginError; `title` names
  /// the model and the functor, `cell_word` is the word for its cells.
  [[noreturn]] void raise(const std::string& title, const char* cell_word, double time) const;

 private:
  bool comes_before(const Failure& other) const;

  suture_status status_ = SUTURE_OK;
  bool is_fault_ = false;  // of the plugin; text_ names it
  Index functor_ = none, cell_ = none;
  bool cell_known_ = false;
  std::int32_t code_ = 0;
  double step_factor_ = 1;  // the smallest one requested
  std::string text_;
};

}  // namespace suture
