// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace suture {

/// What a file gives, by its extension.
enum class KindOfFile {
  mesh,     ///< .vtu .vtk .mesh .msh
  surface,  ///< .obj .off .ply .stl .vtp
  image,    ///< .nii .nii.gz .mha .mhd .nrrd .nhdr
  other
};
KindOfFile kind_of_file(const std::filesystem::path& path);

/// The end of a message that refuses a file: "; it is a surface: ..." names the key of a scene and
/// the command that take files of this kind. "" for other files.
std::string accepted_as(const std::filesystem::path& path);

}  // namespace suture
