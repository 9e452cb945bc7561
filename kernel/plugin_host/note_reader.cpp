// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/note_reader.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>
#include <span>

#include "kernel/base/isa.hpp"
#include "kernel/plugin_host/elf_file.hpp"
#include "suture/note.h"

namespace suture {
namespace {

static_assert(std::endian::native == std::endian::little, "notes are written little-endian");

constexpr std::uint64_t round_up(std::uint64_t value, std::uint64_t step) {
  return (value + step - 1) / step * step;
}

/// Walks the notes of one segment: header, owner and descriptor, the latter two
/// padded to the segment's alignment (4, or 8 for GNU properties). Returns the
/// descriptor of Suture's note.
std::optional<std::span<const char>> find_descriptor(std::span<const char> notes,
                                                     std::uint64_t alignment) {
  const std::uint64_t step = alignment == 8 ? 8 : 4;
  while (notes.size() >= sizeof(Elf64_Nhdr)) {
    Elf64_Nhdr head;
    std::memcpy(&head, notes.data(), sizeof head);
    const std::uint64_t owner = sizeof head;
    const std::uint64_t desc = round_up(owner + head.n_namesz, step);
    if (desc > notes.size() || head.n_descsz > notes.size() - desc) return std::nullopt;
    if (head.n_type == SUTURE_NOTE_TYPE && head.n_namesz == sizeof SUTURE_NOTE_OWNER &&
        std::memcmp(notes.data() + owner, SUTURE_NOTE_OWNER, sizeof SUTURE_NOTE_OWNER) == 0)
      return notes.subspan(desc, head.n_descsz);
    notes =
        notes.subspan(std::min<std::uint64_t>(round_up(desc + head.n_descsz, step), notes.size()));
  }
  return std::nullopt;
}

suture_note_desc read_descriptor(ElfFile& file) {
  constexpr std::uint64_t max_bytes = std::uint64_t{1} << 20;  // notes of real files: below 2 kB
  for (const auto& segment : file.segments()) {
    if (segment.p_type != PT_NOTE || segment.p_filesz > max_bytes) continue;
    const auto notes = file.read<char>(segment.p_offset, segment.p_filesz);
    const auto found = find_descriptor(notes, segment.p_align);
    if (!found) continue;
    suture_note_desc desc{};
    if (found->size() < sizeof desc) throw ElfRefusal{"its Suture note is shorter than ABI 1.0's"};
    std::memcpy(&desc, found->data(), sizeof desc);
    if (desc.magic != SUTURE_MAGIC) throw ElfRefusal{"its Suture note is damaged (magic number)"};
    return desc;
  }
  throw ElfRefusal{
      "it is a shared library but not a Suture plugin: it has no Suture note. Build it with "
      "suture_add_plugin (C++), or add SUTURE_NOTE from suture/note.h (C)"};
}

template <std::size_t n>
std::string text(const char (&field)[n]) {
  return {field, std::find(field, field + n, '\0')};
}

std::vector<std::string> split(const std::string& words) {
  std::vector<std::string> out;
  for (std::size_t begin = 0; begin < words.size();) {
    const std::size_t end = std::min(words.find(' ', begin), words.size());
    if (end > begin) out.push_back(words.substr(begin, end - begin));
    begin = end + 1;
  }
  return out;
}

std::string version(std::uint32_t major, std::uint32_t minor) {
  return std::to_string(major) + "." + std::to_string(minor);
}

/// What in a well-formed note keeps this host from loading the file.
std::string incompatibility(const PluginNote& note) {
  const std::string ours = version(SUTURE_ABI_MAJOR, SUTURE_ABI_MINOR);
  const std::string theirs = version(note.abi_major, note.abi_minor);
  if (note.abi_major != SUTURE_ABI_MAJOR)
    return "it is built for plugin ABI " + theirs + ", this Suture has ABI " + ours +
           " (the major number must be equal); rebuild the plugin with this Suture's SDK";
  if (note.abi_minor > SUTURE_ABI_MINOR)
    return "it is built for plugin ABI " + theirs + ", newer than this Suture's ABI " + ours +
           "; use a newer Suture, or rebuild the plugin with this one's SDK";
  if (note.lanes != SUTURE_LANES)
    return "it is built for batches of " + std::to_string(note.lanes) + " cells, this Suture has " +
           std::to_string(SUTURE_LANES) + "; rebuild the plugin with this Suture's SDK";
  if (isa_rank(note.isa) < 0)
    return "it is built for the instruction set '" + note.isa +
           "', which is unknown to this Suture";
  if (isa_rank(note.isa) > isa_rank(best_isa()))
    return "it is built for " + note.isa +
           ", which this processor does not support or SUTURE_ISA excludes; put the plugin's other "
           "builds (NAME.avx2.so, NAME.so) in the same folder";
  return {};
}

}  // namespace

PluginNote read_note(const std::filesystem::path& file) {
  PluginNote note;
  try {
    ElfFile elf(file);
    const auto desc = read_descriptor(elf);
    note.plugin = text(desc.plugin);
    note.models = split(text(desc.models));
    note.isa = text(desc.isa);
    note.abi_major = desc.abi_major;
    note.abi_minor = desc.abi_minor;
    note.lanes = desc.lanes;
    note.problem = incompatibility(note);
  } catch (const ElfRefusal& refusal) {
    note.problem = refusal.why;
  }
  return note;
}

}  // namespace suture
