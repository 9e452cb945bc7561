// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "kernel/base/diagnostics.hpp"
#include "kernel/base/types.hpp"

namespace suture {

/// What a model reports about the cells of one instance (suture_host.report),
/// kept once per severity and key: how often, and the first cell's sentence.
class Findings {
 public:
  /// Any thread; the result of deliver() does not depend on the order of the calls.
  void add(std::int32_t severity, Index cell, std::string key, std::string text);

  /// Passes on notes and warnings, each as one line beginning with `who`, and clears
  /// them; throws InputError with all errors, if there are any.
  void deliver(const std::string& who, Diagnostics& diagnostics);

 private:
  struct Finding {
    Index count = 0;
    Index first = none;  ///< lowest cell, `none` for the instance as a whole
    std::string text;    ///< of the first
  };
  std::mutex mutex_;
  std::map<std::pair<std::int32_t, std::string>, Finding> findings_;
};

}  // namespace suture
