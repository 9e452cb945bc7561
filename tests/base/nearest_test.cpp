// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/nearest.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace suture {
namespace {

const std::vector<std::string> keys{"gravity", "models", "mesh", "E", "nu"};

TEST(Nearest, FindsTyposAndTranspositions) {
  EXPECT_EQ(nearest("gravty", keys), "gravity");
  EXPECT_EQ(nearest("garvity", keys), "gravity");
  EXPECT_EQ(nearest("Mesh", keys), "mesh");
  EXPECT_EQ(nearest("e", keys), "E");
}

TEST(Nearest, FindsTheOnlyLongerName) {
  const std::vector<std::string> models{"tm-faure", "neo-hookean", "mss-baudet", "mss-golec"};
  EXPECT_EQ(nearest("faure", models), "tm-faure");
  EXPECT_EQ(nearest("NeoHook", models), "neo-hookean");
  EXPECT_EQ(nearest("mss", models), "");  // two
  EXPECT_EQ(nearest("tm", models), "");   // too short
}

TEST(Nearest, SaysNothingWhenNothingIsNear) {
  EXPECT_EQ(nearest("temperature", keys), "");
  EXPECT_EQ(did_you_mean("temperature", keys), "");
  EXPECT_EQ(did_you_mean("modles", keys), " (did you mean 'models'?)");
}

}  // namespace
}  // namespace suture
