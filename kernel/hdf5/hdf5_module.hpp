// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "kernel/base/archive.hpp"

// HDF5 behind a small interface. Its library (which pulls in curl; 15 ms to load) is used only by
// the module libsuture-hdf5.so, which is loaded when the first checkpoint is written or read.

namespace suture {

class Hdf5Module {
 public:
  virtual ~Hdf5Module() = default;
  /// Converts the tree to an HDF5 file in memory and passes its bytes to `take`. The caller writes
  /// them and handles errors of the disk, and may prepend a block of 512 bytes, which HDF5 skips.
  /// Arrays of the tree are freed as they are copied. Returns the message of HDF5 if it fails,
  /// otherwise ""; exceptions of `take` propagate.
  ///
  /// Groups of the tree become groups. A single value, or a short text or vector, becomes an
  /// attribute of its group; anything else becomes a dataset of rows x columns, in chunks with
  /// Fletcher32 unless it is small. All internal structures of HDF5 use the versions with
  /// checksums.
  virtual std::string write(StateTree&& tree,
                            const std::function<void(std::span<const std::byte>)>& take) const = 0;
  /// Reads such a file. Returns the reason if it cannot be read, otherwise "".
  virtual std::string read(const std::string& path, StateTree& tree) const = 0;
};

/// The module, loaded at the first call. Throws IoError if it cannot be loaded.
const Hdf5Module& hdf5_module();

}  // namespace suture
