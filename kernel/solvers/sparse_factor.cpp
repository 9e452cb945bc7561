// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/sparse_factor.hpp"

#include "kernel/base/module.hpp"

namespace suture {

std::unique_ptr<SparseFactor> make_sparse_factor() {
  using Factory = SparseFactor* (*)();
  static const auto make =
      reinterpret_cast<Factory>(module_symbol("libsuture-cholmod.so", "suture_cholmod_factor_1"));
  return std::unique_ptr<SparseFactor>(make());
}

}  // namespace suture
