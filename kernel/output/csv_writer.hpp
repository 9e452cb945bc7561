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

/// A table that grows during a run: energies.csv, probes.csv. Numbers are the
/// shortest that read back to the same double. Rows reach the disk once a second
/// or every 64 kB; nothing is written if there are none.
class CsvWriter {
 public:
  /// `columns` with units, such as "kinetic energy [J]"; "step" is put before them.
  CsvWriter(std::shared_ptr<OutputFolder> folder, std::string name,
            const std::vector<std::string>& columns);
  /// Writes what is buffered; errors are lost, therefore call finish() before.
  ~CsvWriter();
  CsvWriter(const CsvWriter&) = delete;
  CsvWriter& operator=(const CsvWriter&) = delete;

  /// As many values as columns. Throws IoError; about 0.05 us per value.
  void row(std::uint64_t step, std::span<const double> values);
  /// Writes what is buffered and closes the file. Throws IoError.
  void finish();

  /// Saved: how much of the file was written; all rows so far are on the disk then. Loaded: the
  /// next rows go on there, and what the file has beyond is cut off with the first of them, or
  /// by finish(). Throws InputError, the file untouched, if that is gone or shorter or of other
  /// columns.
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
  std::uint64_t bytes_ = 0;  ///< written
  std::unique_ptr<OutputFile> file_;
  std::chrono::steady_clock::time_point flushed_;
  bool has_rows_ = false, finished_ = false;
};

}  // namespace suture
