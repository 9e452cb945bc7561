// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace suture {

/// A text file with a row of names and rows of cells between commas, semicolons or tabs, whichever
/// the first row has most of. Lines that begin with '#' and empty lines are left out; blanks and
/// quotes around a cell are no part of it.
class CsvTable {
 public:
  /// Reads the file. Throws InputError: "FILE: ..." if it cannot be read or has no rows,
  /// "FILE:LINE: ..." for a row with another number of cells than the first.
  explicit CsvTable(const std::filesystem::path& file);

  /// As in the file: "force [N]".
  const std::vector<std::string>& names() const { return names_; }
  std::size_t row_count() const { return rows_.size(); }
  /// Throws InputError for a cell that is not a finite number.
  double number(std::size_t row, std::size_t column) const;
  /// "FILE:LINE".
  std::string place(std::size_t row) const;

 private:
  struct Row {
    std::size_t line;
    std::vector<std::string> cells;
  };
  std::string file_;
  std::vector<std::string> names_;
  std::vector<Row> rows_;
};

/// The part of a name before its unit, and the unit: "force [N]" is "force" and "N".
struct NameAndUnit {
  std::string_view name, unit;  ///< the unit is "" if there is none
};
NameAndUnit split_unit(std::string_view name);

}  // namespace suture
