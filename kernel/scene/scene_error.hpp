// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "kernel/base/error.hpp"

namespace suture {

/// One mistake of a scene.
struct SceneMistake {
  std::string path;        ///< JSON pointer: "/solver/dt"; "" for the syntax of the whole text
  std::uint32_t line = 0;  ///< in the text, 1-based; 0: the mistake is in `set`
  std::string set;         ///< the text given with --set
  std::string text;
};

/// The mistakes of a scene: what() lists them all for people, mistakes() for programs.
class SceneError : public InputError {
 public:
  SceneError(const std::string& text, std::vector<SceneMistake> mistakes)
      : InputError(text), mistakes_(std::move(mistakes)) {}
  const std::vector<SceneMistake>& mistakes() const { return mistakes_; }

 private:
  std::vector<SceneMistake> mistakes_;
};

}  // namespace suture
