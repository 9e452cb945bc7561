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

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  return text;
}

/// Whether a text is key="value" key='value' ...
bool are_attributes(std::string_view rest) {
  for (rest = trimmed(rest); !rest.empty(); rest = trimmed(rest)) {
    const std::size_t equals = rest.find('=');
    if (equals == rest.npos ||
        trimmed(rest.substr(0, equals)).find_first_of(" \t\r\n\"'<") != rest.npos)
      return false;
    rest = trimmed(rest.substr(equals + 1));
    if (rest.empty() || (rest[0] != '"' && rest[0] != '\'')) return false;
    const std::size_t close = rest.find(rest[0], 1);
    if (close == rest.npos) return false;
    rest.remove_prefix(close + 1);
  }
  return true;
}

}  // namespace

std::string_view XmlTag::operator[](std::string_view key) const {
  std::string_view rest = attributes;
  while (true) {
    const std::size_t equals = rest.find('=');
    if (equals == rest.npos) return {};
    const std::string_view found = trimmed(rest.substr(0, equals));
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
    if (at == file_.end()) {
      if (!open_.empty()) fail_open();
      return std::nullopt;
    }
    const std::string_view rest = between(at, file_.end());
    if (rest.starts_with("<!--")) {
      const std::size_t end = rest.find("-->");
      if (end == rest.npos)
        file_.fail_at_line(at, "a comment is not terminated: the file is truncated");
      p_ = at + end + 3;
      continue;
    }
    const std::size_t close = rest.find('>');
    if (close == rest.npos) file_.fail_at_line(at, "a tag has no '>': the file is truncated");
    p_ = at + close + 1;
    if (rest[1] == '?' || rest[1] == '!') continue;
    const XmlTag tag = tag_at(at, rest.substr(1, close - 1));
    nest(tag);
    return tag;
  }
}

XmlTag XmlCursor::tag_at(const char* at, std::string_view inside) const {
  XmlTag tag;
  tag.at = at;
  tag.end = p_;
  tag.closes = inside.starts_with("/");
  if (tag.closes) inside.remove_prefix(1);
  tag.closes_itself = inside.ends_with("/");
  if (tag.closes_itself) inside.remove_suffix(1);
  const auto* name_end = std::find_if(inside.begin(), inside.end(), is_space);
  tag.name = between(inside.begin(), name_end);
  tag.attributes = between(name_end, inside.end());
  if (tag.name.empty() || !are_attributes(tag.attributes))
    file_.fail_at_line(at, "the tag " + in_quotes(between(at, p_)) +
                               " is malformed: expected <name key=\"value\" ...>");
  return tag;
}

void XmlCursor::nest(const XmlTag& tag) {
  if (tag.closes) {
    if (open_.empty() || open_.back().name != tag.name)
      file_.fail_at_line(
          tag.at, "</" + printable(tag.name) + "> closes " +
                      (open_.empty() ? "nothing" : "<" + printable(open_.back().name) + ">") +
                      ": the file is damaged");
    open_.pop_back();
  }
  enclosing_ = open_.empty() ? XmlTag{} : open_.back();
  if (!tag.closes && !tag.closes_itself) open_.push_back(tag);
}

void XmlCursor::fail_open() const {
  const std::string name = printable(open_.back().name);
  file_.fail_at_byte(file_.end(), "the file ends before </" + name + ">: it is truncated");
}

}  // namespace suture
