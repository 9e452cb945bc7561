// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/elf_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cstring>

namespace suture {
namespace {

#if defined(__x86_64__)
constexpr Elf64_Half this_machine = EM_X86_64;
#elif defined(__aarch64__)
constexpr Elf64_Half this_machine = EM_AARCH64;
#else
#error "name the ELF machine of this architecture here"
#endif

constexpr std::uint64_t largest_image = std::uint64_t{1} << 40;

[[noreturn]] void refuse_damaged(const std::string& what) {
  throw ElfRefusal{"it is damaged (" + what + "); build or copy it again"};
}

/// What mmap and the loader need of a segment that is loaded.
void check_loaded(const Elf64_Phdr& segment, std::uint64_t end_of_last) {
  constexpr std::uint64_t page = 4096;
  if (segment.p_filesz > segment.p_memsz)
    refuse_damaged("a segment is larger in the file than in memory");
  if (segment.p_vaddr > largest_image || segment.p_memsz > largest_image)
    refuse_damaged("a segment lies outside of the address space");
  if (!std::has_single_bit(segment.p_align) || segment.p_align < page ||
      (segment.p_vaddr - segment.p_offset) % segment.p_align != 0)
    refuse_damaged("the alignment of a segment");
  if (segment.p_vaddr < end_of_last) refuse_damaged("segments overlap, or are not in order");
  if ((segment.p_flags & ~std::uint32_t{PF_R | PF_W | PF_X}) != 0)
    refuse_damaged("the access rights of a segment");
}

}  // namespace

ElfFile::ElfFile(const std::filesystem::path& file) {
  std::error_code code;
  const auto status = std::filesystem::status(file, code);
  if (!std::filesystem::exists(status)) throw ElfRefusal{"no such file"};
  if (!std::filesystem::is_regular_file(status)) throw ElfRefusal{"it is not a regular file"};
  length_ = std::filesystem::file_size(file, code);
  descriptor_ = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (code || descriptor_ < 0) throw ElfRefusal{"it cannot be read (check its permissions)"};
  try {
    const Elf64_Ehdr header = read_header();
    read_segments(header);
    check_sections(header);
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

ElfFile::~ElfFile() { ::close(descriptor_); }

void ElfFile::require(std::uint64_t offset, std::uint64_t count, std::uint64_t size) const {
  if (count > length_ || !contains(offset, count * size))
    throw ElfRefusal{"it is truncated or damaged (a table lies beyond its end)"};
}

void ElfFile::read_bytes(std::uint64_t offset, void* out, std::uint64_t bytes) const {
  auto* to = static_cast<char*>(out);
  while (bytes > 0) {
    const ssize_t n = ::pread(descriptor_, to, bytes, static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw ElfRefusal{"it cannot be read to its end"};
    to += n;
    offset += static_cast<std::uint64_t>(n);
    bytes -= static_cast<std::uint64_t>(n);
  }
}

Elf64_Ehdr ElfFile::read_header() {
  if (!contains(0, SELFMAG) || std::memcmp(read<char>(0, SELFMAG).data(), ELFMAG, SELFMAG) != 0)
    throw ElfRefusal{"it is not a shared library (not an ELF file)"};
  if (!contains(0, sizeof(Elf64_Ehdr))) throw ElfRefusal{"it is truncated within its ELF header"};
  const Elf64_Ehdr header = read<Elf64_Ehdr>(0, 1)[0];
  if (header.e_ident[EI_CLASS] != ELFCLASS64 || header.e_ident[EI_DATA] != ELFDATA2LSB ||
      header.e_machine != this_machine)
    throw ElfRefusal{"it is built for a different processor architecture (ELF machine " +
                     std::to_string(header.e_machine) + ", this host has " +
                     std::to_string(this_machine) + "); build it on this machine"};
  if (header.e_type != ET_DYN)
    throw ElfRefusal{
        "it is an ELF file but not a shared library (an object file or a program); link it with "
        "-shared, or build it with suture_add_plugin"};
  if (header.e_ident[EI_VERSION] != EV_CURRENT || header.e_version != EV_CURRENT)
    refuse_damaged("the version in its ELF header");
  if (header.e_phentsize != sizeof(Elf64_Phdr) || header.e_ehsize != sizeof(Elf64_Ehdr))
    refuse_damaged("sizes in its ELF header");
  return header;
}

/// Every segment that loading would map must be in the file, else the loader dies by SIGBUS where
/// it should refuse.
void ElfFile::read_segments(const Elf64_Ehdr& header) {
  if (!contains(header.e_phoff, std::uint64_t{header.e_phnum} * sizeof(Elf64_Phdr)))
    throw ElfRefusal{"it is truncated or damaged (program headers lie beyond its end)"};
  segments_ = read<Elf64_Phdr>(header.e_phoff, header.e_phnum);
  std::uint64_t end = 0;
  bool has_code = false;
  for (const Elf64_Phdr& segment : segments_) {
    const bool is_empty = segment.p_filesz == 0 || segment.p_type == PT_GNU_STACK;
    if (!is_empty && segment.p_type != PT_NULL && !contains(segment.p_offset, segment.p_filesz))
      throw ElfRefusal{"it is truncated or damaged (a segment lies beyond its end)"};
    if (segment.p_type != PT_LOAD) continue;
    check_loaded(segment, end);
    end = segment.p_vaddr + segment.p_memsz;
    has_code |= (segment.p_flags & PF_X) != 0;
  }
  if (!has_code) refuse_damaged("it has no segment with code");
}

/// Sections are not needed for loading, and may have been removed; they are at the end of the file.
void ElfFile::check_sections(const Elf64_Ehdr& header) {
  if (header.e_shoff == 0) return;
  if (header.e_shentsize != sizeof(Elf64_Shdr)) refuse_damaged("sizes in its ELF header");
  const char* const truncated = "it is truncated or damaged (a section lies beyond its end)";
  if (!contains(header.e_shoff, std::uint64_t{header.e_shnum} * sizeof(Elf64_Shdr)))
    throw ElfRefusal{truncated};
  for (const Elf64_Shdr& section : read<Elf64_Shdr>(header.e_shoff, header.e_shnum))
    if (section.sh_type != SHT_NULL && section.sh_type != SHT_NOBITS &&
        !contains(section.sh_offset, section.sh_size))
      throw ElfRefusal{truncated};
}

}  // namespace suture
