// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/module.hpp"

#include <dlfcn.h>
#include <link.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <vector>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

std::array<std::filesystem::path, 2> folders_of(const std::filesystem::path& prefix) {
  return {prefix / "lib" / "suture", prefix / SUTURE_INSTALL_LIBDIR / "suture"};
}

/// The file of the library that contains this code; "" if it is the program.
std::filesystem::path own_library() {
  static const char here = 0;
  Dl_info info{};
  link_map* map = nullptr;
  void* into = &map;
  if (dladdr1(&here, &info, static_cast<void**>(into), RTLD_DL_LINKMAP) == 0 || map == nullptr)
    return {};
  return map->l_name;
}

std::vector<std::filesystem::path> module_folders() {
  std::vector<std::filesystem::path> folders;
  if (const char* path = std::getenv("SUTURE_MODULE_PATH")) folders.emplace_back(path);
  for (auto& folder : folders_of(own_prefix())) folders.push_back(std::move(folder));
  folders.push_back(std::filesystem::path(SUTURE_INSTALL_PREFIX) / SUTURE_INSTALL_LIBDIR /
                    "suture");
  return folders;
}

}  // namespace

std::filesystem::path own_prefix() {
  std::error_code failed;
  const std::filesystem::path library = own_library();
  if (library.empty()) {
    const auto program = std::filesystem::read_symlink("/proc/self/exe", failed);
    return failed ? std::filesystem::current_path().parent_path()
                  : program.parent_path().parent_path();
  }
  auto prefix = std::filesystem::weakly_canonical(library, failed).parent_path();
  const auto has_modules = [&] {
    return std::ranges::any_of(folders_of(prefix), [](const auto& folder) {
      std::error_code ignored;
      return std::filesystem::is_directory(folder, ignored);
    });
  };
  while (prefix.has_relative_path() && !has_modules()) prefix = prefix.parent_path();
  return prefix;
}

void* module_symbol(const std::string& file, const char* symbol) {
  std::string tried;
  for (const auto& folder : module_folders()) {
    const std::filesystem::path path = folder / file;
    tried += "\n  " + path.string();
    std::error_code failed;
    if (!std::filesystem::exists(path, failed)) continue;
    // Binding all functions of VTK at once would take 1.4 ms of the 12 in which a run starts and
    // ends.
    void* library = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL | RTLD_NODELETE);
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
  throw IoError(
      "the module " + file + " is missing; searched for:" + tried +
      "\nbuild all of Suture (./dev build) or install it again, or set SUTURE_MODULE_PATH to the "
      "folder of the module");
}

}  // namespace suture
