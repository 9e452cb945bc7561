// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/scene/csv_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/base/escape.hpp"
#include "kernel/base/input_file.hpp"

namespace suture {
namespace {

constexpr const char* blanks = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  text = text.substr(first, text.find_last_not_of(blanks) - first + 1);
  if (text.size() > 1 && text.front() == '"' && text.back() == '"')
    text = text.substr(1, text.size() - 2);
  return text;
}

std::vector<std::string> cells_of(std::string_view line, char separator) {
  std::vector<std::string> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    cells.emplace_back(trimmed(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  return cells;
}

char separator_of(const std::string& header) {
  const auto count = [&](char c) { return std::ranges::count(header, c); };
  return std::max({',', ';', '\t'}, [&](char a, char b) { return count(a) < count(b); });
}

}  // namespace

CsvTable::CsvTable(const std::filesystem::path& file) : file_(file.string()) {
  InputFile input(file);
  if (!input.problem().empty()) throw InputError(file_ + ": " + input.problem());
  std::istringstream text(input.read_text());
  char separator = 0;
  std::size_t number = 0;
  for (std::string line; std::getline(text, line);) {
    ++number;
    if (trimmed(line).empty() || trimmed(line).front() == '#') continue;
    if (names_.empty()) {
      separator = separator_of(line);
      names_ = cells_of(line, separator);
      continue;
    }
    rows_.push_back({number, cells_of(line, separator)});
    const std::size_t cells = rows_.back().cells.size();
    if (cells != names_.size())
      throw InputError(place(rows_.size() - 1) + ": has " + std::to_string(cells) +
                       " cells, and the first row names " + std::to_string(names_.size()));
  }
  if (rows_.empty())
    throw InputError(file_ + ": has no rows of numbers below a row with the names of its columns");
}

double CsvTable::number(std::size_t row, std::size_t column) const {
  const std::string& cell = rows_[row].cells[column];
  double value = 0;
  const char *begin = cell.data() + (cell.starts_with('+') ? 1 : 0),
             *end = cell.data() + cell.size();
  const auto [rest, error] = std::from_chars(begin, end, value);
  if (error != std::errc{} || rest != end || !std::isfinite(value))
    throw InputError(place(row) + ": column " + quote(names_[column]) + ": " +
                     (cell.empty() ? "is empty" : quote(cell) + " is not a finite number") +
                     "; each row needs one");
  return value;
}

std::string CsvTable::place(std::size_t row) const {
  return file_ + ':' + std::to_string(rows_[row].line);
}

NameAndUnit split_unit(std::string_view name) {
  const std::size_t open = name.rfind('[');
  if (open == std::string_view::npos || !name.ends_with(']')) return {name, {}};
  return {trimmed(name.substr(0, open)), trimmed(name.substr(open + 1, name.size() - open - 2))};
}

}  // namespace suture
