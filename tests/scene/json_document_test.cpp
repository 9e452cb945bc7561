// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/scene/json_document.hpp"

#include <gtest/gtest.h>

#include <bit>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

// The text of the error that the JSON gives, or "".
std::string error_of(const std::string& text) {
  try {
    parse_json(text, "s.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void expect_error(const std::string& text, const std::string& place, const std::string& words) {
  const std::string error = error_of(text);
  EXPECT_EQ(error.find("s.json:" + place + ": "), 0u) << error;
  EXPECT_NE(error.find(words), std::string::npos) << error;
}

TEST(JsonDocument, KnowsWhereEverythingStands) {
  const JsonValue root = parse_json(
      "// a comment, with \"quotes\" and {\n"
      "{ \"a\" : 1e-4, /* b: */ \"b\":\n"
      "  [true, \"x,\\\"]\", -3 ,{}],\n"
      "\t\"c\":null}",
      "s.json");
  EXPECT_EQ(root.at.line, 2u);
  ASSERT_EQ(root.members.size(), 3u);
  EXPECT_EQ(root.members[0].at.column, 3u);
  EXPECT_EQ(root.members[0].value.at.column, 9u);
  EXPECT_EQ(root.members[1].at.column, 24u);
  const JsonValue& list = root.members[1].value;
  EXPECT_EQ(list.at.line, 3u);
  EXPECT_EQ(list.at.column, 3u);
  ASSERT_EQ(list.items.size(), 4u);
  EXPECT_EQ(list.items[1].text, "x,\"]");
  EXPECT_EQ(list.items[1].at.column, 10u);
  EXPECT_EQ(list.items[2].at.column, 19u);
  EXPECT_EQ(list.items[3].at.column, 23u);
  EXPECT_EQ(root.members[2].at.line, 4u);
  EXPECT_EQ(root.members[2].at.column, 2u);
  EXPECT_EQ(root.members[2].value.at.column, 6u);
}

TEST(JsonDocument, PositionsSurviveByteOrderMarkAndWindowsLines) {
  const JsonValue root =
      parse_json("\xEF\xBB\xBF{\r\n  \"a\": 1,\r\n  \"b\": 2\r\n}\r\n", "s.json");
  EXPECT_EQ(root.members[1].at.line, 3u);
  EXPECT_EQ(root.members[1].at.column, 3u);
}

TEST(JsonDocument, KeepsDuplicateKeysAndWholeNumbers) {
  const JsonValue root =
      parse_json(R"({"a": 1, "a": 18446744073709551615, "b": 1e3, "c": -1, "d": 0.5})", "s.json");
  ASSERT_EQ(root.members.size(), 5u);
  EXPECT_EQ(root.members[1].value.natural, 18446744073709551615u);
  EXPECT_EQ(root.find("b")->natural, 1000u);
  EXPECT_FALSE(root.find("c")->natural);
  EXPECT_EQ(root.find("c")->number, -1);
  EXPECT_FALSE(root.find("d")->natural);
  EXPECT_EQ(root.find("e"), nullptr);
}

TEST(JsonDocument, SyntaxErrorsSayWhereAndWhatToDo) {
  expect_error("{\"a\": 1\n \"b\": 2}", "2:2", "is a comma missing before it?");
  expect_error("{\"a\": 1,\n}", "2:1", "is there an extra comma before it?");
  expect_error("{\"a\": [1, 2,]}", "1:13", "an extra comma before it?");
  expect_error("{\"a\": [1 2]}", "1:10", "comma missing");
  expect_error("{'a': 1}", "1:2", "double quotes");
  expect_error("{\"a\": NaN}", "1:7", "no NaN");
  expect_error("{\"a\": nan}", "1:7", "no NaN");
  expect_error("{\"a\": -Infinity}", "1:8", "NaN or infinity");
  expect_error("{\"a\": 1e999}", "1:7", "largest number");
  expect_error("{ # note\n}", "1:3", "comments begin with //");
  expect_error("{\"a\": {\"b\": 1}", "1:15", "not closed");
  expect_error("{\"a\": \"\xFF\"}", "1:7", "UTF-8");
  expect_error("{\"a\" 1}", "1:6", "expected ':'");
  expect_error("{} x", "1:4", "expected end of input");
  expect_error("", "1:1", "empty");
  expect_error(" \n", "1:1", "empty");
  expect_error("{\"a\": 01}", "1:8", "");
  expect_error("{} /* open", "1:4", "comment");
}

TEST(JsonDocument, SyntaxErrorsQuoteTheLine) {
  EXPECT_NE(error_of("{\n  \"dt\": 1e-4s,\n}").find("\n      \"dt\": 1e-4s,"), std::string::npos)
      << error_of("{\n  \"dt\": 1e-4s,\n}");
}

TEST(JsonDocument, RefusesEndlessNesting) {
  EXPECT_NE(error_of(std::string(100000, '[')).find("deep"), std::string::npos);
  EXPECT_EQ(error_of(std::string(60, '[') + std::string(60, ']')), "");
}

TEST(JsonDocument, CanonicalTextForgetsOrderAndBlanks) {
  const auto canonical = [](const char* text) { return canonical_json(parse_json(text, "s")); };
  EXPECT_EQ(canonical(R"({"b": [1, 2.50, true], "a": {"x": null, "c": "\""}})"),
            R"({"a":{"c":"\"","x":null},"b":[1,2.5,true]})");
  EXPECT_EQ(canonical("{\"a\": 1e2 /* hundred */}"), canonical("{ \"a\":100.0 }"));
  EXPECT_NE(canonical("{\"a\": 0.1}"), canonical("{\"a\": 0.10000000000000002}"));
}

TEST(JsonDocument, CanonicalTextReadsAsTheSameNumbers) {
  const char* numbers[] = {"0",
                           "-0.0",
                           "0.1",
                           "1e22",
                           "1e300",
                           "-5e-324",
                           "18446744073709551615",
                           "-0.3",
                           "1e6",
                           "2.5e6",
                           "-17",
                           "1e20",
                           "9007199254740993",
                           "0.30000000000000004",
                           "123456789012345678901234567890"};
  for (const char* number : numbers) {
    const JsonValue read = parse_json(number, "s");
    const JsonValue again = parse_json(canonical_json(read), "s");
    EXPECT_EQ(std::bit_cast<std::uint64_t>(again.number), std::bit_cast<std::uint64_t>(read.number))
        << number;
    EXPECT_EQ(again.natural, read.natural) << number;
    EXPECT_EQ(canonical_json(again), canonical_json(read)) << number;
  }
}

}  // namespace
}  // namespace suture
