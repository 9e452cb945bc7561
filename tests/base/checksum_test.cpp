// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/checksum.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string_view>
#include <vector>

namespace suture {
namespace {

std::string sum_of(std::string_view text) {
  Checksum sum;
  sum.add(std::as_bytes(std::span(text)));
  return sum.text();
}

TEST(Checksum, HasThePublishedValues) {
  EXPECT_EQ(sum_of(""), "ef46db3751d8e999");
  EXPECT_EQ(sum_of("a"), "d24ec4f1a98c6e5b");
  EXPECT_EQ(sum_of("abc"), "44bc2cf5ad770999");
  EXPECT_EQ(sum_of("Nobody inspects the spammish repetition"), "fbcea83c8a378bf1");
}

TEST(Checksum, IsTheSameForBytesInPieces) {
  std::mt19937_64 random(1);
  std::vector<std::byte> bytes(1000);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
  Checksum whole;
  whole.add(bytes);
  for (int round = 0; round < 100; ++round) {
    Checksum pieces;
    for (std::size_t at = 0; at < bytes.size();) {
      const std::size_t n = std::min<std::size_t>(random() % 70, bytes.size() - at);
      pieces.add(std::span(bytes).subspan(at, n));
      at += n;
    }
    ASSERT_EQ(pieces.value(), whole.value());
  }
}

}  // namespace
}  // namespace suture
