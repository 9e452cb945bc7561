// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "kernel/scene/json_document.hpp"

namespace suture {

/// All mistakes of a scene, collected so that they can be reported at once.
class Mistakes {
 public:
  /// `file`: its name as shown to the user; `sets`: the texts given with --set.
  Mistakes(std::string file, std::vector<std::string> sets)
      : file_(std::move(file)), sets_(std::move(sets)) {}

  /// `path` is a JSON pointer: "/solver/dt".
  void add(const JsonPosition& at, const std::string& path, const std::string& text);
  /// A mistake in a plugin rather than in the text of the scene.
  void add_plugin(const JsonPosition& at, const std::string& path, const std::string& text);

  bool empty() const { return mistakes_.empty(); }
  std::size_t count() const { return mistakes_.size(); }
  /// Throws SceneError (PluginError if all of them are in plugins) with one line "FILE:LINE:COLUMN:
  /// PATH: TEXT" per mistake, in the order of the file, and a last line with their number; does
  /// nothing if there is no mistake.
  void throw_if_any() const;

  /// "scene.json:3:7" or "--set '/solver/dt=0'".
  std::string place(const JsonPosition& at) const;

 private:
  struct Mistake {
    JsonPosition at;
    std::string path, text;
    bool plugin;
  };
  std::string file_;
  std::vector<std::string> sets_;
  std::vector<Mistake> mistakes_;
};

/// "/models" + "/" + key, escaped according to RFC 6901.
std::string child_path(const std::string& path, std::string_view key);
std::string child_path(const std::string& path, std::size_t index);

}  // namespace suture
