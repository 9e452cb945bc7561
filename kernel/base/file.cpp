// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/file.hpp"

#include <fcntl.h>
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
      return "; free some space or choose another output folder";
    case EACCES:
    case EPERM:
    case EROFS:
      return "; choose an output folder that you may write to";
    case ENOTDIR:
    case EEXIST:
      return "; a file stands where a folder is needed";
    default:
      return "";
  }
}

}  // namespace

void fail_io(const std::filesystem::path& path, const std::string& done, int error) {
  throw IoError(path.string() + ": cannot be " + done + ": " + std::strerror(error) + hint(error));
}

AtomicFile::AtomicFile(std::filesystem::path path) : path_(std::move(path)), temporary_(path_) {
  temporary_ += ".part";
}

AtomicFile::~AtomicFile() {
  if (temporary_.empty()) return;
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

void AtomicFile::commit() {
  std::error_code failed;
  std::filesystem::rename(temporary_, path_, failed);
  if (failed) fail_io(path_, "written", failed.value());
  temporary_.clear();
}

namespace {

int create(const std::filesystem::path& path, const std::filesystem::path& shown) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (fd < 0) fail_io(shown, "opened for writing", errno);
  return fd;
}

}  // namespace

OutputFile::OutputFile(std::filesystem::path path)
    : path_(std::move(path)), fd_(create(path_, path_)) {}

OutputFile::OutputFile(const AtomicFile& file)
    : path_(file.path()), fd_(create(file.temporary(), path_)) {}

OutputFile::OutputFile(std::filesystem::path path, std::uint64_t kept) : path_(std::move(path)) {
  fd_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
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

void OutputFile::sync() {
  // EINVAL: a device or pipe, which has nothing to wait for.
  if (::fsync(fd_) != 0 && errno != EINVAL) fail_io(path_, "written", errno);
}

void OutputFile::close() {
  if (::close(std::exchange(fd_, -1)) != 0) fail_io(path_, "written", errno);
}

void sync_folder(const std::filesystem::path& folder) {
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  ::fsync(fd);
  ::close(fd);
}

void write_file(const std::filesystem::path& path, std::string_view text) {
  AtomicFile atomic(path);
  OutputFile file(atomic);
  file.write(text);
  file.close();
  atomic.commit();
}

}  // namespace suture
