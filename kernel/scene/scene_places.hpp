// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/base/error.hpp"
#include "kernel/scene/json_document.hpp"

namespace suture {

/// Where the parts of a scene are in its text, so that mistakes that only the mesh reveals are
/// reported with a line, too.
class ScenePlaces {
 public:
  /// For a scene that was not read from a text: no place is known.
  ScenePlaces() = default;
  /// `file` as shown to the user; `sets` the texts given with --set.
  ScenePlaces(const JsonValue& root, std::string file, std::vector<std::string> sets);

  /// Rethrows an error. If its lines are "/PATH: TEXT", adds the place of each, sorts them in the
  /// order of the file and adds their number; any other error is unchanged.
  [[noreturn]] void rethrow(const InputError& error) const;

 private:
  void add(const JsonValue& value, const std::string& path);
  JsonPosition of(std::string_view path) const;
  bool is_in_scene(std::string_view path) const;

  std::string file_;
  std::vector<std::string> sets_;
  std::map<std::string, JsonPosition, std::less<>> places_;
};

}  // namespace suture
