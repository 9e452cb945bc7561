// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/pvd.hpp"

#include <charconv>
#include <fstream>
#include <sstream>

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
  times_.push_back(time);
  files_.push_back(file);
  write();
}

void PvdFile::write() const {
  std::string text =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "  <Collection>\n";
  for (std::size_t i = 0; i < files_.size(); ++i)
    text += "    <DataSet timestep=\"" + shortest(times_[i]) + "\" part=\"0\" file=\"" + files_[i] +
            "\"/>\n";
  write_file(path_, text + "  </Collection>\n</VTKFile>\n");
}

void PvdFile::state(Archive& archive) {
  // One text, a line for each: thousands of arrays would be slow.
  std::string lines;
  for (const std::string& file : files_) lines += file + '\n';
  archive("times", times_);
  archive("files", lines);
  if (!archive.loads()) return;
  files_.clear();
  std::istringstream stream(lines);
  for (std::string line; std::getline(stream, line);) files_.push_back(line);
  archive.require(files_.size() == times_.size(), "the frames have another number of times");
}

std::size_t PvdFile::leave_out_missing() {
  std::size_t kept = 0;
  const std::size_t before = files_.size();
  for (std::size_t i = 0; i < before; ++i) {
    std::error_code ignored;
    if (!std::filesystem::exists(path_.parent_path() / files_[i], ignored)) continue;
    times_[kept] = times_[i];
    files_[kept++] = files_[i];
  }
  times_.resize(kept);
  files_.resize(kept);
  return before - kept;
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
