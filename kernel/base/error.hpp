// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace suture {

/// What a user must be told. One type per meaning; each maps to one exit code
/// of the program. The text says what, where, what was expected, what to do.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  /// Exit code of the program: 2 usage, 3 scene or mesh, 4 plugin, 5 numerical,
  /// 6 file system.
  virtual int exit_code() const noexcept = 0;
};

class UsageError : public Error {
 public:
  using Error::Error;
  int exit_code() const noexcept override { return 2; }
};

/// A scene or mesh file that does not say what can be run.
class InputError : public Error {
 public:
  using Error::Error;
  int exit_code() const noexcept override { return 3; }
};

/// Elements that form no 3-map, or an operation that the map does not admit.
class TopologyError : public InputError {
 public:
  using InputError::InputError;
};

class PluginError : public Error {
 public:
  using Error::Error;
  int exit_code() const noexcept override { return 4; }
};

/// Non-finite values, growing energy, inverted elements, no convergence.
class NumericalError : public Error {
 public:
  static constexpr std::uint64_t nowhere = ~std::uint64_t{0};
  /// `where`: the element, by the number that users know it by, if the text gives no place.
  explicit NumericalError(const std::string& text, std::uint64_t where = nowhere)
      : Error(text), element(where) {}
  std::uint64_t element;
  int exit_code() const noexcept override { return 5; }
};

class IoError : public Error {
 public:
  using Error::Error;
  int exit_code() const noexcept override { return 6; }
};

}  // namespace suture
