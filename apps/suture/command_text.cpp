// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture/command_text.hpp"

#include "kernel/base/error.hpp"
#include "kernel/base/nearest.hpp"

namespace suture {
namespace {

struct Note {
  const char *name, *meaning;
};

constexpr Note exit_codes[] = {
    {"0", "success"},
    {"1", "a difference beyond the tolerance of compare"},
    {"2", "usage"},
    {"3", "scene or mesh"},
    {"4",
     "plugin missing, refused or at fault (an exception, a crash, exit(), a call of 20 s), or a "
     "model that breaks a law of check-model"},
    {"5", "numerical"},
    {"6", "file system or memory"},
    {"128 + n",
     "stopped by signal n (130: Ctrl-C; the first finishes or gives up the step and writes a "
     "frame, the second kills the process)"}};

constexpr Note environment[] = {{"SUTURE_ISA=avx512|avx2|base", "limits the instruction set"},
                                {"SUTURE_PLUGIN_PATH", "folders of plugins"},
                                {"SUTURE_PLUGIN_TIMEOUT=SECONDS", "limits one call of a plugin"}};

/// "--output, -o DIR", "[scene]".
std::string head_of(const OptionText& option) {
  std::string head;
  for (const std::string& name : option.names) head += (head.empty() ? "" : ", ") + name;
  if (option.names.empty()) head = option.required ? option.place : "[" + option.place + "]";
  return option.value.empty() || option.names.empty() ? head : head + " " + option.value;
}

// ---------------------------------------------------------------------- groff --

/// Text in which groff sees no requests, escapes or typographic hyphens.
std::string groff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n'))
      out += std::string("\\&") + c;
    else
      out += c;
  }
  return out;
}

std::string item(const std::string& head, const std::string& text) {
  return ".TP\n.B " + groff(head) + "\n" + groff(text) + "\n";
}

/// A command, then those below it.
void add_section(const CommandText& command, std::string& page) {
  if (command.commands.empty()) {
    page += ".SS " + groff(command.name) + "\n" + groff(command.help) + "\n";
    for (const OptionText& option : command.options)
      if (option.names.empty() || option.names[0] != "--help")
        page += item(head_of(option), option.help);
  }
  for (const CommandText& below : command.commands) add_section(below, page);
}

// ----------------------------------------------------------------- completion --

void for_each_command(const CommandText& command, const auto& visit) {
  visit(command);
  for (const CommandText& below : command.commands) for_each_command(below, visit);
}

bool takes_model(const CommandText& command) {
  return !command.options.empty() && [&] {
    for (const OptionText& option : command.options)
      if (option.names.empty()) return option.place == "model";
    return false;
  }();
}

/// 'text' in single quotes of a shell.
std::string shell(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string joined_names(const CommandText& command) {
  std::string names;
  for (const CommandText& below : command.commands) names += below.last_name() + " ";
  for (const OptionText& option : command.options)
    for (const std::string& name : option.names) names += name + " ";
  return names;
}

/// The part of both scripts that finds the command before the cursor: "suture mesh info".
std::string command_cases(const CommandText& program) {
  std::string cases;
  for_each_command(program, [&](const CommandText& command) {
    if (&command != &program) cases += (cases.empty() ? "" : "|") + shell(command.name);
  });
  return "      " + cases + ") command=\"$command $word\" ;;\n";
}

/// The ids of all models, one per line.
constexpr const char* list_models =
    R"(suture models 2>/dev/null | sed 's/  \[.*//; s/, /\n/g' | sort -u)";

/// Choices of options, such as --at rest|equilibrium, by "COMMAND OPTION".
std::string choice_cases(const CommandText& program, const std::string& action) {
  std::string cases;
  for_each_command(program, [&](const CommandText& command) {
    for (const OptionText& option : command.options) {
      if (option.value.find('|') == std::string::npos) continue;
      std::string choices = option.value;
      for (char& c : choices)
        if (c == '|') c = ' ';
      for (const std::string& name : option.names)
        cases +=
            "    " + shell(command.name + " " + name) + ") " + action + choices + "; return ;;\n";
    }
  });
  return cases;
}

}  // namespace

std::string guide_text(const std::string& about) {
  return about + R"(

Your first run:
  suture new-scene beam.json   writes a scene: a beam that sags and is cut
  suture run beam.json         simulates it
  suture plot out/beam         draws the results into out/beam/plot.png

Then change beam.json. These help:
  suture check beam.json       names every mistake, with its line
  suture plot beam.json        draws the mesh, its sets and what the scene holds
  suture models                lists the materials; suture describe MODEL explains one

All commands: suture --help. Options of one: suture COMMAND --help.
The guide docs/first-scene.md goes on from here.
)";
}

std::string notes_text() {
  const auto list = [](const auto& notes) {
    std::string text;
    for (const Note& note : notes)
      text += std::string("  ") + note.name + ": " + note.meaning + "\n";
    return text;
  };
  return "Exit codes:\n" + list(exit_codes) + "Environment:\n" + list(environment) +
         "The scene format: docs/scene-format.md.";
}

std::string man_page(const CommandText& program, const std::string& version) {
  std::string page = ".TH SUTURE 1 \"\" " + groff("\"Suture " + version + "\"") +
                     " \"Suture\"\n.SH NAME\nsuture \\- " + groff(program.help) +
                     "\n.SH SYNOPSIS\n.B suture\n.I COMMAND\n[\\fIOPTIONS\\fR] [\\fIFILES\\fR]\n"
                     ".SH OPTIONS\n";
  for (const OptionText& option : program.options) page += item(head_of(option), option.help);
  page += ".SH COMMANDS\n";
  for (const CommandText& command : program.commands) add_section(command, page);
  page += ".SH EXIT STATUS\n";
  for (const Note& note : exit_codes) page += item(note.name, note.meaning);
  page += ".SH ENVIRONMENT\n";
  for (const Note& note : environment) page += item(note.name, note.meaning);
  return page;
}

std::string bash_completion(const CommandText& program) {
  std::string script =
      "# Completion of suture in bash, written by `suture completion bash`.\n"
      "_suture() {\n"
      "  local current=${COMP_WORDS[COMP_CWORD]} command=suture word words=\n"
      "  for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n"
      "    case \"$command $word\" in\n" +
      command_cases(program) +
      "    esac\n"
      "  done\n"
      "  complete_with() { mapfile -t COMPREPLY < <(compgen -W \"$*\" -- \"$current\"); }\n"
      "  case \"$command ${COMP_WORDS[COMP_CWORD-1]}\" in\n" +
      choice_cases(program, "complete_with ") +
      "  esac\n"
      "  case $command in\n";
  for_each_command(program, [&](const CommandText& command) {
    script += "    " + shell(command.name) + ") words=" + shell(joined_names(command));
    if (takes_model(command)) script += std::string("$(") + list_models + ")";
    script += " ;;\n";
  });
  return script +
         "  esac\n"
         "  complete_with $words\n"
         "}\n"
         "complete -o default -F _suture suture\n";
}

std::string zsh_completion(const CommandText& program) {
  std::string script =
      "#compdef suture\n"
      "# Completion of suture in zsh, written by `suture completion zsh`.\n"
      "_suture() {\n"
      "  local command=suture word\n"
      "  local -a below options\n"
      "  for word in ${words[2,CURRENT-1]}; do\n"
      "    case \"$command $word\" in\n" +
      command_cases(program) +
      "    esac\n"
      "  done\n"
      "  case \"$command ${words[CURRENT-1]}\" in\n" +
      choice_cases(program, "compadd ") +
      "  esac\n"
      "  case $command in\n";
  const auto described = [](const std::string& name, const std::string& help) {
    std::string text = name;
    for (std::size_t at = text.find(':'); at != text.npos; at = text.find(':', at + 2))
      text.insert(at, "\\");
    return shell(text + ":" + help) + " ";
  };
  for_each_command(program, [&](const CommandText& command) {
    script += "    " + shell(command.name) + ")\n      below=( ";
    for (const CommandText& inner : command.commands)
      script += described(inner.last_name(), inner.help);
    if (takes_model(command)) script += std::string("${(f)\"$(") + list_models + ")\"} ";
    script += ")\n      options=( ";
    for (const OptionText& option : command.options)
      for (const std::string& name : option.names) script += described(name, option.help);
    script += ") ;;\n";
  });
  return script +
         "  esac\n"
         "  if [[ $PREFIX == -* ]]; then\n"
         "    _describe option options\n"
         "  elif (( $#below )); then\n"
         "    _describe command below\n"
         "  else\n"
         "    _files\n"
         "  fi\n"
         "}\n"
         "_suture \"$@\"\n";
}

void fail_with_word(const CommandText& command, const std::vector<OptionText>& around,
                    const std::string& word) {
  if (word.starts_with('-')) {
    std::vector<std::string> names;
    for (const auto* options : {&command.options, &around})
      for (const OptionText& option : *options)
        names.insert(names.end(), option.names.begin(), option.names.end());
    throw UsageError(command.name + ": unknown option '" + word + "'" +
                     did_you_mean(word.substr(0, word.find('=')), names) + "; '" + command.name +
                     " --help' lists them");
  }
  std::vector<std::string> commands;
  std::string list;
  for (const CommandText& below : command.commands) {
    commands.push_back(below.last_name());
    list += (list.empty() ? "" : ", ") + commands.back();
  }
  if (commands.empty())
    throw UsageError(command.name + ": '" + word + "' is an unexpected argument");
  throw UsageError(command.name + ": unknown command '" + word + "'" +
                   did_you_mean(word, commands) + "; expected one of " + list);
}

}  // namespace suture
