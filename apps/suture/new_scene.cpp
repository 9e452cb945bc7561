// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture/commands.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/file.hpp"

namespace suture {
namespace {

/// The scene of README.md, from docs/tutorial.
constexpr const char* first_scene =
#include "first_scene.inc"
    ;

}  // namespace

int new_scene(const NewSceneCommand& command, Console& console) {
  std::error_code error;
  if (std::filesystem::exists(std::filesystem::symlink_status(command.to, error)))
    throw UsageError(command.to.string() + " exists already; choose another name, or remove it");
  write_file(command.to, first_scene);
  console.print("suture run " + command.to.string());
  console.print("suture plot out/" + command.to.stem().string());
  return 0;
}

}  // namespace suture
