// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kernel/base/archive.hpp"
#include "kernel/output/output_folder.hpp"

namespace suture {

/// A table that grows during a run: energies.csv, probes.csv. Numbers are
/// written in the shortest form that reads back as the same double. Rows are written
/// to disk once a second or every 64 kB; without rows, nothing is written.
class CsvWriter {
 public:
  /// `columns` with units, such as "kinetic energy [J]"; "step" is inserted before them.
  CsvWriter(std::shared_ptr<OutputFolder> folder, std::string name,
            const std::vector<std::string>& columns);
  /// Writes what is buffered; its errors are lost, so call finish() first.
  ~CsvWriter();
  CsvWriter(const CsvWriter&) = delete;
  CsvWriter& operator=(const CsvWriter&) = delete;

  /// Takes as many values as columns. Throws IoError; about 0.05 us per value.
  void row(std::uint64_t step, std::span<const double> values);
  /// Writes what is buffered and closes the file. Throws IoError.
  void finish();

  /// Saving writes all rows so far to disk and stores the length of the file. After loading, the
  /// next rows are appended at that length, and whatever follows is cut off with the first of them
  /// or by finish(). Throws InputError and leaves the file untouched if it is missing or shorter,
  /// or if its columns differ.
  void state(Archive& archive);

 private:
  void flush();
  void require_in_place() const;
  void check_file() const;

  std::shared_ptr<OutputFolder> folder_;
  std::string name_;
  std::size_t columns_;
  std::string header_;  ///< the first line
  std::string buffer_;
  std::uint64_t bytes_ = 0;  ///< bytes written
  std::unique_ptr<OutputFile> file_;
  std::chrono::steady_clock::time_point flushed_;
  bool has_rows_ = false, finished_ = false;
};

}  // namespace suture
