// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace suture {

/// What a new model starts from.
struct ModelLevel {
  std::string_view name;        ///< "law"
  std::string_view source;      ///< of model.cpp
  std::string_view parameters;  ///< in the scene
};
std::span<const ModelLevel> model_levels();

/// A file of a new model, where "@id@" stands for the model's id, "@Struct@" for the name of its
/// type and "@parameters@" for those of the level.
struct TemplateFile {
  std::string_view name, text;
};
std::vector<TemplateFile> files_of(const ModelLevel& level);

}  // namespace suture
