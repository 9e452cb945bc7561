// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace suture {

/// XXH64 (Collet; seed 0) of bytes that arrive in pieces, to detect damage: several GB/s. Not for
/// security.
class Checksum {
 public:
  void add(std::span<const std::byte> bytes);
  std::uint64_t value() const;
  std::string text() const;  ///< 16 hexadecimal digits

 private:
  static constexpr std::size_t stripe = 32;
  void add_stripe(const std::byte* bytes);

  std::array<std::uint64_t, 4> lanes_{0x60EA27EEADC0B5D6u, 0xC2B2AE3D27D4EB4Fu, 0,
                                      0x61C8864E7A143579u};
  std::array<std::byte, stripe> rest_{};
  std::uint64_t size_ = 0;
};

}  // namespace suture
