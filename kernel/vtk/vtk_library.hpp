// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "kernel/vtk/vtk_module.hpp"

// Inside libsuture-vtk.so only.

namespace suture {

/// Collects the messages that VTK reports on this thread during its lifetime.
class VtkMessages {
 public:
  VtkMessages();
  ~VtkMessages();
  VtkMessages(const VtkMessages&) = delete;
  VtkMessages& operator=(const VtkMessages&) = delete;
  /// The first message, which names the cause; "" if there was none.
  const std::string& first() const { return first_; }
  static void add(const char* text);

 private:
  VtkMessages* outer_;
  std::string first_;
};

bool expand_block(VtuCompression compression, std::span<const unsigned char> block,
                  std::span<unsigned char> out);
VtuOutcome write_vtu_file(int file, const VtuImage& image);

}  // namespace suture
