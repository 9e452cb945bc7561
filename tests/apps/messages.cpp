// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/apps/messages.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>

namespace suture::testing {
namespace {

using Sections = std::map<std::string, std::string>;

constexpr const char* heading =
    "# The messages of the tests of mistakes in scenes, meshes, plugins and runs. Fractions are\n"
    "# replaced by '#'. tests/apps/messages.hpp says how to write this file after a change.\n";

Sections read_sections() {
  Sections sections;
  std::ifstream file(SUTURE_MESSAGES_FILE);
  std::string* section = nullptr;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("[["))
      section = &sections[line.substr(2, line.size() - 4)];
    else if (section != nullptr && !line.empty())
      *section += line + '\n';
  }
  return sections;
}

void write_sections(const Sections& sections) {
  std::ofstream file(SUTURE_MESSAGES_FILE);
  file << heading;
  for (const auto& [test, text] : sections) file << "\n[[" << test << "]]\n" << text;
}

void replace_all(std::string& text, const std::string& what, const std::string& by) {
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
}

/// The element that is found unstable depends on rounding: it is that of the release build.
std::string comparable(const std::string& text) {
#ifdef NDEBUG
  return text;
#else
  static const std::regex element(R"((the limit is \d+\) at element )\d+)");
  return std::regex_replace(text, element, "$1#");
#endif
}

bool is_covered(const std::string& suite) {
  for (const char* covered : {"BadScenes", "BadMeshes", "BadElements", "BadImages", "BadPlugins",
                              "Mistakes", "FailedRuns"})
    if (suite == covered) return true;
  return false;
}

}  // namespace

void Messages::add(std::string text, const std::filesystem::path& folder) {
  static const std::regex fraction(R"(0x[0-9a-f]+|\d+\.\d+(e[-+]?\d+)?|\d+e[-+]\d+|\d{3,})");
  static const std::regex isa(R"(\.(avx2|avx512)\.so)");
  const std::filesystem::path build = std::filesystem::path(SUTURE_PROGRAM).parent_path();
  replace_all(text, folder.string(), "FOLDER");
  replace_all(text, build.parent_path().string(), "BUILD");
  text = std::regex_replace(text, fraction, "#");
  text = std::regex_replace(text, isa, ".so");
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    if (!line.empty() && std::ranges::find(lines_, line) == lines_.end()) lines_.push_back(line);
}

void Messages::compare() const {
  const auto& test = *::testing::UnitTest::GetInstance()->current_test_info();
  if (!is_covered(test.test_suite_name()) || lines_.empty() || ::testing::Test::IsSkipped()) return;
  const std::string name = std::string(test.test_suite_name()) + "." + test.name();
  Sections sections = read_sections();
#ifdef SUTURE_SANITIZED
  const std::string section = '\n' + comparable(sections[name]);
  for (const std::string& line : lines_)
    EXPECT_NE(section.find('\n' + comparable(line) + '\n'), std::string::npos) << line;
#else
  std::string text;
  for (const std::string& line : lines_) text += line + '\n';
  const char* mode = std::getenv("SUTURE_MESSAGES");
  if (mode != nullptr && std::string(mode) == "write") {
    sections[name] = text;
    write_sections(sections);
  } else {
    EXPECT_EQ(comparable(text), comparable(sections[name]))
        << "messages differ from " SUTURE_MESSAGES_FILE
        << "; if they are meant to, write it again (messages.hpp)";
  }
#endif
}

}  // namespace suture::testing
