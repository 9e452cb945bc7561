// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/plugin_search.hpp"

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include "kernel/base/isa.hpp"
#include "kernel/base/module.hpp"

namespace suture {
namespace {

namespace fs = std::filesystem;

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string() : std::string(value);
}

fs::path user_folder() {
  if (const auto data = environment("XDG_DATA_HOME"); !data.empty())
    return fs::path(data) / "suture" / "plugins";
  if (const auto home = environment("HOME"); !home.empty())
    return fs::path(home) / ".local" / "share" / "suture" / "plugins";
  return {};
}

void add(std::vector<PluginFolder>& folders, const fs::path& path, const std::string& origin) {
  if (path.empty()) return;
  std::error_code code;
  fs::path full = fs::weakly_canonical(path, code);
  if (code) full = fs::absolute(path, code);
  const bool known = std::any_of(folders.begin(), folders.end(),
                                 [&](const PluginFolder& f) { return f.path == full; });
  if (!known) folders.push_back({std::move(full), origin});
}

/// "" for NAME.so, "avx2" for NAME.avx2.so.
std::string_view isa_of_name(std::string_view stem) {
  for (const std::string_view isa : {"avx512", "avx2"})
    if (stem.size() > isa.size() + 1 && stem.substr(stem.size() - isa.size()) == isa &&
        stem[stem.size() - isa.size() - 1] == '.')
      return isa;
  return {};
}

int rank_of_name(const fs::path& file) { return isa_rank(isa_of_name(file.stem().string())); }

}  // namespace

std::vector<PluginFolder> plugin_folders() {
  std::vector<PluginFolder> folders;
  const std::string listed = environment("SUTURE_PLUGIN_PATH");
  for (std::size_t begin = 0; begin < listed.size();) {
    const std::size_t end = std::min(listed.find(':', begin), listed.size());
    add(folders, listed.substr(begin, end - begin), "SUTURE_PLUGIN_PATH");
    begin = end + 1;
  }
  add(folders, user_folder(), "user folder");
  const fs::path prefix = own_prefix();
  add(folders, prefix / SUTURE_INSTALL_LIBDIR / "suture" / "plugins", "beside the program");
  add(folders, prefix / "lib" / "suture" / "plugins", "beside the program");
  return folders;
}

std::string plugin_name(const fs::path& file) {
  const std::string stem = file.stem().string();
  const auto isa = isa_of_name(stem);
  return isa.empty() ? stem : stem.substr(0, stem.size() - isa.size() - 1);
}

std::vector<PluginFile> plugin_files(const fs::path& folder) {
  std::vector<PluginFile> files;
  std::error_code code;
  for (fs::directory_iterator at(folder, code), end; !code && at != end; at.increment(code))
    if (at->path().extension() == ".so")
      files.push_back({at->path(), plugin_name(at->path()), read_note(at->path())});
  std::sort(files.begin(), files.end(), [](const PluginFile& a, const PluginFile& b) {
    if (a.name != b.name) return a.name < b.name;
    return rank_of_name(a.file) > rank_of_name(b.file);
  });
  return files;
}

const PluginFile& best_build(const std::vector<PluginFile>& builds) {
  const PluginFile* best = nullptr;
  for (const auto& build : builds)
    if (build.note.problem.empty() &&
        (best == nullptr || isa_rank(build.note.isa) > isa_rank(best->note.isa)))
      best = &build;
  return best != nullptr ? *best : builds.front();
}

std::vector<PluginFile> builds_of(const fs::path& file) {
  std::vector<PluginFile> builds;
  std::error_code code;
  const auto consider = [&](const fs::path& candidate) {
    if (fs::exists(candidate, code))
      builds.push_back({candidate, plugin_name(candidate), read_note(candidate)});
  };
  consider(file);
  if (builds.empty() || file.extension() != ".so" || rank_of_name(file) > 0) return builds;
  for (const char* isa : {".avx2.so", ".avx512.so"}) {
    consider(file.parent_path() / (plugin_name(file) + isa));
    if (builds.back().note.plugin != builds.front().note.plugin) builds.pop_back();
  }
  return builds;
}

}  // namespace suture
