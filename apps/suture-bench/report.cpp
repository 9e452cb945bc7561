// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/report.hpp"

#include <sys/utsname.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "kernel/base/error.hpp"
#include "kernel/base/isa.hpp"

namespace suture::bench {
namespace {

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

std::string operating_system() {
  utsname name{};
  uname(&name);
  return std::string(name.sysname) + ' ' + name.release + ' ' + name.machine;
}

std::size_t width(const std::string& name) { return std::max<std::size_t>(name.size(), 10); }

std::string shown(const Line::Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", std::get<double>(value));
  return text;
}

}  // namespace

void Report::begin(std::string name, std::string note) {
  std::printf("%s%s: %s\n", tables_.empty() ? "" : "\n", name.c_str(), note.c_str());
  tables_.push_back({std::move(name), std::move(note), {}});
}

void Report::add(Line line) {
  Table& table = tables_.back();
  // Lines may have more figures than those before (cuts need enough elements).
  if (table.lines.empty() || table.lines.back().cells.size() != line.cells.size()) {
    for (const auto& [name, value] : line.cells)
      std::printf("%*s  ", static_cast<int>(width(name)), name.c_str());
    std::printf("\n");
  }
  for (const auto& [name, value] : line.cells)
    std::printf("%*s  ", static_cast<int>(width(name)), shown(value).c_str());
  std::printf("\n");
  std::fflush(stdout);
  table.lines.push_back(std::move(line));
}

void Report::write_json(const std::filesystem::path& file) const {
  nlohmann::ordered_json out;
  out["machine"]["processor"] = processor();
  const std::string_view isa = best_isa();
  out["machine"]["isa"] = isa.empty() ? "base" : std::string(isa);
  out["machine"]["cores"] = std::thread::hardware_concurrency();
  out["machine"]["memory_GB"] = 1e-9 * static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
                                static_cast<double>(sysconf(_SC_PAGESIZE));
  out["machine"]["system"] = operating_system();
  out["machine"]["compiler"] = SUTURE_COMPILER;
  out["machine"]["libraries"] = SUTURE_LIBRARIES;
  out["machine"]["suture"] = SUTURE_VERSION;
  for (const Table& table : tables_) {
    auto& entry = out["tables"][table.name];
    entry["note"] = table.note;
    entry["rows"] = nlohmann::ordered_json::array();
    for (const Line& line : table.lines) {
      nlohmann::ordered_json row;
      for (const auto& [name, value] : line.cells)
        std::visit([&, key = name](const auto& v) { row[key] = v; }, value);
      entry["rows"].push_back(row);
    }
  }
  std::ofstream stream(file);
  stream << out.dump(2) << '\n';
  if (!stream.flush()) throw IoError("cannot write " + file.string());
}

}  // namespace suture::bench
