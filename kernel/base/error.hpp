// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace suture {

/// An error to report to the user. There is one type per meaning, and each maps to one exit code of
/// the program. The text says what is wrong and where, what was expected, and what to do.
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

/// A scene or mesh file that cannot be run.
class InputError : public Error {
 public:
  using Error::Error;
  int exit_code() const noexcept override { return 3; }
};

/// Elements that do not form a 3-map, or an operation that the map does not allow.
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
  /// `where`: the element at fault, by its user number, if the text does not name it.
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
