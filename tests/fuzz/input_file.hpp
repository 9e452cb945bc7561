// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/base/error.hpp"
#include "tests/mesh/temporary_folder.hpp"

namespace suture::fuzz {

/// The bytes as a file, where the readers look for them.
inline std::filesystem::path input_file(const std::string& name, std::string_view bytes) {
  static const TemporaryFolder folder;
  return folder.write(name, bytes);
}

/// Calls f, for which an Error is an answer.
template <class F>
void answered(F f) {
  try {
    f();
  } catch (const Error&) {
  }
}

/// A law that the readers promise.
inline void require(bool law) {
  if (!law) std::abort();
}

}  // namespace suture::fuzz
