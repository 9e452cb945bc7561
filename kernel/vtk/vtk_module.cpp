// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/vtk/vtk_module.hpp"

#include "kernel/base/module.hpp"

namespace suture {

const VtkModule& vtk_module() {
  using Factory = const VtkModule* (*)();
  static const VtkModule* const module =
      reinterpret_cast<Factory>(module_symbol("libsuture-vtk.so", "suture_vtk_module_1"))();
  return *module;
}

}  // namespace suture
