// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/csv_writer.hpp"

#include <charconv>
#include <stdexcept>
#include <utility>

namespace suture {
namespace {

// RFC 4180: quotes where the text has a comma, a quote or a line feed.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == text.npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace

CsvWriter::CsvWriter(std::filesystem::path path, const std::vector<std::string>& columns)
    : path_(std::move(path)),
      columns_(columns.size()),
      buffer_("step"),
      flushed_(std::chrono::steady_clock::now()) {
  for (const std::string& name : columns) buffer_.append(1, ',').append(cell(name));
  buffer_ += '\n';
}

CsvWriter::~CsvWriter() {
  try {
    finish();
  } catch (...) {  // finish() is where errors are told.
  }
}

void CsvWriter::row(std::uint64_t step, std::span<const double> values) {
  if (values.size() != columns_) {
    throw std::invalid_argument(path_.string() + ": " + std::to_string(values.size()) +
                                " values for " + std::to_string(columns_) + " columns");
  }
  has_rows_ = true;
  char text[32];
  buffer_.append(text, std::to_chars(text, text + sizeof text, step).ptr);
  for (const double value : values) {
    buffer_ += ',';
    buffer_.append(text, std::to_chars(text, text + sizeof text, value).ptr);
  }
  buffer_ += '\n';
  constexpr std::size_t full = 1 << 16;
  if (buffer_.size() >= full ||
      std::chrono::steady_clock::now() - flushed_ > std::chrono::seconds(1)) {
    flush();
  }
}

void CsvWriter::flush() {
  if (!file_) {
    std::error_code ignored;  // opening the file tells what is wrong
    std::filesystem::create_directories(path_.parent_path(), ignored);
    file_.emplace(path_);
  }
  file_->write(std::exchange(buffer_, {}));
  flushed_ = std::chrono::steady_clock::now();
}

void CsvWriter::finish() {
  if (std::exchange(finished_, true) || !has_rows_) return;
  flush();
  file_->close();
}

}  // namespace suture
