// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/loops/dispatch.hpp"

#include <map>
#include <mutex>
#include <string>

#include "kernel/base/isa.hpp"
#include "kernel/base/module.hpp"

extern "C" const suture::loops::Table* suture_loops_base(void);

namespace suture {
namespace {

const loops::Table& load(std::string_view isa) {
  using Function = const loops::Table* (*)();
  const std::string file = "suture-loops." + std::string(isa) + ".so";
  return *reinterpret_cast<Function>(module_symbol(file, SUTURE_LOOPS_SYMBOL))();
}

}  // namespace

/// Finding a module takes 0.2 ms in a large run, as long as a removal.
const loops::Table& hot_loops(std::string_view isa) {
  if (isa.empty()) return *suture_loops_base();
  static std::mutex mutex;
  static std::map<std::string, const loops::Table*, std::less<>> loaded;
  const std::lock_guard lock(mutex);
  if (const auto known = loaded.find(isa); known != loaded.end()) return *known->second;
  return *loaded.emplace(isa, &load(isa)).first->second;
}

const loops::Table& hot_loops() { return hot_loops(best_isa()); }

}  // namespace suture
