// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

const char* hint(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "; free some space or choose a different output folder";
    case EACCES:
    case EPERM:
    case EROFS:
      return "; choose an output folder for which you have write permission";
    case EFBIG:
      return "; raise the limit on the size of files (ulimit -f)";
    case ENOTDIR:
    case EEXIST:
      return "; a file exists where a folder is needed";
    default:
      return "";
  }
}

}  // namespace

void fail_io(const std::filesystem::path& path, const std::string& done, int error) {
  throw IoError(path.string() + ": cannot be " + done + ": " + std::strerror(error) + hint(error));
}

namespace {

int create(const Folder& folder, const std::string& name, const std::filesystem::path& shown) {
  if (::unlinkat(folder.descriptor(), name.c_str(), 0) != 0 && errno != ENOENT)
    fail_io(shown, "replaced", errno);
  constexpr int fresh = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
  const int fd = ::openat(folder.descriptor(), name.c_str(), fresh, 0666);
  if (fd < 0) fail_io(shown, "opened for writing", errno);
  return fd;
}

}  // namespace

OutputFile::OutputFile(const Folder& folder, const std::string& name, const std::string& shown)
    : path_(folder.path() / shown), fd_(create(folder, name, path_)) {}

OutputFile::OutputFile(const Folder& folder, const std::string& name, std::uint64_t kept)
    : path_(folder.path() / name) {
  // A FIFO would be waited for, without O_NONBLOCK.
  fd_ = ::openat(folder.descriptor(), name.c_str(), O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0) fail_io(path_, "opened for writing", errno);
  const auto end = static_cast<off_t>(kept);
  if (::ftruncate(fd_, end) != 0 || ::lseek(fd_, end, SEEK_SET) < 0) {
    const int error = errno;
    ::close(fd_);
    fail_io(path_, "continued", error);
  }
}

OutputFile::~OutputFile() {
  if (fd_ >= 0) ::close(fd_);
}

void OutputFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd_, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail_io(path_, "written", errno);
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
}

bool OutputFile::was_removed() const {
  struct stat info {};
  return ::fstat(fd_, &info) == 0 && info.st_nlink == 0;
}

void OutputFile::sync() {
  if (::fsync(fd_) != 0) fail_io(path_, "written", errno);
}

void OutputFile::close() {
  if (::close(std::exchange(fd_, -1)) != 0) fail_io(path_, "written", errno);
}

std::string temporary_name(const std::string& name) { return name + ".part"; }

AtomicFile::AtomicFile(const Folder& folder, const std::string& name)
    : OutputFile(folder, temporary_name(name), name),
      folder_(folder),
      name_(name),
      temporary_(temporary_name(name)) {}

AtomicFile::~AtomicFile() {
  if (!temporary_.empty()) folder_.remove(temporary_.c_str());
}

void AtomicFile::commit() {
  close();
  const int fd = folder_.descriptor();
  if (::renameat(fd, temporary_.c_str(), fd, name_.c_str()) != 0) fail_io(path(), "written", errno);
  temporary_.clear();
}

void write_file(const std::filesystem::path& path, std::string_view text) {
  const Folder folder = Folder::open(path.parent_path());
  AtomicFile file(folder, path.filename().string());
  file.write(text);
  file.commit();
}

}  // namespace suture
