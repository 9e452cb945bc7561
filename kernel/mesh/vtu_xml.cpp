// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/mesh/vtu_xml.hpp"

#include <algorithm>
#include <utility>

namespace suture {
namespace {

bool is_space(char c) { return static_cast<unsigned char>(c) <= ' '; }

std::string_view between(const char* begin, const char* end) {
  return {begin, static_cast<std::size_t>(end - begin)};
}

}  // namespace

std::string_view XmlTag::operator[](std::string_view key) const {
  std::string_view rest = attributes;
  while (true) {
    const std::size_t equals = rest.find('=');
    if (equals == rest.npos) return {};
    std::string_view found = rest.substr(0, equals);
    while (!found.empty() && is_space(found.back())) found.remove_suffix(1);
    while (!found.empty() && is_space(found.front())) found.remove_prefix(1);
    const std::size_t open = rest.find_first_of("\"'", equals);
    if (open == rest.npos) return {};
    const std::size_t close = rest.find(rest[open], open + 1);
    if (close == rest.npos) return {};
    if (found == key) return rest.substr(open + 1, close - open - 1);
    rest.remove_prefix(close + 1);
  }
}

std::string unescaped(std::string_view value) {
  constexpr std::pair<std::string_view, char> entities[] = {
      {"&quot;", '"'}, {"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&apos;", '\''}};
  std::string text;
  while (!value.empty()) {
    const auto* found =
        std::find_if(std::begin(entities), std::end(entities),
                     [&](const auto& entity) { return value.starts_with(entity.first); });
    const bool is_entity = found != std::end(entities);
    text.push_back(is_entity ? found->second : value.front());
    value.remove_prefix(is_entity ? found->first.size() : 1);
  }
  return text;
}

const char* XmlCursor::end_of_text() const { return std::find(p_, file_.end(), '<'); }

std::optional<XmlTag> XmlCursor::next() {
  while (true) {
    const char* at = end_of_text();
    if (at == file_.end()) return std::nullopt;
    const std::string_view rest = between(at, file_.end());
    if (rest.starts_with("<!--")) {
      const std::size_t end = rest.find("-->");
      if (end == rest.npos) file_.fail_at_line(at, "a comment has no end: the file is truncated");
      p_ = at + end + 3;
      continue;
    }
    const std::size_t close = rest.find('>');
    if (close == rest.npos) file_.fail_at_line(at, "a tag has no '>': the file is truncated");
    p_ = at + close + 1;
    if (rest[1] == '?' || rest[1] == '!') continue;
    XmlTag tag;
    tag.at = at;
    tag.end = p_;
    std::string_view inside = rest.substr(1, close - 1);
    tag.closes = inside.starts_with("/");
    if (tag.closes) inside.remove_prefix(1);
    tag.closes_itself = inside.ends_with("/");
    if (tag.closes_itself) inside.remove_suffix(1);
    const auto* name_end = std::find_if(inside.begin(), inside.end(), is_space);
    tag.name = between(inside.begin(), name_end);
    tag.attributes = between(name_end, inside.end());
    return tag;
  }
}

}  // namespace suture
