// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>

#include "apps/suture/child_process.hpp"
#include "apps/suture/commands.hpp"
#include "apps/suture/failed_check.hpp"
#include "kernel/base/error.hpp"
#include "kernel/plugin_host/plugin_library.hpp"

namespace suture {
namespace {

using Json = nlohmann::ordered_json;
using Status = CheckOutcome::Status;

/// What a check found with one build of the plugin.
struct Finding {
  Status status = Status::not_applicable;
  double figure = 0;
  std::string text, isa;
};

std::string two_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", value);
  return text;
}

const suture_model& model_in(const PluginFile& build, const std::string& id) {
  const suture_plugin& plugin = load_plugin(build.file, build.note);
  for (const suture_model& model : std::span(plugin.models, plugin.model_count))
    if (model.id == id) return model;
  throw PluginError("plugin " + build.file.string() + " has no model '" + id + "'");
}

/// Makes checks of one model; each in a process of its own, where the plugin is loaded.
class ModelChecking {
 public:
  ModelChecking(const CheckModelCommand& command, std::string id, std::vector<PluginFile> builds)
      : command_(command), id_(std::move(id)), builds_(std::move(builds)) {}

  /// Loads the plugin once: throws what is wrong with its tables or the values of parameters.
  void require_good_tables() const {
    const ChildResult child = run_in_child(
        [&] {
          parameter_sets(model_in(builds_.front(), id_), command_.sets);
          return std::string();
        },
        command_.timeout);
    if (child.end == ChildResult::End::returned) return;
    if (child.end == ChildResult::End::exited && child.code == 2) throw UsageError(child.message);
    throw PluginError(fault_of(child));
  }

  /// With the build that does worst.
  Finding make(const ModelCheck& check) const {
    Finding worst;
    for (const PluginFile& build : builds_) {
      const Finding found = make(check, build);
      const bool is_worse = rank(found.status) > rank(worst.status) ||
                            (found.status == worst.status && found.figure > worst.figure);
      if (is_worse || worst.isa.empty()) worst = found;
      if (compares_builds(check)) break;
    }
    return worst;
  }
  std::filesystem::path file_of(const ModelCheck& check) const {
    return command_.output / (id_ + "-" + check.name + ".json");
  }

 private:
  static bool compares_builds(const ModelCheck& check) {
    return std::strcmp(check.name, "builds") == 0;
  }
  static int rank(Status status) {
    return status == Status::failed ? 2 : status == Status::passed ? 1 : 0;
  }

  Finding make(const ModelCheck& check, const PluginFile& build) const {
    const ChildResult child =
        run_in_child([&] { return in_child(check, build); }, command_.timeout);
    Finding found{Status::failed, 0, fault_of(child), build.note.isa};
    if (!found.text.empty()) return found;
    const Json json = Json::parse(child.output);
    found.status = static_cast<Status>(json.at("status").get<int>());
    found.figure = json.at("figure").is_null() ? INFINITY : json.at("figure").get<double>();
    found.text = json.at("text").get<std::string>();
    return found;
  }

  /// Returns the outcome as JSON.
  std::string in_child(const ModelCheck& check, const PluginFile& build) const {
    std::vector<const suture_model*> models{&model_in(build, id_)};
    if (compares_builds(check))
      for (const PluginFile& other : builds_) models.push_back(&model_in(other, id_));
    if (models.size() == 2) models.pop_back();  // the only build, twice
    CheckOutcome outcome =
        make_check(check, models, parameter_sets(*models[0], command_.sets), command_.seed);
    if (outcome.sample && !compares_builds(check)) write(check, build, outcome);
    return Json{{"status", static_cast<int>(outcome.status)},
                {"figure", outcome.figure},
                {"text", outcome.text}}
        .dump();
  }
  void write(const ModelCheck& check, const PluginFile& build, CheckOutcome& outcome) const {
    FailedCheck failed{check.name,      id_, build.note.isa, build.file,
                       *outcome.sample, "",  outcome.batch};
    if (failed.batch) failed.functor = failed.batch->functor->name;
    write_failed_check(file_of(check), failed);
  }

  /// What the child wrote to standard error, as a part of a line.
  static std::string said_by(const ChildResult& child) {
    std::string text = child.message;
    while (text.ends_with('\n')) text.pop_back();
    constexpr std::string_view prefix = "suture: error: ";
    return text.starts_with(prefix) ? text.substr(prefix.size()) : text;
  }
  /// Why the child has no outcome; empty if it has.
  std::string fault_of(const ChildResult& child) const {
    const std::string said = said_by(child), after = said.empty() ? "" : ": " + said;
    switch (child.end) {
      case ChildResult::End::returned:
        return "";
      case ChildResult::End::exited:
        return said;
      case ChildResult::End::killed:
        return std::string("the process ended by ") + strsignal(child.code) + after;
      case ChildResult::End::timed_out:
        return "the check takes longer than " + two_digits(command_.timeout) + " s (--timeout)" +
               after;
    }
    return "";
  }

  const CheckModelCommand& command_;
  std::string id_;
  std::vector<PluginFile> builds_;
};

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size() + 1), ' ');
  return text;
}

void print(const ModelCheck& check, const Finding& found, const std::filesystem::path& file,
           Console& console) {
  const std::string name = padded(check.name, 16);
  if (found.status == Status::not_applicable) {
    if (!console.quiet()) console.print("  not applicable  " + name + found.text);
    return;
  }
  const bool passed = found.status == Status::passed;
  if (passed && console.quiet()) return;
  std::string figure;
  if (std::isinf(check.limit))
    figure = "; " + found.text;
  else if (check.limit > 0 && (passed || found.figure > 0))
    figure = "; " + two_digits(found.figure) + ", limit " + two_digits(check.limit);
  console.print((passed ? "  passed          " : "  FAILED          ") + name + check.law + figure);
  if (passed) return;
  console.print("      " + found.isa + ": " + found.text);
  if (std::filesystem::exists(file))
    console.print("      `suture replay " + file.string() + "` repeats it");
}

Json to_json(const ModelCheck& check, const Finding& found, const std::filesystem::path& file) {
  constexpr const char* states[] = {"passed", "failed", "not applicable"};
  Json json = {{"check", check.name},
               {"law", check.law},
               {"status", states[static_cast<int>(found.status)]},
               {"build", found.isa},
               {"figure", found.figure},
               {"limit", check.limit},
               {"text", found.text}};
  if (found.status == Status::failed && std::filesystem::exists(file)) json["file"] = file.string();
  return json;
}

/// Returns the names of the laws that do not hold.
std::vector<std::string> check_one(const CheckModelCommand& command, const std::string& id,
                                   const std::vector<PluginFile>& builds, Json& results,
                                   Console& console) {
  const ModelChecking checking(command, id, builds);
  Json checks = Json::array();
  std::vector<std::string> broken;
  checking.require_good_tables();
  if (!command.json)
    console.print("model '" + id + "' of " + builds.front().file.parent_path().string() + "/" +
                  builds.front().name + ".so, seed " + std::to_string(command.seed));
  for (const ModelCheck& check : model_checks()) {
    const bool wanted =
        command.only.empty() || std::ranges::find(command.only, check.name) != command.only.end();
    if (!wanted) continue;
    const std::filesystem::path file = checking.file_of(check);
    std::error_code ignored;
    std::filesystem::remove(file, ignored);  // of an earlier check
    const Finding found = checking.make(check);
    if (found.status == Status::failed) broken.emplace_back(check.name);
    if (command.json)
      checks.push_back(to_json(check, found, file));
    else
      print(check, found, file, console);
  }
  results.push_back({{"model", id}, {"seed", command.seed}, {"checks", checks}});
  return broken;
}

struct ModelsOfFile {
  std::vector<std::string> ids;
  std::vector<PluginFile> builds;  ///< that this processor runs
};

/// The models of a plugin file, or of the plugin with a model of this name. Nothing is loaded.
ModelsOfFile find_models(const std::string& what, Console& console) {
  PluginHost host(&console.diagnostics());
  if (what.find('/') == std::string::npos && !what.ends_with(".so"))
    return {{what}, host.builds(what)};
  host.add_file(what);
  const std::vector<std::string> ids = host.models_of_files();
  return {ids, host.builds(ids.front())};
}

}  // namespace

int check_model(const CheckModelCommand& command, Console& console) {
  if (command.list) {
    for (const ModelCheck& check : model_checks())
      console.print(padded(check.name, 16) + check.law);
    return 0;
  }
  for (const std::string& name : command.only) find_check(name);
  const ModelsOfFile models = find_models(command.model, console);
  Json results = Json::array();
  std::string broken;
  for (const std::string& id : models.ids) {
    const auto names = check_one(command, id, models.builds, results, console);
    for (const std::string& name : names) broken += (broken.empty() ? "" : ", ") + name;
  }
  if (command.json) console.print(results.dump(2));
  if (broken.empty()) return 0;
  throw PluginError("'" + command.model + "' breaks these laws: " + broken);
}

}  // namespace suture
