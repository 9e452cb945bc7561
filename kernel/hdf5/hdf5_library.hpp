// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <hdf5.h>

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "kernel/base/archive.hpp"

// Inside libsuture-hdf5.so only.

namespace suture::hdf5 {

/// A failed call of HDF5: "cannot <what>", and the message of HDF5.
struct Failure {
  std::string text;
};

/// Throws a Failure if `result` is negative; otherwise returns it.
template <class Result>
Result good(Result result, const std::string& what);
[[noreturn]] void fail(const std::string& what);

/// An identifier of HDF5, closed by the destructor.
class Id {
 public:
  Id(hid_t id, herr_t (*close)(hid_t), const std::string& what) : id_(id), close_(close) {
    if (id < 0) fail(what);
  }
  ~Id() {
    if (id_ >= 0) close_(id_);
  }
  Id(Id&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  Id& operator=(Id&&) = delete;
  /// Releases ownership: the caller closes it.
  hid_t release() { return std::exchange(id_, -1); }
  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor)

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

template <class Result>
Result good(Result result, const std::string& what) {
  if (result < 0) fail(what);
  return result;
}

/// The type in files (little-endian) and in memory. Texts have a type of their own length.
hid_t file_type(Archive::Scalar type);
hid_t memory_type(Archive::Scalar type);
/// The type of a text of `size` bytes; padding is zeros.
Id text_type(std::size_t size);
std::size_t bytes_of(Archive::Scalar type);

/// Names that HDF5 would interpret as paths, and the empty name, are escaped with % and two digits.
std::string to_link(std::string_view name);
std::string from_link(std::string_view link);

void write_tree(StateTree& tree, const std::function<void(std::span<const std::byte>)>& take);
void read_tree(const std::string& path, StateTree& tree);

}  // namespace suture::hdf5
