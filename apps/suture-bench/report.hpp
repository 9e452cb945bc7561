// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace suture::bench {

/// One line of a table: names with numbers or words, in order of the columns.
struct Line {
  using Value = std::variant<double, std::string>;
  std::vector<std::pair<std::string, Value>> cells;

  Line& add(std::string name, Value value) {
    cells.emplace_back(std::move(name), std::move(value));
    return *this;
  }
};

/// Tables of figures, printed as they arise and kept for a JSON file.
class Report {
 public:
  /// A new table. `note`: how it was measured.
  void begin(std::string name, std::string note);
  /// Prints the line, and the head before the first of a table.
  void add(Line line);

  /// {"machine": ..., "tables": {name: {"note": ..., "rows": [...]}}}.
  /// Throws IoError.
  void write_json(const std::filesystem::path& file) const;

 private:
  struct Table {
    std::string name, note;
    std::vector<Line> lines;
  };
  std::vector<Table> tables_;
};

}  // namespace suture::bench
