// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/images/text_header.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

#include "kernel/base/input_file.hpp"
#include "kernel/mesh/file_text.hpp"

namespace suture {
namespace {

std::string trimmed(std::string_view text) {
  const auto is_blank = [](char c) { return static_cast<unsigned char>(c) <= ' '; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return std::string(text);
}

}  // namespace

std::string lowered(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

TextHeader::TextHeader(const FileHead& head, char separator, const std::string& last)
    : head_(head), end_(byte_order_mark(head.text)) {
  const std::string_view text = head.text;
  while (end_ < text.size()) {
    const std::size_t stop = std::min(text.find('\n', end_), text.size());
    const std::string line = trimmed(text.substr(end_, stop - end_));
    end_ = std::min(stop + 1, text.size());
    if (line.empty() && last.empty()) return;
    const std::size_t at = line.find(separator);
    if (at == line.npos || line.front() == '#' || line.substr(at).starts_with(":=")) continue;
    const std::string key = lowered(trimmed(std::string_view(line).substr(0, at)));
    values_.emplace(key, trimmed(std::string_view(line).substr(at + 1)));
    if (key == last) return;
  }
  if (!last.empty() || end_ > 90'000) head.fail("the header has no end");
}

std::optional<std::string> TextHeader::find(std::initializer_list<const char*> keys) const {
  for (const char* key : keys)
    if (const auto found = values_.find(lowered(key)); found != values_.end()) return found->second;
  return {};
}

std::string TextHeader::require(const char* key) const {
  const auto value = find({key});
  if (!value) head_.fail(std::string("the header has no '") + key + "'");
  return *value;
}

std::optional<std::vector<double>> TextHeader::numbers(
    std::initializer_list<const char*> keys) const {
  const auto found = find(keys);
  if (!found) return {};
  return numbers_of(*keys.begin(), *found);
}

std::vector<double> TextHeader::numbers_of(const char* key, std::string value) const {
  const std::string shown = value;
  std::ranges::replace_if(
      value, [](char c) { return c == '(' || c == ')' || c == ','; }, ' ');
  std::vector<double> result;
  const char* at = value.data();
  const char* const end = value.data() + value.size();
  while (at != end) {
    if (static_cast<unsigned char>(*at) <= ' ') {
      ++at;
      continue;
    }
    double number = 0;
    const auto [stop, error] = std::from_chars(at, end, number);
    if (error != std::errc{} || (stop != end && static_cast<unsigned char>(*stop) > ' '))
      head_.fail(std::string("'") + key + "' of the header must be numbers, is " +
                 in_quotes(shown));
    result.push_back(number);
    at = stop;
  }
  return result;
}

VoxelType TextHeader::type_named(const char* key, const VoxelTypes& types) const {
  const std::string name = require(key);
  const auto found = types.find(lowered(name));
  if (found == types.end())
    head_.fail("voxels of the type " + in_quotes(name) + " are not read; save labels as integers");
  return found->second;
}

bool TextHeader::is_true(std::initializer_list<const char*> keys) const {
  return lowered(find(keys).value_or("")) == "true";
}

std::filesystem::path TextHeader::beside(const std::string& name) const {
  if (name.empty() || lowered(name).starts_with("list") || name.find('%') != name.npos)
    head_.fail("the voxels are in several files (" + in_quotes(name) + "); save them in one");
  return head_.path.parent_path() / name;
}

}  // namespace suture
