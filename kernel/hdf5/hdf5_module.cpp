// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/hdf5/hdf5_module.hpp"

#include "kernel/base/module.hpp"

namespace suture {

const Hdf5Module& hdf5_module() {
  using Factory = const Hdf5Module* (*)();
  static const Hdf5Module* const module =
      reinterpret_cast<Factory>(module_symbol("libsuture-hdf5.so", "suture_hdf5_module_1"))();
  return *module;
}

}  // namespace suture
