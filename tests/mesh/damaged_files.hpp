// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "kernel/base/error.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "tests/mesh/temporary_folder.hpp"

namespace suture {

/// `text` with its first `old_text` replaced.
inline std::string with_replaced(std::string text, const std::string& old_text,
                                 const std::string& new_text) {
  const std::size_t at = text.find(old_text);
  EXPECT_NE(at, text.npos) << old_text;
  return text.replace(at, old_text.size(), new_text);
}

/// The error of read_mesh() for a file `name` with this text, from the name on.
inline std::string read_error(const std::string& name, const std::string& text) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  try {
    read_mesh(folder.write(name, text), 1, diagnostics);
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(what.find(name));
  }
  return "no error";
}

}  // namespace suture
