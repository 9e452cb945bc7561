// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/escape.hpp"

#include <gtest/gtest.h>

namespace suture {
namespace {

TEST(Escape, LeavesTextInAnyLanguage) {
  const std::string text = "Rippe 7, \u03bc = 0,3 \u2192 \u7d44\u7e54 \U0001f52a \\";
  EXPECT_EQ(escaped(text), text);
  EXPECT_EQ(quote(text), "'" + text + "'");
}

TEST(Escape, ShowsWhatATerminalWouldObey) {
  EXPECT_EQ(escaped("\x1b[2J\a\r\x7f"), "\\x1b[2J\\x07\\x0d\\x7f");
  EXPECT_EQ(escaped("a\u009b2J"), "a\\x9b2J");
  EXPECT_EQ(escaped("a\u202eb\u2066c\u2028d"), "a\\u202eb\\u2066c\\u2028d");
  EXPECT_EQ(escaped(std::string_view("a\0b", 3)), "a\\x00b");
}

TEST(Escape, ShowsBytesThatAreNotUtf8) {
  EXPECT_EQ(escaped("caf\xe9"), "caf\\xe9");                                  // Latin-1
  EXPECT_EQ(escaped("\xc0\xaf \xe0\x80\xaf"), "\\xc0\\xaf \\xe0\\x80\\xaf");  // longer than needed
  EXPECT_EQ(escaped("\xed\xa0\x80"), "\\xed\\xa0\\x80");  // half of a surrogate pair
  EXPECT_EQ(escaped("\xf4\x90\x80\x80\xff"), "\\xf4\\x90\\x80\\x80\\xff");
  EXPECT_EQ(escaped("\xe2\x82"), "\\xe2\\x82");  // cut off
}

TEST(Escape, KeepsTheLinesOfMessagesOnly) {
  EXPECT_EQ(escaped("a\nb\tc"), "a\\nb\\tc");
  EXPECT_EQ(escaped_lines("a\nb\tc\r"), "a\nb\tc\\x0d");
}

}  // namespace
}  // namespace suture
