// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#if !defined(__x86_64__) && !defined(__aarch64__)
#error "read and write the floating-point control register of this architecture here"
#endif

namespace suture {

/// How a thread computes with floating-point numbers: the rounding mode, whether subnormal numbers
/// are flushed to zero, and which exceptions trap. The flags of exceptions that have occurred are
/// left out. Reading takes a nanosecond; std::fegetenv takes twenty.
class FloatModes {
 public:
  /// Those of this thread.
  static FloatModes now() {
    FloatModes modes;
#if defined(__x86_64__)
    modes.control_ = __builtin_ia32_stmxcsr() & ~sse_flags;
    __asm__ volatile("fnstcw %0" : "=m"(modes.x87_));
#else
    __asm__ volatile("mrs %0, fpcr" : "=r"(modes.control_));
#endif
    return modes;
  }
  void restore() const {
#if defined(__x86_64__)
    __builtin_ia32_ldmxcsr(static_cast<std::uint32_t>(control_) |
                           (__builtin_ia32_stmxcsr() & sse_flags));
    __asm__ volatile("fnclex; fldcw %0" : : "m"(x87_));
#else
    __asm__ volatile("msr fpcr, %0" : : "r"(control_));
#endif
  }

  /// What differs, for messages: "the rounding mode".
  const char* difference(const FloatModes& other) const {
    const std::uint64_t changed = control_ ^ other.control_;
    if ((changed & rounding) != 0) return "the rounding mode";
    if ((changed & flushing) != 0) return "the treatment of subnormal numbers (flush-to-zero)";
    if ((changed & traps) != 0) return "the traps of floating-point exceptions";
    return "the control word of the x87 unit";
  }

  bool operator==(const FloatModes&) const = default;

 private:
#if defined(__x86_64__)
  static constexpr std::uint32_t sse_flags = 0x3f;
  static constexpr std::uint64_t rounding = 0x6000, flushing = 0x8040, traps = 0x1f80;
#else
  static constexpr std::uint64_t rounding = 0xc00000, flushing = 0x1080000, traps = 0x9f00;
#endif
  std::uint64_t control_ = 0;
  std::uint16_t x87_ = 0;
};

}  // namespace suture
