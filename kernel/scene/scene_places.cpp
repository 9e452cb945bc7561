// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/scene/scene_places.hpp"

#include <algorithm>
#include <sstream>
#include <utility>

#include "kernel/scene/mistakes.hpp"

namespace suture {
namespace {

// Lists of a million elements are not worth a million places: items behind have their list's.
constexpr std::size_t max_items = 1000;

/// A line of an error, with its continuation lines.
struct Finding {
  std::string path, text;
};

std::vector<Finding> findings_in(const InputError& error) {
  std::vector<Finding> findings;
  std::istringstream lines(error.what());
  for (std::string line; std::getline(lines, line);) {
    const std::size_t end = line.find(": ");
    if (line.starts_with('/') && end != line.npos)
      findings.push_back({line.substr(0, end), line.substr(end + 2)});
    else if (!findings.empty())
      findings.back().text += "\n" + line;
  }
  return findings;
}

}  // namespace

ScenePlaces::ScenePlaces(const JsonValue& root, std::string file, std::vector<std::string> sets)
    : file_(std::move(file)), sets_(std::move(sets)) {
  add(root, "");
}

void ScenePlaces::add(const JsonValue& value, const std::string& path) {
  places_.emplace(path, value.at);
  for (const JsonMember& member : value.members) add(member.value, child_path(path, member.key));
  for (std::size_t i = 0; i < value.items.size() && i < max_items; ++i)
    if (value.items[i].kind != JsonValue::Kind::number) add(value.items[i], child_path(path, i));
}

// The place of the value, or of the one around it.
JsonPosition ScenePlaces::of(std::string_view path) const {
  for (; !path.empty(); path = path.substr(0, path.rfind('/')))
    if (const auto found = places_.find(path); found != places_.end()) return found->second;
  return places_.at("");
}

// An absolute path of a file begins like a path of the scene.
bool ScenePlaces::is_in_scene(std::string_view path) const {
  return places_.contains(path.substr(0, path.find('/', 1)));
}

void ScenePlaces::rethrow(const InputError& error) const {
  const std::vector<Finding> findings = findings_in(error);
  if (findings.empty() || error.what()[0] != '/' ||
      !std::ranges::all_of(findings, [&](const auto& f) { return is_in_scene(f.path); }))
    throw;
  Mistakes mistakes(file_, sets_);
  for (const Finding& finding : findings)
    mistakes.add(of(finding.path), finding.path, finding.text);
  mistakes.throw_if_any();
  throw;
}

}  // namespace suture
