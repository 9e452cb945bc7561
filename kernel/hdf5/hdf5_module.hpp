// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "kernel/base/archive.hpp"

// HDF5 behind a small interface. Its library (which pulls in curl; 15 ms to load) sits behind the
// one module libsuture-hdf5.so, which is loaded when the first checkpoint is written or read.

namespace suture {

class Hdf5Module {
 public:
  virtual ~Hdf5Module() = default;
  /// Makes the tree an HDF5 file in memory and hands its bytes to `take`: disks and their errors
  /// are the caller's, who may put a block of 512 bytes in front, which HDF5 skips. Arrays of
  /// the tree are freed as they are copied. Returns HDF5's words if it fails, else ""; what
  /// `take` throws passes through.
  ///
  /// A group of the tree is a group. One value, or a short text or vector, is an attribute of
  /// its group; anything else is a dataset of rows x columns, in chunks with Fletcher32 where it
  /// is not small. All of HDF5's own structures are of the kind that has checksums.
  virtual std::string write(StateTree&& tree,
                            const std::function<void(std::span<const std::byte>)>& take) const = 0;
  /// Reads such a file. Returns why it cannot be, or "".
  virtual std::string read(const std::string& path, StateTree& tree) const = 0;
};

/// The module, loaded at the first call. Throws IoError if it cannot be.
const Hdf5Module& hdf5_module();

}  // namespace suture
