// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/plugin_library.hpp"

#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string_view>

#include "kernel/base/error.hpp"
#include "kernel/plugin_host/elf_check.hpp"
#include "kernel/plugin_host/extension_check.hpp"
#include "kernel/plugin_host/library_loading.hpp"
#include "kernel/plugin_host/table_check.hpp"
#include "kernel/plugin_host/table_copy.hpp"

namespace suture {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& why) {
  throw PluginError("plugin " + file.string() + ": " + why);
}

/// What usually lies behind a text of the dynamic loader.
std::string_view hint(std::string_view loader_text) {
  const auto says = [&](std::string_view part) {
    return loader_text.find(part) != std::string_view::npos;
  };
  if (says("undefined symbol"))
    return "a library is missing from the plugin's link line; suture_add_plugin reports this when "
           "the plugin is built (-Wl,-z,defs)";
  if (says("GLIBC") || says("CXXABI"))
    return "the plugin was built on a newer system; rebuild it on this one";
  if (says("cannot open shared object file"))
    return "a library that the plugin needs is not installed; `ldd` on the plugin lists them";
  if (says("static TLS"))
    return "the plugin uses initial-exec thread-local storage; build it without -ftls-model";
  return "rebuild the plugin with suture_add_plugin";
}

void require_none(const std::vector<std::string>& problems, const std::filesystem::path& file) {
  if (problems.empty()) return;
  std::string all = "its tables cannot be used:";
  for (const auto& problem : problems) all += "\n  " + problem;
  refuse(file, all);
}

/// Checked copies of the tables, one per library. Like the library, which is never unloaded, they
/// outlive everything: also the handlers of exit() that name a plugin.
using AllTables = std::map<const suture_plugin*, std::unique_ptr<PluginTables>>;
AllTables& all_tables() {
  static auto& tables = *new AllTables;
  return tables;
}

const suture_plugin& add_tables(const suture_plugin& plugin, const std::filesystem::path& file) {
  std::vector<std::string> problems;
  auto tables = copy_tables(plugin, problems);
  if (problems.empty()) problems = table_problems(tables->plugin);
  require_none(problems, file);
  return (all_tables()[&plugin] = std::move(tables))->plugin;
}

void check_against_note(const std::filesystem::path& file, const PluginNote& note,
                        const suture_plugin& plugin) {
  std::set<std::string> ids;
  for (std::uint32_t i = 0; i < plugin.model_count; ++i) ids.insert(plugin.models[i].id);
  const std::set<std::string> noted(note.models.begin(), note.models.end());
  if (plugin.id != note.plugin || ids != noted)
    refuse(file, "its note (plugin '" + note.plugin + "', " + std::to_string(noted.size()) +
                     " models) and its tables (plugin '" + plugin.id + "', " +
                     std::to_string(ids.size()) + " models) name different ids; rebuild it");
}

}  // namespace

const suture_plugin& load_plugin(const std::filesystem::path& file, const PluginNote& note) {
  if (!note.problem.empty()) refuse(file, note.problem);
  if (const std::string problem = elf_problem(file); !problem.empty()) refuse(file, problem);
  static std::mutex one_at_a_time;  // hosts on several threads
  const std::lock_guard lock(one_at_a_time);
  boost::dll::shared_library library;
  PluginCall call{.function = "loading", .file = file.c_str()};
  if (const std::string said = load_for_good(library, file, call); !said.empty())
    refuse(file, "it cannot be loaded; message of the loader: " + said +
                     ". Hint: " + std::string(hint(said)));
  if (!library.has(SUTURE_PLUGIN_SYMBOL))
    refuse(file, std::string("it exports no function ") + SUTURE_PLUGIN_SYMBOL +
                     "; export one table per plugin (SUTURE_PLUGIN of the C++ layer does)");
  const auto function = library.get<const suture_plugin*()>(SUTURE_PLUGIN_SYMBOL);
  call.function = SUTURE_PLUGIN_SYMBOL;
  const suture_plugin* plugin = call_plugin(call, function);
  if (plugin == nullptr) refuse(file, std::string(SUTURE_PLUGIN_SYMBOL) + " returned NULL");

  if (const auto known = all_tables().find(plugin); known != all_tables().end()) {
    check_against_note(file, note, known->second->plugin);
    return known->second->plugin;
  }
  const suture_plugin& tables = add_tables(*plugin, file);
  check_against_note(file, note, tables);
  register_plugin(tables, file);  // what fails from here on is named
  require_none(extension_problems(tables), file);
  return tables;
}

}  // namespace suture
