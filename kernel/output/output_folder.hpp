// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "kernel/base/file.hpp"

namespace suture {

/// Where a run writes: all its files come from here. Nothing is touched before open().
///
/// - One process at a time: the folder is locked from open() on. The system takes the lock back
///   when the process ends, however it does.
/// - No file of another name or place is touched: links are replaced, not followed, and below
///   `root` no folder may be a link.
/// - `.suture-run` in the folder lists what was written, each name before its file. What an
///   earlier run has left is removed as one set, lists (.pvd) first, when this one is about to
///   put its first file in place; until then it stays, and files that are not listed always do.
///
/// Any thread may call any member. They throw IoError.
class OutputFolder {
 public:
  explicit OutputFolder(std::filesystem::path path, std::filesystem::path root = {});
  /// Leaves no trace if nothing was written.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Makes and locks the folder, once.
  void open();
  /// Writes a file in full or not at all: `fill(OutputFile&)`.
  template <class Fill>
  void write(const std::string& name, Fill&& fill) {
    announce(name);
    AtomicFile file(*folder_, name);
    fill(file);
    begin();
    file.commit();
  }
  /// A file that grows, empty at first; or one that exists, cut to its first `kept` bytes.
  std::unique_ptr<OutputFile> grow(const std::string& name);
  std::unique_ptr<OutputFile> grow(const std::string& name, std::uint64_t kept);
  void remove(const std::string& name);
  void sync();

  /// Of a run that is resumed, before anything is written: a file of the earlier part is one of
  /// this run too.
  void keep(const std::string& name);
  /// The same for a list of files, which has this text from the first write on.
  void keep(const std::string& name, std::string text);
  /// The first result is there: removes what others have left, once.
  void begin();
  /// Throws if what was written is not to be found under path() any more.
  void require_in_place() const;

  /// For a signal handler, while nothing else uses the folder: what the destructor does.
  void abandon() const noexcept;

 private:
  void lock();
  void read_list();
  void announce(const std::string& name);
  void remove_stale();
  void write_list();

  const std::filesystem::path path_, root_;
  std::mutex mutex_;
  std::optional<Folder> folder_;
  int list_ = -1;           ///< `.suture-run`, locked
  bool made_list_ = false;  ///< it was not there before
  bool has_begun_ = false;
  std::set<std::string> listed_;     ///< in `.suture-run`
  std::set<std::string> own_;        ///< kept or announced
  std::set<std::string> announced_;  ///< by this process
  std::map<std::string, std::string> kept_lists_;
};

}  // namespace suture
