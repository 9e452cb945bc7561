// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace suture {

/// Warnings and notes of one run, in the order in which they were issued. The program shows each as
/// it is issued (`on_warning`, `on_note`) and counts the warnings at the end; a note requires no
/// action from the user.
class Diagnostics {
 public:
  void warn(std::string text) {
    if (on_warning) on_warning(text);
    warnings_.push_back(std::move(text));
  }
  void note(std::string text) {
    if (on_note) on_note(text);
    notes_.push_back(std::move(text));
  }
  const std::vector<std::string>& warnings() const { return warnings_; }
  const std::vector<std::string>& notes() const { return notes_; }

  std::function<void(const std::string&)> on_warning, on_note;

 private:
  std::vector<std::string> warnings_, notes_;
};

}  // namespace suture
