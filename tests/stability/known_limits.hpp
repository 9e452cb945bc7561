// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>

namespace suture::test {

/// Why a trial (of seed 1) is known to fail, or null. They are counted by themselves.
inline const char* known_limit(const std::string& name) {
  constexpr const char* drifts =
      "energy grows at a stable step until elements invert; a tenth of the step stays right";
  static const std::map<std::string, const char*> reasons{
      {"axial-002", drifts},    {"pierce-041", drifts}, {"pressure-014", drifts},
      {"pressure-053", drifts}, {"tear-003", drifts},   {"tear-013", drifts},
      {"tear-022", drifts},     {"tear-027", drifts},   {"tear-045", drifts},
      {"tear-051", drifts},     {"tear-057", drifts}};
  const auto found = reasons.find(name);
  return found == reasons.end() ? nullptr : found->second;
}

}  // namespace suture::test
