// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/command_line.hpp"

#include <CLI/CLI.hpp>

namespace suture::bench {

void Option::required() { option_->required(); }
void Option::positive() { option_->check(CLI::PositiveNumber); }
void Option::one_of(const std::vector<std::string>& names) { option_->check(CLI::IsMember(names)); }
void Option::within(int least, int most) { option_->check(CLI::Range(least, most)); }
void Option::within(double least, double most) { option_->check(CLI::Range(least, most)); }

Option Command::option(const std::string& name, OptionValue value, const std::string& help) {
  return Option(std::visit([&](auto* to) { return app_->add_option(name, *to, help); }, value));
}

void Command::flag(const std::string& name, bool* value, const std::string& help) {
  app_->add_flag(name, *value, help);
}

CommandLine::CommandLine()
    : app_(std::make_unique<CLI::App>("Benchmarks of Suture on this machine")) {
  app_->fallthrough();  // --json behind a subcommand, too
  app_->add_option("--json", json_, "Write the figures to this file as well");
  app_->add_subcommand("machine", "No figures: the head of --json, for the scripts beside");
}

CommandLine::~CommandLine() = default;

Command& CommandLine::add(const std::string& name, const std::string& help,
                          std::function<void(Report&)> run) {
  return commands_.emplace_back(app_->add_subcommand(name, help), std::move(run));
}

int CommandLine::run(int argc, const char* const* argv) {
  CLI11_PARSE(*app_, argc, argv);
  Report report;
  const bool all = app_->get_subcommands().empty();
  for (const Command& command : commands_)
    if ((all && !command.only_by_name_) || command.app_->parsed()) command.run_(report);
  if (!json_.empty()) report.write_json(json_);
  return 0;
}

}  // namespace suture::bench
