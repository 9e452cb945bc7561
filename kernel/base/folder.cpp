// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "kernel/base/error.hpp"
#include "kernel/base/file.hpp"

namespace suture {
namespace {

namespace fs = std::filesystem;

constexpr int as_folder = O_RDONLY | O_DIRECTORY | O_CLOEXEC;

bool is_link(int folder, const fs::path& name) {
  struct stat info {};
  return ::fstatat(folder, name.c_str(), &info, AT_SYMLINK_NOFOLLOW) == 0 && S_ISLNK(info.st_mode);
}

/// The part of `path` behind `root`; empty if it does not begin with it.
fs::path behind(const fs::path& path, const fs::path& root) {
  if (root.empty()) return {};
  const fs::path rest = path.lexically_normal().lexically_relative(root.lexically_normal());
  return rest.empty() || *rest.begin() == ".." ? fs::path() : rest;
}

}  // namespace

Folder Folder::open(const fs::path& path) {
  const int fd = ::open(path.empty() ? "." : path.c_str(), as_folder);
  if (fd < 0) fail_io(path, "opened as a folder", errno);
  return {path, fd};
}

Folder Folder::make(const fs::path& path, const fs::path& root) {
  const fs::path checked = behind(path, root);
  Folder folder = open(!checked.empty() ? root : path.is_absolute() ? path.root_path() : "");
  for (const fs::path& name : checked.empty() ? path.relative_path() : checked)
    if (!name.empty() && name != ".") folder.enter(name, checked.empty());
  folder.path_ = path;
  return folder;
}

void Folder::enter(const fs::path& name, bool follows) {
  path_ /= name;
  if (!follows && is_link(fd_, name))
    throw IoError(path_.string() +
                  ": is a link, and a scene writes only below the folder where suture runs; "
                  "name the output folder on the command line (--output) to write there");
  if (::mkdirat(fd_, name.c_str(), 0777) == 0) made_.push_back(path_);
  // What could not be made is there, or cannot be opened for the same reason.
  const int error = errno;
  const int next = ::openat(fd_, name.c_str(), as_folder | (follows ? 0 : O_NOFOLLOW));
  if (next < 0) fail_io(path_, "made as output folder", errno == ENOENT ? error : errno);
  ::close(std::exchange(fd_, next));
}

Folder::~Folder() {
  if (fd_ >= 0) ::close(fd_);
}

Folder::Folder(Folder&& other) noexcept
    : path_(std::move(other.path_)),
      fd_(std::exchange(other.fd_, -1)),
      made_(std::move(other.made_)) {}

Folder& Folder::operator=(Folder&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(fd_, other.fd_);
  std::swap(made_, other.made_);
  return *this;
}

bool Folder::is_in_place() const {
  struct stat held {
  }, found{};
  return ::fstat(fd_, &held) == 0 && ::stat(path_.empty() ? "." : path_.c_str(), &found) == 0 &&
         held.st_dev == found.st_dev && held.st_ino == found.st_ino;
}

void Folder::remove(const char* name) const noexcept { ::unlinkat(fd_, name, 0); }

void Folder::sync() const { ::fsync(fd_); }

void Folder::unmake() const noexcept {
  for (auto made = made_.rbegin(); made != made_.rend(); ++made) ::rmdir(made->c_str());
}

bool same_folder(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  return fs::equivalent(a.empty() ? "." : a, b.empty() ? "." : b, ignored);
}

}  // namespace suture
