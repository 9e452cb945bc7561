// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/collection.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <sstream>

#include "kernel/output/frame_pieces.hpp"

namespace suture {
namespace {

// The shortest text that reads back to the same double.
std::string shortest(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

bool is_there(const std::filesystem::path& folder, const std::string& file) {
  std::error_code ignored;
  return std::filesystem::exists(folder / file, ignored);
}

}  // namespace

std::vector<std::string> pieces_of(const std::filesystem::path& folder, const std::string& file) {
  if (!file.ends_with(".pvtu") && !file.ends_with(".pvtp")) return {};
  std::ifstream stream(folder / file, std::ios::binary);
  return pieces_in(std::string(std::istreambuf_iterator<char>(stream), {}));
}

void Collection::add(double time, const std::string& file) {
  times_.push_back(time);
  files_.push_back(file);
}

std::string Collection::text() const {
  std::string text =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "  <Collection>\n";
  for (std::size_t i = 0; i < files_.size(); ++i)
    text += "    <DataSet timestep=\"" + shortest(times_[i]) + "\" part=\"0\" file=\"" + files_[i] +
            "\"/>\n";
  return text + "  </Collection>\n</VTKFile>\n";
}

void Collection::state(Archive& archive) {
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

std::size_t Collection::leave_out_missing(const std::filesystem::path& folder) {
  std::size_t kept = 0;
  const std::size_t before = files_.size();
  for (std::size_t i = 0; i < before; ++i) {
    const auto is_here = [&](const std::string& file) { return is_there(folder, file); };
    if (!is_here(files_[i]) || !std::ranges::all_of(pieces_of(folder, files_[i]), is_here))
      continue;
    times_[kept] = times_[i];
    files_[kept++] = files_[i];
  }
  times_.resize(kept);
  files_.resize(kept);
  return before - kept;
}

}  // namespace suture
