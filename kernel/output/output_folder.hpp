// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>

#include "kernel/base/file.hpp"

namespace suture {

/// The folder to which a run writes all its files. Nothing is touched before open().
///
/// - One run at a time: the folder is locked from open() to close(), against other processes and
///   other runs of this one. The system releases the lock when the process ends, in whatever way.
/// - No other file is touched: links are replaced, not followed, and below `root` no folder may
///   be a link.
/// - `.suture-run` in the folder lists what was written; each name is added before its file is
///   written. The files of an earlier run are removed as one set, lists (.pvd) first, when this
///   run is about to put its first file in place. Until then they stay; files that are not listed
///   are never removed.
/// - The list also names the runs that wrote the files, if they can be resumed: a run that is
///   resumed replaces the results of that run only.
/// - `suture-unfinished.txt` is there from open() to close() or the destructor. If a process ends
/// without
///   its last word, such as by a signal or by a plugin, the file stays and says that the results
///   are incomplete.
///
/// Several processes may make the run together. Process 0 then has the folder, and writes all
/// files but pieces of frames: the others are silent.
///
/// Any thread may call any member but write_pieces(). They throw IoError.
class OutputFolder {
 public:
  explicit OutputFolder(std::filesystem::path path, std::filesystem::path root = {});
  /// The processes that make a run together.
  struct Writers {
    unsigned number = 1, mine = 0;
    std::function<void()> wait = [] {};  ///< until all of them have called it
  };
  OutputFolder(std::filesystem::path path, std::filesystem::path root, Writers writers);
  /// Restores the original state of the folder if nothing was written.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  bool is_silent() const { return writers_.mine != 0; }
  unsigned writers() const { return writers_.number; }
  unsigned writer() const { return writers_.mine; }  ///< this process
  /// Creates and locks the folder, once.
  void open();
  /// To be called when the run has ended: releases the folder, to which nothing can be written any
  /// more.
  void close();
  /// Writes a complete file or none at all: `fill(OutputFile&)`.
  template <class Fill>
  void write(const std::string& name, Fill&& fill) {
    if (is_silent()) return;
    announce(name);
    AtomicFile file(*folder_, name);
    fill(file);
    begin();
    file.commit();
  }
  /// Writes files together: each process the one with its number, `fill(OutputFile&)`, if there is
  /// one. All processes call it, and have written them when it returns.
  template <class Fill>
  void write_pieces(std::span<const std::string> names, Fill&& fill) {
    begin_pieces(names);
    if (writers_.mine < names.size()) {
      AtomicFile file(*folder_, names[writers_.mine]);
      fill(file);
      file.commit();
    }
    writers_.wait();
  }
  /// A file that grows: an empty one, or an existing one, truncated to its first `kept` bytes.
  std::unique_ptr<OutputFile> grow(const std::string& name);
  std::unique_ptr<OutputFile> grow(const std::string& name, std::uint64_t kept);
  void remove(const std::string& name);
  void sync();

  /// Before anything is written: the identity of this run, which the list will name.
  void set_run(const std::string& run);
  /// For a resumed run, before anything is written: opens the folder, and throws if it has results
  /// of which none are those of the run `earlier`. The list will name that run, too.
  void continue_run(const std::string& earlier);
  /// For a resumed run, before anything is written: declares that a file of the earlier part
  /// belongs to this run, too.
  void keep(const std::string& name);
  /// The same for a list of files, which has this content from the first write on.
  void keep(const std::string& name, std::string text);
  /// To be called when the first result is ready: removes the files of earlier runs, once.
  void begin();
  /// Whether the last run that wrote here ended without its last word. Call it after open().
  bool was_unfinished() const { return was_unfinished_; }
  /// Throws if the files written can no longer be found under path().
  void require_in_place() const;

  /// Does what the destructor does; for a signal handler, while nothing else uses the folder.
  void abandon() const noexcept;

 private:
  void lock();
  void release() noexcept;
  void read_list();
  void mark();
  void announce(const std::string& name);
  void begin_pieces(std::span<const std::string> names);
  void remove_stale();
  void write_list();

  const std::filesystem::path path_, root_;
  std::mutex mutex_;
  std::optional<Folder> folder_;
  int list_ = -1;           ///< `.suture-run`, locked
  bool made_list_ = false;  ///< it did not exist before
  bool was_unfinished_ = false, is_marked_ = false;
  bool has_begun_ = false;
  bool is_closed_ = false;
  const Writers writers_;
  std::set<std::string> listed_;     ///< names in `.suture-run`
  std::set<std::string> own_;        ///< kept or announced
  std::set<std::string> announced_;  ///< by this process
  std::map<std::string, std::string> kept_lists_;
  std::string run_;                       ///< the identity of this one, or ""
  std::set<std::string> listed_runs_;     ///< in `.suture-run`
  std::set<std::string> continued_runs_;  ///< those whose results this one continues
};

}  // namespace suture
