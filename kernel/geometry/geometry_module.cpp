// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/geometry_module.hpp"

#include "kernel/base/module.hpp"

namespace suture {

const GeometryModule& geometry_module() {
  using Factory = const GeometryModule* (*)();
  static const GeometryModule* const module = reinterpret_cast<Factory>(
      module_symbol("libsuture-geometry.so", "suture_geometry_module_1"))();
  return *module;
}

}  // namespace suture
