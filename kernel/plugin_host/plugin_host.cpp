// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/plugin_host.hpp"

#include <algorithm>
#include <optional>

#include "kernel/base/error.hpp"
#include "kernel/base/escape.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/plugin_host/plugin_library.hpp"
#include "kernel/plugin_host/plugin_search.hpp"

namespace suture {
namespace {

namespace fs = std::filesystem;

/// The builds of one plugin for several instruction sets, from one folder.
struct Plugin {
  std::vector<PluginFile> builds;
  int place = 0;  ///< in the search order: 0 the scene, then the folders

  const PluginFile& best() const { return best_build(builds); }
  bool has(std::string_view id) const {
    const auto& models = best().note.models;
    return std::find(models.begin(), models.end(), id) != models.end();
  }
};

std::vector<Plugin> group(std::vector<PluginFile> files, int place) {
  std::vector<Plugin> plugins;
  for (auto& file : files) {
    if (plugins.empty() || plugins.back().builds.front().name != file.name)
      plugins.push_back({{}, place});
    plugins.back().builds.push_back(std::move(file));
  }
  return plugins;
}

/// The file beside `missing` whose name is nearest, for the message.
std::string nearest_file(const fs::path& missing) {
  std::vector<std::string> names;
  for (const auto& file : plugin_files(missing.parent_path()))
    names.push_back(file.file.filename().string());
  return did_you_mean(missing.filename().string(), names);
}

}  // namespace

struct PluginHost::Impl {
  struct Loaded {
    const suture_model* model;
    const suture_plugin* plugin;
    fs::path file;
  };

  Diagnostics* diagnostics;
  Trust trust;
  std::vector<PluginFolder> folders = plugin_folders();
  std::vector<Plugin> named;                   ///< in the scene
  std::optional<std::vector<Plugin>> scanned;  ///< in the folders, once needed
  std::vector<Loaded> loaded;

  std::vector<Plugin> scan() const {
    std::vector<Plugin> all;
    int place = 0;
    for (const auto& folder : folders) {
      auto plugins = group(plugin_files(folder.path), ++place);
      std::move(plugins.begin(), plugins.end(), std::back_inserter(all));
    }
    return all;
  }

  /// Every plugin, in search order.
  std::vector<const Plugin*> plugins() {
    if (!scanned) scanned = scan();
    std::vector<const Plugin*> all;
    for (const auto& plugin : named) all.push_back(&plugin);
    for (const auto& plugin : *scanned) all.push_back(&plugin);
    return all;
  }

  /// Those that have the model, the one to use first.
  std::vector<const Plugin*> with_model(std::string_view id) {
    std::vector<const Plugin*> found;
    for (const Plugin* plugin : plugins()) {
      const bool known = std::any_of(found.begin(), found.end(), [&](const Plugin* other) {
        std::error_code code;
        return fs::equivalent(other->best().file, plugin->best().file, code);
      });
      if (!known && plugin->has(id)) found.push_back(plugin);
    }
    const auto rank = [&](const Plugin* plugin) {
      return std::pair(plugin->place, plugin->place > 0 && plugin->best().name != id);
    };
    std::stable_sort(found.begin(), found.end(),
                     [&](const Plugin* a, const Plugin* b) { return rank(a) < rank(b); });
    return found;
  }

  void warn_of_hidden(std::string_view id, const std::vector<const Plugin*>& found) const {
    if (diagnostics == nullptr) return;
    for (std::size_t i = 1; i < found.size(); ++i)
      diagnostics->warn("model '" + std::string(id) + "' is provided by more than one plugin: " +
                        found.front()->best().file.string() +
                        " is used because it comes first on the search path; " +
                        found[i]->best().file.string() + " is ignored");
  }

  /// True if the file lies in a folder that is searched, where the user has put it.
  bool is_on_search_path(const fs::path& file) const {
    std::error_code code;
    const fs::path parent = fs::weakly_canonical(file.parent_path(), code);
    return std::any_of(folders.begin(), folders.end(),
                       [&](const PluginFolder& folder) { return folder.path == parent; });
  }

  void require_trust(std::string_view id, const Plugin& plugin) const {
    const fs::path& file = plugin.best().file;
    if (trust == Trust::all || plugin.place > 0 || is_on_search_path(file)) return;
    throw PluginError("model " + quote(id) + " is in plugin " + file.string() +
                      ", which the scene names and which lies outside the search path: its code is "
                      "not run. If you trust it, add --trust, or put its folder into "
                      "SUTURE_PLUGIN_PATH");
  }

  /// A damaged build is passed over for another one of the plugin, which may be slower.
  void warn_of_damaged(const Plugin& plugin) const {
    if (diagnostics == nullptr) return;
    for (const PluginFile& build : plugin.builds)
      if (build.note.plugin.empty())
        diagnostics->warn("plugin " + build.file.string() + " is refused: " + build.note.problem +
                          "; " + plugin.best().file.filename().string() + " is used instead");
  }

  /// The plugin to use for a model.
  const Plugin& choose(std::string_view id) {
    const auto found = with_model(id);
    if (found.empty()) not_found(id);
    warn_of_hidden(id, found);
    require_trust(id, *found.front());
    warn_of_damaged(*found.front());
    return *found.front();
  }

  /// Files that might have had a model that was not found.
  std::string refused() {
    std::string text;
    for (const Plugin* plugin : plugins())
      for (const PluginFile& build : plugin->builds)
        if (build.note.plugin.empty())
          text += "\n  " + build.file.string() + ": " + build.note.problem;
    return text.empty() ? text : "\nRefused:" + text;
  }

  std::string searched() const {
    std::string text;
    for (const auto& plugin : named)
      text += "\n  " + plugin.best().file.string() + " (named in the scene)";
    for (const auto& folder : folders) {
      std::error_code code;
      text += "\n  " + folder.path.string() + " (" + folder.origin +
              (fs::is_directory(folder.path, code) ? ")" : ", no such folder)");
    }
    return text;
  }

  [[noreturn]] void not_found(std::string_view id) {
    std::vector<std::string> ids;
    for (const Plugin* plugin : plugins()) {
      const auto& best = plugin->best();
      ids.insert(ids.end(), best.note.models.begin(), best.note.models.end());
      if (best.name == id && !best.note.problem.empty())
        throw PluginError("model " + quote(id) + ": plugin " + best.file.string() + ": " +
                          best.note.problem);
    }
    throw PluginError("no plugin provides the model " + quote(id) + did_you_mean(id, ids) +
                      ". Searched:" + searched() + refused() +
                      "\n`suture models` lists the available models; add the plugin file to "
                      "\"plugins\" in the scene, or its folder to SUTURE_PLUGIN_PATH");
  }
};

PluginHost::PluginHost(Diagnostics* diagnostics, Trust trust) : impl_(std::make_unique<Impl>()) {
  impl_->diagnostics = diagnostics;
  impl_->trust = trust;
}

PluginHost::~PluginHost() = default;

void PluginHost::add_file(const fs::path& file) {
  const fs::path full = fs::absolute(file).lexically_normal();
  auto builds = builds_of(full);
  if (builds.empty()) builds = builds_of(full.string() + ".so");
  if (builds.empty())
    throw PluginError("plugin " + full.string() + ": no such file" + nearest_file(full) +
                      "; paths in a scene are relative to the scene's folder");
  const auto& best = best_build(builds);
  if (!best.note.problem.empty())
    throw PluginError("plugin " + best.file.string() + ": " + best.note.problem);
  impl_->named.push_back({std::move(builds), 0});
}

const suture_model& PluginHost::model(std::string_view id) {
  for (const auto& known : impl_->loaded)
    if (known.model->id == id) return *known.model;

  const PluginFile& best = impl_->choose(id).best();
  const suture_plugin& plugin = load_plugin(best.file, best.note);
  for (std::uint32_t i = 0; i < plugin.model_count; ++i)
    if (plugin.models[i].id == id) {
      impl_->loaded.push_back({&plugin.models[i], &plugin, best.file});
      return plugin.models[i];
    }
  impl_->not_found(id);  // load_plugin has compared the note with the tables
}

std::vector<PluginFile> PluginHost::builds(std::string_view id) {
  std::vector<PluginFile> usable;
  for (const PluginFile& build : impl_->choose(id).builds)
    if (build.note.problem.empty()) usable.push_back(build);
  return usable;
}

std::vector<std::string> PluginHost::models_of_files() const {
  std::vector<std::string> ids;
  for (const Plugin& plugin : impl_->named) {
    const auto& models = plugin.best().note.models;
    ids.insert(ids.end(), models.begin(), models.end());
  }
  return ids;
}

const suture_plugin& PluginHost::plugin_of(const suture_model& model) const {
  for (const auto& known : impl_->loaded)
    if (known.model == &model) return *known.plugin;
  throw PluginError(std::string("model '") + model.id + "' was not loaded by this host");
}

fs::path PluginHost::file_of(const suture_model& model) const {
  for (const auto& known : impl_->loaded)
    if (known.model == &model) return known.file;
  throw PluginError(std::string("model '") + model.id + "' was not loaded by this host");
}

std::vector<PluginHost::Listing> PluginHost::list() const {
  std::vector<Listing> out;
  for (const Plugin* plugin : impl_->plugins())
    for (const auto& build : plugin->builds) {
      Listing line{build.file, build.note.plugin, build.note.models, build.note.isa,
                   build.note.problem};
      for (const auto& id : line.models)
        if (const auto found = impl_->with_model(id);
            line.problem.empty() && !found.empty() && found.front() != plugin)
          line.problem = "its model '" + id + "' is hidden by " +
                         found.front()->best().file.string() + ", earlier on the search path";
      out.push_back(std::move(line));
    }
  return out;
}

}  // namespace suture
