// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace suture::test {

/// A table that a run wrote: probes.csv, energies.csv.
struct CsvTable {
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;

  explicit CsvTable(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::string line;
    if (!std::getline(file, line)) throw std::runtime_error("no table " + path.string());
    columns = split(line);
    while (std::getline(file, line)) {
      std::vector<double> row;
      for (const std::string& word : split(line)) row.push_back(std::stod(word));
      rows.push_back(std::move(row));
    }
  }

  std::vector<double> column(const std::string& name) const {
    const auto found = std::ranges::find(columns, name);
    if (found == columns.end()) throw std::runtime_error("no column '" + name + "'");
    std::vector<double> values;
    for (const auto& row : rows)
      values.push_back(row[static_cast<std::size_t>(found - columns.begin())]);
    return values;
  }
  double last(const std::string& name) const { return column(name).back(); }

 private:
  static std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> words;
    std::istringstream stream(line);
    for (std::string word; std::getline(stream, word, ',');) {
      if (word.size() >= 2 && word.front() == '"') word = word.substr(1, word.size() - 2);
      words.push_back(word);
    }
    return words;
  }
};

}  // namespace suture::test
