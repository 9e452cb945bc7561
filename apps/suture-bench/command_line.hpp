// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "apps/suture-bench/report.hpp"
#include "kernel/base/types.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

/// The command line: CLI11 behind plain types, because its templates take longer to compile than a
/// benchmark.
namespace suture::bench {

/// NAME VALUE, as often as the option is given.
using NamedValues = std::vector<std::pair<std::string, double>>;

/// What an option sets: left as it is where the option is not given.
using OptionValue = std::variant<int*, unsigned*, double*, std::string*, std::filesystem::path*,
                                 std::array<Index, 3>*, std::vector<Index>*,
                                 std::vector<std::string>*, NamedValues*>;

/// An option as it was added. A check is made of each of its values; a value that fails ends the
/// program with a message.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}
  void required();
  void positive();
  void one_of(const std::vector<std::string>& names);
  void within(int least, int most);
  void within(double least, double most);

 private:
  CLI::Option* option_;
};

/// A benchmark as a subcommand.
class Command {
 public:
  Command(CLI::App* app, std::function<void(Report&)> run) : app_(app), run_(std::move(run)) {}

  /// `name`: "--name", "-n,--name", or "name" of a value by position.
  Option option(const std::string& name, OptionValue value, const std::string& help);
  /// "!--no-name" sets `value` to false.
  void flag(const std::string& name, bool* value, const std::string& help);
  /// Leaves it out of a run without a subcommand.
  void only_by_name() { only_by_name_ = true; }

 private:
  friend class CommandLine;
  CLI::App* app_;
  std::function<void(Report&)> run_;
  bool only_by_name_ = false;
};

class CommandLine {
 public:
  CommandLine();
  ~CommandLine();

  /// Adds a benchmark. Returns its subcommand and the options that it will be given.
  template <class Options>
  std::pair<Command&, Options&> add(const std::string& name, const std::string& help,
                                    void (*benchmark)(const Options&, Report&)) {
    auto options = std::make_shared<Options>();
    return {add(name, help, [benchmark, options](Report& report) { benchmark(*options, report); }),
            *options};
  }

  /// Runs the benchmark that is named, or all. Returns the exit code. Throws what benchmarks throw.
  int run(int argc, const char* const* argv);

 private:
  Command& add(const std::string& name, const std::string& help, std::function<void(Report&)> run);

  std::unique_ptr<CLI::App> app_;
  std::string json_;  ///< file to write the figures to, or empty
  std::deque<Command> commands_;
};

}  // namespace suture::bench
