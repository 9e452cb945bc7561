// SPDX-License-Identifier: GPL-3.0-or-later
//
// Functions of functors take no memory from the heap: a call would wait for other threads, and for
// longer than it computes.
#include <cstdlib>
#include <new>

#include "kernel/model_check/checks.hpp"

namespace {
thread_local std::uint64_t allocation_count = 0;
}

// Those of plugins are these, too: the program's come before the library's. ThreadSanitizer has its
// own, which the program cannot replace; there, nothing is counted.
#ifdef __has_feature
#if __has_feature(thread_sanitizer)
#define SUTURE_COUNTS_NO_ALLOCATIONS
#endif
#endif
#ifndef SUTURE_COUNTS_NO_ALLOCATIONS
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocation_count;
  return std::malloc(size > 0 ? size : 1);
}
void* operator new(std::size_t size) {
  if (void* const memory = operator new(size, std::nothrow)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
#endif

namespace suture::checks {
namespace {

/// Allocations in one call of `function`.
template <class Function>
std::uint64_t allocations(BatchCaller& caller, const char* name, const CellBatch& in,
                          suture_batch& batch, Function function) {
  std::uint64_t count = 0;
  caller.call(name, in, batch, [&](const suture_context* context, const suture_batch* b) {
    const std::uint64_t before = allocation_count;
    const suture_status status = function(context, b);
    count = allocation_count - before;
    return status;
  });
  return count;
}

}  // namespace

Result no_allocation(const BatchCase& of) {
  const suture_functor& functor = *of.batch.functor;
  BatchCaller caller(of.instance);
  CellForces out = outputs_of(of.batch, of.instance.model(), 0);
  BatchView view(of.batch);
  view.write_to(out);
  const auto require_none = [&](const char* name, auto function) {
    if (const auto count = allocations(caller, name, of.batch, view.batch(), function); count > 0)
      throw BrokenLaw(std::string("one call of ") + name + "() allocates memory " +
                      std::to_string(count) + " times; use arrays of a fixed size");
  };
  require_none("force", functor.force);
  if (const auto* table = extension_of<suture_energy_1>(functor, SUTURE_ENERGY_1))
    require_none("energy", [&](auto* context, auto* batch) {
      alignas(SUTURE_ALIGNMENT) double energies[SUTURE_LANES];
      return table->energy(context, batch, energies);
    });
  if (const auto* table = extension_of<suture_tangent_1>(functor, SUTURE_TANGENT_1))
    require_none("tangent", [&](auto* context, auto* batch) {
      return table->apply(context, batch, of.batch.position.data(), of.batch.velocity.data(),
                          out.force.data());
    });
  return Measured{};
}

}  // namespace suture::checks
