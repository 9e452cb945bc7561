// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/loops/dispatch.hpp"

#include "kernel/base/isa.hpp"
#include "kernel/base/module.hpp"

extern "C" const suture::loops::Table* suture_loops_base(void);

namespace suture {

const loops::Table& hot_loops(std::string_view isa) {
  if (isa.empty()) return *suture_loops_base();
  using Function = const loops::Table* (*)();
  const std::string file = "suture-loops." + std::string(isa) + ".so";
  return *reinterpret_cast<Function>(module_symbol(file, SUTURE_LOOPS_SYMBOL))();
}

const loops::Table& hot_loops() { return hot_loops(best_isa()); }

}  // namespace suture
