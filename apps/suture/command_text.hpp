// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace suture {

/// An option or an argument, as the command line has it.
struct OptionText {
  std::vector<std::string> names;  ///< "--output", "-o"; none: an argument by its place
  std::string place;               ///< the name of such an argument
  std::string value;               ///< "DIR", "" of a flag, "rest|equilibrium" of a choice
  std::string help;
  bool required = false;
};

/// A command with its options and its own commands: what help, manual page, completion and messages
/// are made from.
struct CommandText {
  std::string name;  ///< "suture mesh info"
  std::string help;
  std::vector<OptionText> options;
  std::vector<CommandText> commands;

  std::string last_name() const { return name.substr(name.rfind(' ') + 1); }
};

/// What the program prints without a command.
std::string guide_text(const std::string& about);
/// For the end of `suture --help`, and the manual page: exit codes and environment variables.
std::string notes_text();

/// A manual page in section 1 (groff, man macros).
std::string man_page(const CommandText& program, const std::string& version);
/// Scripts for bash (complete -F) and zsh (#compdef): commands, options, choices, ids of models,
/// and else files.
std::string bash_completion(const CommandText& program);
std::string zsh_completion(const CommandText& program);

/// Throws UsageError for a word that `command` does not know: an option of it or of the commands
/// around it, a command, or an argument too many. `around`: the options of the latter.
[[noreturn]] void fail_with_word(const CommandText& command, const std::vector<OptionText>& around,
                                 const std::string& word);

}  // namespace suture
