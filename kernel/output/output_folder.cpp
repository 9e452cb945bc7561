// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/output_folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <sstream>
#include <utility>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

constexpr const char* list_name = ".suture-run";

// The list may come from a stranger: a name leads nowhere, and to results only.
bool is_result(const std::filesystem::path& name) {
  static const std::set<std::string> extensions{".vtu", ".pvd", ".csv", ".h5"};
  return name == name.filename() && extensions.contains(name.extension().string());
}

bool is_list(const std::string& name) { return name.ends_with(".pvd"); }

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

}  // namespace

OutputFolder::OutputFolder(std::filesystem::path path, std::filesystem::path root)
    : path_(std::move(path)), root_(std::move(root)) {}

OutputFolder::~OutputFolder() {
  if (own_.empty()) abandon();
  if (list_ >= 0) ::close(list_);
}

void OutputFolder::abandon() const noexcept {
  if (!made_list_) return;
  folder_->remove(list_name);
  folder_->unmake();
}

void OutputFolder::open() {
  const std::lock_guard guard(mutex_);
  if (list_ >= 0) return;
  folder_.emplace(Folder::make(path_, root_));
  lock();
  read_list();
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
  for (std::string line; std::getline(lines, line);)
    if (is_result(line)) listed_.insert(line);
}

void OutputFolder::announce(const std::string& name) {
  open();
  require_in_place();
  const std::lock_guard guard(mutex_);
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
  for (const bool lists : {true, false})
    for (const std::string& name : listed_)
      if (is_list(name) == lists) {
        if (!own_.contains(name)) folder_->remove(name);
        if (!announced_.contains(name)) folder_->remove(temporary_name(name));
      }
  write_list();
}

/// Killed in between, it has lines of the old one behind the new ones: too many, not too few.
void OutputFolder::write_list() {
  listed_ = own_;
  std::string text;
  for (const std::string& name : own_) text += name + '\n';
  write_at(list_, text, 0, path_ / list_name);
  if (::ftruncate(list_, static_cast<off_t>(text.size())) != 0)
    fail_io(path_ / list_name, "written", errno);
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
  open();
  folder_->remove(name);
}

void OutputFolder::sync() { folder_->sync(); }

void OutputFolder::require_in_place() const {
  if (list_ < 0) return;
  if (folder_->is_in_place() && leads_to(folder_->descriptor(), list_name, list_)) return;
  throw IoError(path_.string() +
                ": the output folder was removed or replaced while the run wrote to it; start "
                "the run again and leave the folder where it is");
}

}  // namespace suture
