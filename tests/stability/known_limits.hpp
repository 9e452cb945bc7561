// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>

namespace suture::test {

/// Why a trial (of seed 1) is known to fail, or null. They are counted by themselves.
inline const char* known_limit(const std::string& name) {
  constexpr const char* inverts =
      "an element of a torn or cut body inverts, which a run at a tenth of the step keeps sound";
  constexpr const char* grows =
      "visco takes the strain to grow over a whole frame, so its slowest term has not relaxed";
  static const std::map<std::string, const char*> reasons{{"cut-031", inverts},
                                                          {"tear-023", inverts},
                                                          {"tear-036", inverts},
                                                          {"nu-0.4.visco.static", grows}};
  const auto found = reasons.find(name);
  return found == reasons.end() ? nullptr : found->second;
}

}  // namespace suture::test
