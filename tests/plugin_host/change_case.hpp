// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <ostream>
#include <string>

namespace suture {

/// One change to what a plugin offers, and the sentence that it must produce.
template <class Changed>
struct ChangeCase {
  const char* name;
  std::function<void(Changed&)> change;
  const char* expected;
};

template <class Changed>
void PrintTo(const ChangeCase<Changed>& c, std::ostream* out) {
  *out << c.name;
}

/// The last argument of INSTANTIATE_TEST_SUITE_P.
inline constexpr auto name_of_case = [](const auto& info) { return std::string(info.param.name); };

}  // namespace suture
