// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/live/module/pages.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <sstream>

namespace suture::live {
namespace {

struct BuiltIn {
  std::string_view name, text;
};
constexpr BuiltIn built_in[] = {
#include "pages.inc"
};

std::string type_of(std::string_view name) {
  if (name.ends_with(".html")) return "text/html; charset=utf-8";
  if (name.ends_with(".css")) return "text/css; charset=utf-8";
  return "text/javascript; charset=utf-8";
}

/// Letters, digits and "_-./" only, without "..": it cannot leave its folder.
bool is_module_name(std::string_view name) {
  const auto good = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.' || c == '/';
  };
  return name.ends_with(".js") && name.find("..") == name.npos && std::ranges::all_of(name, good);
}

}  // namespace

std::optional<PageFile> page_file(std::string_view name, const std::filesystem::path& three_js) {
  if (name.empty()) name = "index.html";
  for (const BuiltIn& file : built_in)
    if (file.name == name) return PageFile{type_of(name), std::string(file.text)};
  constexpr std::string_view folder = "three/";
  if (!name.starts_with(folder) || !is_module_name(name)) return {};
  std::ifstream file(three_js / name.substr(folder.size()), std::ios::binary);
  if (!file) return {};
  std::ostringstream text;
  text << file.rdbuf();
  return PageFile{type_of(name), text.str()};
}

}  // namespace suture::live
