// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/mesh/accepted_as.hpp"

#include <algorithm>
#include <cctype>
#include <map>

namespace suture {

KindOfFile kind_of_file(const std::filesystem::path& path) {
  static const std::map<std::string, KindOfFile> kinds{
      {".vtu", KindOfFile::mesh},    {".vtk", KindOfFile::mesh},    {".mesh", KindOfFile::mesh},
      {".msh", KindOfFile::mesh},    {".obj", KindOfFile::surface}, {".off", KindOfFile::surface},
      {".ply", KindOfFile::surface}, {".stl", KindOfFile::surface}, {".vtp", KindOfFile::surface},
      {".nii", KindOfFile::image},   {".mha", KindOfFile::image},   {".mhd", KindOfFile::image},
      {".nrrd", KindOfFile::image},  {".nhdr", KindOfFile::image},  {".nii.gz", KindOfFile::image}};
  std::string name = path.filename().string();
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const auto& [extension, kind] : kinds)
    if (name.ends_with(extension)) return kind;
  return KindOfFile::other;
}

std::string accepted_as(const std::filesystem::path& path) {
  switch (kind_of_file(path)) {
    case KindOfFile::mesh:
      return "; it is a mesh: /mesh takes it as \"file\", and with \"cells\" as a shape that is "
             "filled, as 'suture mesh fill' does";
    case KindOfFile::surface:
      return "; it is a surface: /mesh takes it as \"surface\" with \"cells\", and 'suture mesh "
             "fill' shows the result";
    case KindOfFile::image:
      return "; it is an image: /mesh takes it as \"file\" with \"labels\" and \"cells\", and "
             "'suture mesh fill' shows the result; 'suture mesh info' lists its labels";
    case KindOfFile::other:
      break;
  }
  return "";
}

}  // namespace suture
