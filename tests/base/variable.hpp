// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <cstdlib>
#include <optional>
#include <random>
#include <string>

namespace suture::test {

/// The value of an environment variable, or "".
inline std::string value_of_variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

/// The seed that it gives, or a random one.
inline std::uint64_t seed_of_variable(const char* name) {
  const std::string given = value_of_variable(name);
  return given.empty() ? std::random_device()() : std::stoull(given);
}

/// Sets an environment variable, and restores it in the end: other cases run in the same process.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    setenv(name, value.c_str(), 1);
  }
  ~Variable() {
    if (before_)
      setenv(name_, before_->c_str(), 1);
    else
      unsetenv(name_);
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_;
};

}  // namespace suture::test
