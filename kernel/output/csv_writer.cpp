// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/csv_writer.hpp"

#include <charconv>
#include <stdexcept>
#include <utility>

#include "kernel/base/error.hpp"
#include "kernel/base/input_file.hpp"

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

CsvWriter::CsvWriter(std::shared_ptr<OutputFolder> folder, std::string name,
                     const std::vector<std::string>& columns)
    : folder_(std::move(folder)),
      name_(std::move(name)),
      columns_(columns.size()),
      header_("step"),
      flushed_(std::chrono::steady_clock::now()) {
  for (const std::string& column : columns) header_.append(1, ',').append(cell(column));
  header_ += '\n';
  buffer_ = header_;
}

CsvWriter::~CsvWriter() {
  try {
    if (!buffer_.empty()) finish();
  } catch (...) {  // finish() reports errors
  }
}

void CsvWriter::row(std::uint64_t step, std::span<const double> values) {
  if (values.size() != columns_) {
    throw std::invalid_argument(name_ + ": " + std::to_string(values.size()) + " values for " +
                                std::to_string(columns_) + " columns");
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
  if (folder_->is_silent()) {
    bytes_ += std::exchange(buffer_, {}).size();
    flushed_ = std::chrono::steady_clock::now();
    return;
  }
  if (!file_) file_ = bytes_ == 0 ? folder_->grow(name_) : folder_->grow(name_, bytes_);
  bytes_ += buffer_.size();
  file_->write(std::exchange(buffer_, {}));
  require_in_place();
  flushed_ = std::chrono::steady_clock::now();
}

void CsvWriter::require_in_place() const {
  folder_->require_in_place();
  if (file_->was_removed())
    throw IoError(file_->path().string() +
                  ": was removed while the run wrote to it; start the run again and leave its "
                  "files where they are");
}

void CsvWriter::finish() {
  if (std::exchange(finished_, true) || !has_rows_) return;
  flush();
  if (file_) file_->close();
}

void CsvWriter::state(Archive& archive) {
  if (!archive.loads() && has_rows_ && !finished_) {
    flush();
    if (file_) file_->sync();
  }
  archive("has_rows", has_rows_);
  archive("bytes", bytes_);
  if (!archive.loads()) return;
  file_.reset();
  buffer_ = bytes_ == 0 ? header_ : "";
  finished_ = false;
  if (bytes_ == 0) return;
  check_file();
  folder_->keep(name_);
}

// That it is the table whose rows were written, as far as can be seen.
void CsvWriter::check_file() const {
  const std::filesystem::path path = folder_->path() / name_;
  const auto refuse = [&](const std::string& what) {
    throw InputError(path.string() + ": " + what + ", but the checkpoint continues after byte " +
                     std::to_string(bytes_) +
                     " of it; restore the file, or start the run again from the beginning");
  };
  InputFile file(path);
  if (file.is_missing()) refuse("is missing");
  if (!file.problem().empty()) refuse(file.problem());
  if (file.size() < bytes_) refuse("has " + std::to_string(file.size()) + " bytes");
  std::string first(header_.size(), ' ');
  file.read(first);
  file.seek(bytes_ - 1);
  char last = 0;
  file.read({&last, 1});
  if (first != header_ || last != '\n') refuse("is not the table of this run");
}

}  // namespace suture
