// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "kernel/base/error.hpp"

namespace suture {

/// On one line. What is not UTF-8 (names come from files) is replaced.
template <class Json>
std::string json_text(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// A whole number from 0 on; converting any other would be undefined. Throws InputError with its
/// name.
template <class Json>
std::uint64_t whole_number(const Json& number, const std::string& name) {
  if (!number.is_number_unsigned())
    throw InputError(name + " is not a whole number from 0 on: " + json_text(number));
  return number.template get<std::uint64_t>();
}

}  // namespace suture
