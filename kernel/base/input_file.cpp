// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/input_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "kernel/base/error.hpp"
#include "kernel/base/file.hpp"

namespace suture {
namespace {

std::string kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "is a folder";
  const char* kind = S_ISFIFO(mode) ? "pipe" : S_ISSOCK(mode) ? "socket" : "device";
  return std::string("is a ") + kind + ", not a regular file";
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& path) : path_(path) {
  struct stat info {};
  // Even opening a device may have an effect; it is looked at first, and again once it is open.
  if (::stat(path.c_str(), &info) != 0) {
    refuse(errno);
    return;
  }
  if (S_ISREG(info.st_mode)) {
    fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd_ < 0 || ::fstat(fd_, &info) != 0) {
      refuse(errno);
      return;
    }
  }
  is_folder_ = S_ISDIR(info.st_mode);
  if (!S_ISREG(info.st_mode)) problem_ = kind_of(info.st_mode);
  size_ = static_cast<std::uint64_t>(info.st_size);
}

InputFile::~InputFile() {
  if (fd_ >= 0) ::close(fd_);
}

void InputFile::refuse(int error) {
  error_ = error;
  problem_ = std::string("cannot be opened: ") + std::strerror(error);
}

bool InputFile::is_missing() const { return error_ == ENOENT; }

void InputFile::seek(std::uint64_t offset) {
  if (::lseek(fd_, static_cast<off_t>(offset), SEEK_SET) < 0) fail_io(path_, "read", errno);
}

std::size_t InputFile::read(std::span<char> bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::read(fd_, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail_io(path_, "read", errno);
    if (n == 0) break;
    done += static_cast<std::size_t>(n);
  }
  return done;
}

std::string InputFile::read_all() {
  std::string text(size_, '\0');
  text.resize(read(text));
  return text;
}

std::string InputFile::read_text() {
  std::string text = read_all();
  // UTF-16 begins with its mark, and every second byte of plain text is 0.
  const bool is_utf16 = text.size() >= 4 && ((text.starts_with("\xff\xfe") && text[3] == 0) ||
                                             (text.starts_with("\xfe\xff") && text[2] == 0));
  if (is_utf16) throw InputError(path_.string() + ": the file is text in UTF-16; save it as UTF-8");
  text.erase(0, byte_order_mark(text));
  return text;
}

std::size_t byte_order_mark(std::string_view text) {
  constexpr std::string_view mark = "\xef\xbb\xbf";
  return text.starts_with(mark) ? mark.size() : 0;
}

}  // namespace suture
