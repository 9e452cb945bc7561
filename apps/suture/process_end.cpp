// SPDX-License-Identifier: GPL-3.0-or-later
//
// Functions of the C library that end or replace the process without a trace. A plugin that calls
// one of them finds these here, because the symbols of the program come before those of libraries;
// the C library itself and the kernel's modules do not use them. In the program they do what they
// are known for.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdarg>
#include <vector>

#include "kernel/plugin_host/plugin_faults.hpp"

namespace {

using Words = char* const*;

int become(const char* file, Words words, Words environment) {
  return static_cast<int>(syscall(SYS_execve, file, words, environment));
}

/// Searches for the file in PATH.
int become_found(const char* file, Words words, Words environment) {
  using Function = int (*)(const char*, Words, Words);
  static const auto function = reinterpret_cast<Function>(dlsym(RTLD_NEXT, "execvpe"));
  return function(file, words, environment);
}

/// The words of a call of execl: up to the null pointer that ends them.
std::vector<char*> words_of(const char* first, va_list& more) {
  std::vector<char*> words{const_cast<char*>(first)};  // NOLINT: as exec takes it
  while (words.back() != nullptr) words.push_back(va_arg(more, char*));
  return words;
}

}  // namespace

#pragma GCC visibility push(default)
extern "C" {

void _exit(int code) {  // NOLINT: the library's names
  suture::refuse_in_plugin("_exit()");
  suture::leave_process(code);
}
void _Exit(int code) noexcept { _exit(code); }  // NOLINT

int execve(const char* file, Words words, Words environment) noexcept {
  suture::refuse_in_plugin("execve()");
  return become(file, words, environment);
}
int execv(const char* file, Words words) noexcept {
  suture::refuse_in_plugin("execv()");
  return become(file, words, environ);
}
int execvp(const char* file, Words words) noexcept {
  suture::refuse_in_plugin("execvp()");
  return become_found(file, words, environ);
}
int execvpe(const char* file, Words words, Words environment) noexcept {
  suture::refuse_in_plugin("execvpe()");
  return become_found(file, words, environment);
}
int fexecve(int file, Words words, Words environment) noexcept {
  suture::refuse_in_plugin("fexecve()");
  return static_cast<int>(syscall(SYS_execveat, file, "", words, environment, AT_EMPTY_PATH));
}
int execl(const char* file, const char* first, ...) noexcept {
  suture::refuse_in_plugin("execl()");
  va_list more;
  va_start(more, first);
  const auto words = words_of(first, more);
  va_end(more);
  return become(file, words.data(), environ);
}
int execlp(const char* file, const char* first, ...) noexcept {
  suture::refuse_in_plugin("execlp()");
  va_list more;
  va_start(more, first);
  const auto words = words_of(first, more);
  va_end(more);
  return become_found(file, words.data(), environ);
}
int execle(const char* file, const char* first, ...) noexcept {
  suture::refuse_in_plugin("execle()");
  va_list more;
  va_start(more, first);
  const auto words = words_of(first, more);
  auto* const environment = va_arg(more, char**);
  va_end(more);
  return become(file, words.data(), environment);
}

}  // extern "C"
#pragma GCC visibility pop
