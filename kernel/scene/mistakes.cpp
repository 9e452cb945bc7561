// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/scene/mistakes.hpp"

#include <algorithm>
#include <tuple>

#include "kernel/base/escape.hpp"
#include "kernel/scene/scene_error.hpp"

namespace suture {

void Mistakes::add(const JsonPosition& at, const std::string& path, const std::string& text) {
  mistakes_.push_back({at, path, text, false});
}

void Mistakes::add_plugin(const JsonPosition& at, const std::string& path,
                          const std::string& text) {
  mistakes_.push_back({at, path, text, true});
}

std::string Mistakes::place(const JsonPosition& at) const {
  if (at.set > 0) return "--set " + quote(sets_.at(at.set - 1));
  return file_ + ":" + std::to_string(at.line) + ":" + std::to_string(at.column);
}

void Mistakes::throw_if_any() const {
  if (mistakes_.empty()) return;
  std::vector<Mistake> sorted = mistakes_;
  const auto key = [](const Mistake& m) { return std::tuple(m.at.set, m.at.line, m.at.column); };
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](const Mistake& a, const Mistake& b) { return key(a) < key(b); });
  std::string text;
  std::vector<SceneMistake> list;
  bool only_plugins = true;
  for (const Mistake& mistake : sorted) {
    const std::string path = mistake.path.empty() ? "" : mistake.path + ": ";
    text += place(mistake.at) + ": " + path + mistake.text + "\n";
    only_plugins = only_plugins && mistake.plugin;
    const bool in_file = mistake.at.set == 0;
    list.push_back({mistake.path, in_file ? mistake.at.line : 0,
                    in_file ? "" : sets_.at(mistake.at.set - 1), mistake.text});
  }
  text += sorted.size() == 1 ? "1 mistake" : std::to_string(sorted.size()) + " mistakes";
  text += " in " + file_;
  if (only_plugins) throw PluginError(text);
  throw SceneError(text, std::move(list));
}

std::string child_path(const std::string& path, std::string_view key) {
  std::string child = path + "/";
  for (const char c : escaped(key)) {
    if (c == '~') {
      child += "~0";
    } else if (c == '/') {
      child += "~1";
    } else {
      child += c;
    }
  }
  return child;
}

std::string child_path(const std::string& path, std::size_t index) {
  return path + "/" + std::to_string(index);
}

}  // namespace suture
