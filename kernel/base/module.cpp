// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/module.hpp"

#include <dlfcn.h>

#include <cstdlib>
#include <vector>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

std::vector<std::filesystem::path> module_folders() {
  std::vector<std::filesystem::path> folders;
  if (const char* path = std::getenv("SUTURE_MODULE_PATH")) folders.emplace_back(path);
  const std::filesystem::path base = executable_folder().parent_path();
  folders.push_back(base / "lib" / "suture");
  folders.push_back(base / SUTURE_INSTALL_LIBDIR / "suture");
  folders.push_back(std::filesystem::path(SUTURE_INSTALL_PREFIX) / SUTURE_INSTALL_LIBDIR /
                    "suture");
  return folders;
}

}  // namespace

std::filesystem::path executable_folder() {
  std::error_code failed;
  const auto file = std::filesystem::read_symlink("/proc/self/exe", failed);
  return failed ? std::filesystem::current_path() : file.parent_path();
}

void* module_symbol(const std::string& file, const char* symbol) {
  std::string tried;
  for (const auto& folder : module_folders()) {
    const std::filesystem::path path = folder / file;
    tried += "\n  " + path.string();
    std::error_code failed;
    if (!std::filesystem::exists(path, failed)) continue;
    void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    if (library == nullptr) {
      throw IoError("cannot load " + path.string() + ": " + dlerror() +
                    "; build or install Suture again");
    }
    void* address = dlsym(library, symbol);
    if (address == nullptr) {
      throw IoError(path.string() + " is not the expected module: " + dlerror());
    }
    return address;
  }
  throw IoError("the module " + file + " is missing; searched for:" + tried +
                "\nset SUTURE_MODULE_PATH to its folder, or install Suture again");
}

}  // namespace suture
