// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace suture {

/// What a new model starts from.
struct ModelLevel {
  std::string_view name;          ///< "law"
  std::string_view file;          ///< "model.cpp"
  std::string_view source;        ///< its text
  std::string_view parameters;    ///< in the scene
  std::string_view solid;         ///< another model of the scene, for those that give no mass
  std::string_view motion;        ///< what happens in the scene
  std::string_view integrator{};  ///< of the scene, where it is not the default
};
std::span<const ModelLevel> model_levels();

/// A file of a new model, where "@id@" stands for the model's id, "@Struct@" for the name of its
/// type, and "@file@", "@parameters@", "@solid@", "@motion@" and "@integrator@" for what the level
/// says.
struct TemplateFile {
  std::string_view name, text;
};
std::vector<TemplateFile> files_of(const ModelLevel& level);

namespace templates {
// cell_templates.cpp
extern const std::string_view nodes, faces, constraint, lips, batches, plain_c;
}  // namespace templates

}  // namespace suture
