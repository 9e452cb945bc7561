// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the fuzzers have found, and what they start from: each must be answered.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/fuzz/targets.hpp"
#include "tests/mesh/temporary_folder.hpp"

namespace suture::fuzz {
namespace {

namespace fs = std::filesystem;

class Reproducers : public testing::TestWithParam<NamedTarget> {};

TEST_P(Reproducers, AreAnswered) {
  for (const char* kind : {"seeds", "reproducers"}) {
    const fs::path folder = fs::path(SUTURE_FUZZ) / kind / GetParam().name;
    if (!fs::exists(folder)) continue;
    for (const auto& entry : fs::directory_iterator(folder)) {
      SCOPED_TRACE(entry.path().string());
      GetParam().run(read_text(entry.path()));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, Reproducers,
                         testing::ValuesIn(targets().begin(), targets().end()),
                         [](const auto& test) { return std::string(test.param.name); });

// A folder whose name is mistyped would be run by nobody.
TEST(ReproducerFolders, BelongToATarget) {
  for (const auto& entry : fs::directory_iterator(fs::path(SUTURE_FUZZ) / "reproducers")) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(std::ranges::any_of(targets(), [&](const NamedTarget& target) {
      return name == target.name;
    })) << name;
  }
}

}  // namespace
}  // namespace suture::fuzz
