// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/findings.hpp"

#include <tuple>

#include "kernel/base/error.hpp"
#include "suture/plugin.h"

namespace suture {

void Findings::add(std::int32_t severity, Index cell, std::string key, std::string text) {
  const std::scoped_lock lock(mutex_);
  Finding& finding = findings_[{severity, std::move(key)}];
  if (finding.count == 0 || std::tie(cell, text) < std::tie(finding.first, finding.text)) {
    finding.first = cell;
    finding.text = std::move(text);
  }
  ++finding.count;
}

void Findings::deliver(const std::string& who, Diagnostics& diagnostics) {
  const std::scoped_lock lock(mutex_);
  std::string errors;
  for (const auto& [name, finding] : findings_) {
    std::string line = who + ": " + finding.text;
    if (finding.first != none)
      line += " [" + name.second + ": " + std::to_string(finding.count) +
              (finding.count == 1 ? " cell, " : " cells, first ") + std::to_string(finding.first) +
              "]";
    if (name.first >= SUTURE_ERROR)
      errors += (errors.empty() ? "" : "\n") + line;
    else if (name.first == SUTURE_WARNING)
      diagnostics.warn(std::move(line));
    else
      diagnostics.note(std::move(line));
  }
  findings_.clear();
  if (!errors.empty()) throw InputError(errors);
}

}  // namespace suture
