// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/pvd.hpp"

#include <charconv>
#include <fstream>

#include "kernel/base/file.hpp"

namespace suture {
namespace {

// The shortest text that reads back to the same double.
std::string shortest(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

}  // namespace

void PvdFile::add(double time, const std::string& file) {
  entries_ +=
      "    <DataSet timestep=\"" + shortest(time) + "\" part=\"0\" file=\"" + file + "\"/>\n";
  write_file(path_,
             "<?xml version=\"1.0\"?>\n"
             "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
             "  <Collection>\n" +
                 entries_ + "  </Collection>\n</VTKFile>\n");
}

std::vector<std::string> PvdFile::files_of(const std::filesystem::path& path) {
  std::vector<std::string> files;
  std::ifstream text(path);
  for (std::string line; std::getline(text, line);) {
    constexpr std::string_view key = "file=\"";
    const std::size_t begin = line.find(key);
    if (begin == line.npos) continue;
    const std::size_t end = line.find('"', begin + key.size());
    if (end != line.npos)
      files.push_back(line.substr(begin + key.size(), end - begin - key.size()));
  }
  return files;
}

}  // namespace suture
