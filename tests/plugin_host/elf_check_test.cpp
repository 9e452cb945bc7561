// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/elf_check.hpp"

#include <dlfcn.h>
#include <elf.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>

#include "tests/plugin_host/test_plugins.hpp"

namespace suture {
namespace {

namespace fs = std::filesystem;

/// A copy of a good plugin whose tables can be damaged. The tables of segments that are not
/// writable lie in the file where they lie in memory.
class Library {
 public:
  Library() {
    std::ifstream in(plugins / "good.so", std::ios::binary);
    bytes_ = {std::istreambuf_iterator<char>(in), {}};
  }
  ~Library() { fs::remove(path_); }
  Library(const Library&) = delete;

  template <class T = std::uint64_t>
  T& at(std::uint64_t offset) {
    return *reinterpret_cast<T*>(bytes_.data() + offset);
  }
  Elf64_Ehdr& header() { return at<Elf64_Ehdr>(0); }
  Elf64_Phdr& segment(Elf64_Word type, int number = 0) {
    auto* segment = &at<Elf64_Phdr>(header().e_phoff);
    while (segment->p_type != type || number-- > 0) ++segment;
    return *segment;
  }
  /// An entry of the dynamic section; `tag` must be there.
  std::uint64_t& entry(std::int64_t tag) {
    auto* entry = &at<Elf64_Dyn>(segment(PT_DYNAMIC).p_offset);
    while (entry->d_tag != tag) ++entry;
    return entry->d_un.d_val;
  }
  Elf64_Sym& symbol(int number) { return (&at<Elf64_Sym>(entry(DT_SYMTAB)))[number]; }
  Elf64_Rela& relocation() { return at<Elf64_Rela>(entry(DT_RELA)); }
  std::uint32_t& hash(int word) { return (&at<std::uint32_t>(entry(DT_GNU_HASH)))[word]; }
  std::string& bytes() { return bytes_; }

  const fs::path& write() const {
    std::ofstream(path_, std::ios::binary).write(bytes_.data(), std::streamsize(bytes_.size()));
    return path_;
  }
  std::string problem() const { return elf_problem(write()); }

 private:
  std::string bytes_;
  fs::path path_ = fs::temp_directory_path() / ("suture-elf-" + std::to_string(getpid()) + ".so");
};

TEST(ElfCheck, EveryPluginOfTheTestsAndTheLibrariesOfTheSystemAreSound) {
  int checked = 0;
  std::error_code ignored;  // another architecture
  for (const fs::path& folder : {plugins, fs::path("/lib/x86_64-linux-gnu")})
    for (const auto& entry : fs::directory_iterator(folder, ignored))
      if (entry.path().filename().string().find(".so") != std::string::npos &&
          entry.is_regular_file() && entry.file_size() > 1000 && ++checked < 100) {
        EXPECT_EQ(elf_problem(entry.path()), "") << entry.path();
      }
  EXPECT_GT(checked, 10);
}

struct Damage {
  const char* words;
  std::function<void(Library&)> to;
};

TEST(ElfCheck, DamagedHeadersAndTablesAreRefused) {
  constexpr std::uint64_t far = 0x7fffff000;
  const Damage all[] = {
      {"version", [](Library& l) { l.header().e_version = 7; }},
      {"sizes in its ELF header", [](Library& l) { l.header().e_ehsize = 60; }},
      {"no segment with code", [](Library& l) { l.header().e_phnum = 1; }},
      {"a section lies beyond", [](Library& l) { l.header().e_shoff += 64; }},
      {"larger in the file", [](Library& l) { l.segment(PT_LOAD).p_memsz = 8; }},
      {"alignment", [](Library& l) { l.segment(PT_LOAD).p_align = 3000; }},
      {"alignment", [](Library& l) { l.segment(PT_LOAD, 1).p_vaddr += 8; }},
      {"not in order", [](Library& l) { l.segment(PT_LOAD, 1).p_vaddr = 0; }},
      {"address space", [](Library& l) { l.segment(PT_LOAD, 2).p_vaddr += 1UL << 50; }},
      {"access rights", [](Library& l) { l.segment(PT_LOAD).p_flags = 0x5a; }},
      {"no dynamic section", [](Library& l) { l.segment(PT_DYNAMIC).p_type = PT_NULL; }},
      {"dynamic section lies", [](Library& l) { l.segment(PT_DYNAMIC).p_vaddr = far; }},
      {"dynamic section has no end", [](Library& l) { l.segment(PT_DYNAMIC).p_memsz = 32; }},
      {"table of names lies", [](Library& l) { l.entry(DT_STRTAB) = far; }},
      {"table of names", [](Library& l) { l.entry(DT_STRSZ) -= 1; }},
      {"table of symbols", [](Library& l) { l.entry(DT_SYMTAB) = far; }},
      {"sizes in its dynamic section", [](Library& l) { l.entry(DT_SYMENT) = 16; }},
      {"hash table", [](Library& l) { l.entry(DT_GNU_HASH) = far; }},
      {"hash table", [](Library& l) { l.hash(0) = 1U << 30; }},
      {"hash table", [](Library& l) { l.hash(2) = 3; }},
      {"a name lies", [](Library& l) { l.symbol(1).st_name = 1U << 20; }},
      {"table of relocations", [](Library& l) { l.entry(DT_RELA) = far; }},
      {"table of relocations", [](Library& l) { l.entry(DT_RELASZ) = far; }},
      {"not writable", [](Library& l) { l.relocation().r_offset = 64; }},
      {"names no symbol", [](Library& l) { l.relocation().r_info |= 0xfffUL << 32; }},
      {"points outside", [](Library& l) { l.relocation().r_addend = far; }},
      {"runs when it is loaded", [](Library& l) { l.entry(DT_INIT) = 64; }},
      {"run when it is loaded", [](Library& l) { l.entry(DT_INIT_ARRAYSZ) = far; }},
      {"read-only", [](Library& l) { l.segment(PT_GNU_RELRO).p_memsz = far; }},
      {"unknown entries", [](Library& l) { l.at(l.segment(PT_DYNAMIC).p_offset) |= 1UL << 40; }},
      {"entry is missing", [](Library& l) { (&l.entry(DT_RELASZ))[-1] = DT_DEBUG; }},
  };
  for (const Damage& damage : all) {
    Library library;
    ASSERT_EQ(library.problem(), "");
    damage.to(library);
    EXPECT_NE(library.problem().find(damage.words), std::string::npos)
        << damage.words << ": " << library.problem();
  }
}

/// Whether loading the file ends the process: by a signal, or by a failed assertion of the loader.
bool crashes_when_loaded(const fs::path& file) {
  const pid_t child = fork();
  if (child == 0) {
    alarm(10);
    if (std::freopen("/dev/null", "w", stderr) == nullptr) _exit(0);
    dlopen(file.c_str(), RTLD_NOW);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status != 0;
}

// Random bytes of program headers and of the dynamic section. What is accepted may run other
// functions when it is loaded, so a tenth of the crashes of an unchecked loader may be left.
TEST(ElfCheck, WhatItAcceptsHardlyEverCrashesTheLoader) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  int unchecked = 0, accepted = 0;
  for (int i = 0; i < 200; ++i) {
    Library library;
    const Elf64_Phdr dynamic = library.segment(PT_DYNAMIC);
    const std::uint64_t begin = i % 2 == 0 ? library.header().e_phoff : dynamic.p_offset;
    const std::uint64_t size = i % 2 == 0 ? library.header().e_phnum * sizeof(Elf64_Phdr) : 400;
    for (int k = 0; k < 3; ++k)
      library.bytes()[begin + random() % size] = static_cast<char>(random());
    const bool is_accepted = library.problem().empty();
    if (!crashes_when_loaded(library.write())) continue;
    ++unchecked;
    accepted += is_accepted ? 1 : 0;
  }
  EXPECT_GT(unchecked, 30);
  EXPECT_LE(accepted, unchecked / 10);
}

}  // namespace
}  // namespace suture
