// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace suture {

/// Warnings of one run, in the order in which they arose. The program shows
/// each when it arises (`on_warning`) and counts them at the end.
class Diagnostics {
 public:
  void warn(std::string text) {
    if (on_warning) on_warning(text);
    warnings_.push_back(std::move(text));
  }
  const std::vector<std::string>& warnings() const { return warnings_; }

  std::function<void(const std::string&)> on_warning;

 private:
  std::vector<std::string> warnings_;
};

}  // namespace suture
