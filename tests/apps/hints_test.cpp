// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every option and key that a message names is one that the program knows.
#include <fstream>
#include <iterator>
#include <regex>
#include <set>

#include "tests/apps/program.hpp"

namespace suture::testing {
namespace {

namespace fs = std::filesystem;
using Hints = Program;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Every first group of `pattern` in the text.
std::set<std::string> found_in(const std::string& text, const std::regex& pattern) {
  std::set<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match)
    found.insert((*match)[1]);
  return found;
}

/// The string literals of the sources below some folders, one a line.
std::string literals_of(const std::vector<std::string>& folders) {
  static const std::regex literal(R"re("((?:[^"\\\n]|\\.)*)")re");
  std::string text;
  for (const std::string& folder : folders)
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(SUTURE_SOURCES) / folder))
      if (entry.path().extension() == ".cpp" || entry.path().extension() == ".hpp")
        for (const std::string& word : found_in(text_of(entry.path()), literal))
          text += word + '\n';
  return text;
}

TEST_F(Hints, NameOptionsThatTheParserKnows) {
  const std::regex option(R"((?:^|[^-\w])(--[a-z][a-z-]+))");
  std::string help;
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{},
                                             {"run"},
                                             {"live"},
                                             {"check"},
                                             {"explain"},
                                             {"modes"},
                                             {"sweep"},
                                             {"fit"},
                                             {"compare"},
                                             {"plot"},
                                             {"replay"},
                                             {"models"},
                                             {"check-model"},
                                             {"new-model"},
                                             {"describe"},
                                             {"mesh", "info"},
                                             {"mesh", "convert"},
                                             {"mesh", "voxelize"},
                                             {"mesh", "fill"},
                                             {"mesh", "generate", "box"}}) {
    std::vector<std::string> words = command;
    words.emplace_back("--help");
    help += suture(words).out;
  }
  std::set<std::string> known = found_in(help, option);
  EXPECT_GT(known.size(), 12u) << help;
  // Options of gdb, cmake and ctest.
  for (const char* other :
       {"--args", "--build", "--install", "--prefix", "--test-dir", "--output-on-failure"})
    known.insert(other);
  for (const std::string& named : found_in(literals_of({"kernel", "apps/suture"}), option))
    EXPECT_TRUE(known.contains(named)) << named << " is in a message, and no command has it";
}

// A key is read by its name, which is a string literal of its own there.
TEST_F(Hints, NameKeysThatTheSceneHas) {
  const std::string read = "\n" + literals_of({"kernel/build", "kernel/scene"});
  const std::set<std::string> named =
      found_in(literals_of({"kernel", "apps/suture"}), std::regex(R"re(\\"([a-z_]+)\\":)re"));
  EXPECT_GT(named.size(), 4u);
  for (const std::string& key : named)
    EXPECT_NE(read.find("\n" + key + "\n"), std::string::npos)
        << '"' << key << "\" is in a message, and no scene has it";
}

}  // namespace
}  // namespace suture::testing
