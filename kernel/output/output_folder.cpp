// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/output_folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <sstream>
#include <tuple>
#include <utility>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

constexpr const char *list_name = ".suture-run", *mark_name = "suture-unfinished.txt";
constexpr std::string_view run_mark = "run ";  // before the identity of a run; no name of a file

// The list may come from a stranger: a name leads nowhere, and to results only.
bool is_result(const std::filesystem::path& name) {
  static const std::set<std::string> extensions{".vtu", ".vtp", ".pvtu", ".pvtp",
                                                ".pvd", ".csv", ".h5"};
  return name == name.filename() && extensions.contains(name.extension().string());
}

/// Files that name others are removed before these.
enum class Names { frames, pieces, nothing };
Names names_in(const std::string& name) {
  if (name.ends_with(".pvd")) return Names::frames;
  return name.ends_with(".pvtu") || name.ends_with(".pvtp") ? Names::pieces : Names::nothing;
}

struct flock whole_file() {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  return lock;
}

bool same_file(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

/// The file of this name is the open one.
bool leads_to(int folder, const char* name, int file) {
  struct stat held {
  }, found{};
  return ::fstat(file, &held) == 0 && ::fstatat(folder, name, &found, AT_SYMLINK_NOFOLLOW) == 0 &&
         same_file(held, found);
}

void write_at(int file, const std::string& text, off_t at, const std::filesystem::path& shown) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n =
        ::pwrite(file, text.data() + done, text.size() - done, at + static_cast<off_t>(done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail_io(shown, "written", errno);
    done += static_cast<std::size_t>(n);
  }
}

off_t size_of(int file) {
  struct stat info {};
  return ::fstat(file, &info) == 0 ? info.st_size : 0;
}

/// The folders that runs of this process have locked. The lock of a file keeps other processes out
/// only, and would be released as soon as this process closes the file a second time.
class LockedFolders {
 public:
  /// False if the folder is locked already.
  bool add(int folder) {
    const std::lock_guard guard(mutex_);
    return folders_.insert(key_of(folder)).second;
  }
  void remove(int folder) {
    const std::lock_guard guard(mutex_);
    folders_.erase(key_of(folder));
  }

 private:
  /// A forked process does not inherit locks.
  using Key = std::tuple<pid_t, dev_t, ino_t>;
  static Key key_of(int folder) {
    struct stat info {};
    ::fstat(folder, &info);
    return {::getpid(), info.st_dev, info.st_ino};
  }

  std::mutex mutex_;
  std::set<Key> folders_;
};

LockedFolders& locked_folders() {
  static LockedFolders folders;
  return folders;
}

}  // namespace

OutputFolder::OutputFolder(std::filesystem::path path, std::filesystem::path root)
    : OutputFolder(std::move(path), std::move(root), {}) {}

OutputFolder::OutputFolder(std::filesystem::path path, std::filesystem::path root, Writers writers)
    : path_(std::move(path)), root_(std::move(root)), writers_(std::move(writers)) {}

OutputFolder::~OutputFolder() {
  if (own_.empty())
    abandon();
  else if (is_marked_)
    folder_->remove(mark_name);
  release();
}

void OutputFolder::release() noexcept {
  if (list_ < 0) return;
  ::close(std::exchange(list_, -1));
  locked_folders().remove(folder_->descriptor());
}

void OutputFolder::close() {
  const std::lock_guard guard(mutex_);
  if (own_.empty()) return;  // nothing was written
  is_closed_ = true;
  if (std::exchange(is_marked_, false)) folder_->remove(mark_name);
  release();
}

/// If nothing was written, the mark of an earlier run stays.
void OutputFolder::abandon() const noexcept {
  if (is_marked_ && !was_unfinished_) folder_->remove(mark_name);
  if (!made_list_) return;
  folder_->remove(list_name);
  folder_->unmake();
}

void OutputFolder::open() {
  const std::lock_guard guard(mutex_);
  if (is_silent() || list_ >= 0 || is_closed_) return;
  folder_.emplace(Folder::make(path_, root_));
  if (!locked_folders().add(folder_->descriptor()))
    throw IoError(path_.string() +
                  ": another run of this process writes to this folder; give one of them another "
                  "/output/directory, or end the other one first");
  try {
    lock();
  } catch (...) {
    locked_folders().remove(folder_->descriptor());
    throw;
  }
  read_list();
  struct stat ignored {};
  was_unfinished_ = ::fstatat(folder_->descriptor(), mark_name, &ignored, AT_SYMLINK_NOFOLLOW) == 0;
  mark();
}

void OutputFolder::mark() {
  if (std::exchange(is_marked_, true)) return;
  OutputFile file(*folder_, mark_name);
  file.write("Process " + std::to_string(::getpid()) +
             " writes results to this folder and has not finished. If it does not run any more, it "
             "was killed, or a plugin ended it, and the results are incomplete. To go on from the "
             "newest checkpoint here, if there is one: suture run --resume CHECKPOINT\n");
  file.close();
}

void OutputFolder::lock() {
  constexpr int flags = O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  // Whoever made the list may remove it, between its opening here and its locking.
  while (true) {
    struct stat ignored {};
    const int folder = folder_->descriptor();
    made_list_ = ::fstatat(folder, list_name, &ignored, AT_SYMLINK_NOFOLLOW) != 0;
    const int file = ::openat(folder, list_name, flags, 0666);
    if (file < 0) fail_io(path_ / list_name, "opened for writing", errno);
    struct flock wanted = whole_file();
    if (::fcntl(file, F_SETLK, &wanted) != 0) {
      const int error = errno;
      struct flock holder = whole_file();
      const bool known = ::fcntl(file, F_GETLK, &holder) == 0 && holder.l_type != F_UNLCK;
      ::close(file);
      made_list_ = false;
      if (error != EAGAIN && error != EACCES) fail_io(path_ / list_name, "locked", error);
      throw IoError(path_.string() + ": another run writes to this folder" +
                    (known ? " (process " + std::to_string(holder.l_pid) + ")" : std::string()) +
                    "; choose another one with --output, or wait until that run ends");
    }
    if (leads_to(folder, list_name, file)) {
      list_ = file;
      return;
    }
    ::close(file);
  }
}

void OutputFolder::read_list() {
  std::string text;
  std::array<char, 1 << 14> piece;
  for (ssize_t n = 1; n > 0; text.append(piece.data(), static_cast<std::size_t>(n)))
    if (n = ::pread(list_, piece.data(), piece.size(), static_cast<off_t>(text.size())); n < 0)
      fail_io(path_ / list_name, "read", errno);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (is_result(line)) listed_.insert(line);
    if (line.starts_with(run_mark)) listed_runs_.insert(line.substr(run_mark.size()));
  }
}

void OutputFolder::set_run(const std::string& run) {
  const std::lock_guard guard(mutex_);
  run_ = run;
}

void OutputFolder::continue_run(const std::string& earlier) {
  if (is_silent()) return;
  open();
  const std::lock_guard guard(mutex_);
  if (!listed_.empty() && !listed_runs_.contains(earlier))
    throw IoError(path_.string() +
                  ": contains the results of another run, which a resumed run does not replace; "
                  "name an empty folder with --output");
  continued_runs_.merge(listed_runs_);
}

void OutputFolder::announce(const std::string& name) {
  open();
  require_in_place();
  const std::lock_guard guard(mutex_);
  if (is_closed_)
    throw IoError(path_.string() +
                  ": the run that wrote to this folder has ended; start a new one");
  own_.insert(name);
  announced_.insert(name);
  if (listed_.insert(name).second) write_at(list_, name + '\n', size_of(list_), path_ / list_name);
}

void OutputFolder::keep(const std::string& name) {
  const std::lock_guard guard(mutex_);
  own_.insert(name);
}

void OutputFolder::keep(const std::string& name, std::string text) {
  const std::lock_guard guard(mutex_);
  own_.insert(name);
  kept_lists_[name] = std::move(text);
}

void OutputFolder::begin() {
  if (is_silent()) return;
  open();
  const std::lock_guard guard(mutex_);
  if (std::exchange(has_begun_, true)) return;
  for (const auto& [name, text] : kept_lists_) {
    AtomicFile file(*folder_, name);
    file.write(text);
    file.commit();
  }
  remove_stale();
}

void OutputFolder::remove_stale() {
  for (const Names names : {Names::frames, Names::pieces, Names::nothing})
    for (const std::string& name : listed_)
      if (names_in(name) == names) {
        if (!own_.contains(name)) folder_->remove(name.c_str());
        if (!announced_.contains(name)) folder_->remove(temporary_name(name).c_str());
      }
  write_list();
}

/// Killed in between, it has lines of the old one behind the new ones: too many, not too few.
void OutputFolder::write_list() {
  listed_ = own_;
  std::string text;
  std::set<std::string> runs = continued_runs_;
  if (!run_.empty()) runs.insert(run_);
  for (const std::string& run : runs) text.append(run_mark).append(run + '\n');
  for (const std::string& name : own_) text += name + '\n';
  write_at(list_, text, 0, path_ / list_name);
  if (::ftruncate(list_, static_cast<off_t>(text.size())) != 0)
    fail_io(path_ / list_name, "written", errno);
}

/// Before others write, the folder is there, and files of earlier runs are not.
void OutputFolder::begin_pieces(std::span<const std::string> names) {
  if (!is_silent()) {
    for (const std::string& name : names) announce(name);
    begin();
  }
  writers_.wait();
  if (!folder_) folder_.emplace(Folder::make(path_, root_));
}

std::unique_ptr<OutputFile> OutputFolder::grow(const std::string& name) {
  announce(name);
  begin();
  return std::make_unique<OutputFile>(*folder_, name);
}

std::unique_ptr<OutputFile> OutputFolder::grow(const std::string& name, std::uint64_t kept) {
  announce(name);
  begin();
  return std::make_unique<OutputFile>(*folder_, name, kept);
}

void OutputFolder::remove(const std::string& name) {
  if (is_silent()) return;
  open();
  folder_->remove(name.c_str());
}

void OutputFolder::sync() {
  if (!is_silent()) folder_->sync();
}

void OutputFolder::require_in_place() const {
  if (list_ < 0) return;
  if (folder_->is_in_place() && leads_to(folder_->descriptor(), list_name, list_)) return;
  throw IoError(path_.string() +
                ": the output folder was removed or replaced while the run wrote to it; start "
                "the run again and leave the folder where it is");
}

}  // namespace suture
