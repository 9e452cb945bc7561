// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/checksum.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string_view>

namespace suture {
namespace {

constexpr std::uint64_t p1 = 0x9E3779B185EBCA87u, p2 = 0xC2B2AE3D27D4EB4Fu,
                        p3 = 0x165667B19E3779F9u, p4 = 0x85EBCA77C2B2AE63u,
                        p5 = 0x27D4EB2F165667C5u;

template <class Word>
std::uint64_t word(const std::byte* bytes) {
  Word value = 0;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

std::uint64_t round(std::uint64_t lane, std::uint64_t word) {
  return std::rotl(lane + word * p2, 31) * p1;
}

}  // namespace

void Checksum::add_stripe(const std::byte* bytes) {
  for (std::size_t i = 0; i < lanes_.size(); ++i)
    lanes_[i] = round(lanes_[i], word<std::uint64_t>(bytes + 8 * i));
}

void Checksum::add(std::span<const std::byte> bytes) {
  const std::size_t held = size_ % stripe;
  size_ += bytes.size();
  if (held != 0) {
    const std::size_t n = std::min(stripe - held, bytes.size());
    std::copy_n(bytes.begin(), n, rest_.begin() + static_cast<std::ptrdiff_t>(held));
    bytes = bytes.subspan(n);
    if (held + n < stripe) return;
    add_stripe(rest_.data());
  }
  for (; bytes.size() >= stripe; bytes = bytes.subspan(stripe)) add_stripe(bytes.data());
  std::copy(bytes.begin(), bytes.end(), rest_.begin());
}

std::uint64_t Checksum::value() const {
  std::uint64_t hash = p5;
  if (size_ >= stripe) {
    hash = std::rotl(lanes_[0], 1) + std::rotl(lanes_[1], 7) + std::rotl(lanes_[2], 12) +
           std::rotl(lanes_[3], 18);
    for (const std::uint64_t lane : lanes_) hash = (hash ^ round(0, lane)) * p1 + p4;
  }
  hash += size_;
  std::span<const std::byte> rest(rest_.data(), size_ % stripe);
  for (; rest.size() >= 8; rest = rest.subspan(8))
    hash = std::rotl(hash ^ round(0, word<std::uint64_t>(rest.data())), 27) * p1 + p4;
  for (; rest.size() >= 4; rest = rest.subspan(4))
    hash = std::rotl(hash ^ (word<std::uint32_t>(rest.data()) * p1), 23) * p2 + p3;
  for (; !rest.empty(); rest = rest.subspan(1))
    hash = std::rotl(hash ^ (static_cast<std::uint64_t>(rest[0]) * p5), 11) * p1;
  hash = (hash ^ (hash >> 33)) * p2;
  hash = (hash ^ (hash >> 29)) * p3;
  return hash ^ (hash >> 32);
}

std::string Checksum::text() const {
  std::uint64_t left = value();
  constexpr std::string_view digits = "0123456789abcdef";
  std::string digits_of(16, '0');
  for (std::size_t i = 16; i-- > 0; left >>= 4) digits_of[i] = digits[left & 15];
  return digits_of;
}

}  // namespace suture
