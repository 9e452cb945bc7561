// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/elf_check.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <span>

#include "kernel/plugin_host/elf_file.hpp"

namespace suture {
namespace {

#if defined(__x86_64__)
constexpr std::uint32_t relative_type = R_X86_64_RELATIVE, indirect_type = R_X86_64_IRELATIVE;
#elif defined(__aarch64__)
constexpr std::uint32_t relative_type = R_AARCH64_RELATIVE, indirect_type = R_AARCH64_IRELATIVE;
#endif

/// The tables to which the dynamic section of a library refers. Addresses are those of the library.
class Tables {
 public:
  explicit Tables(ElfFile& file) : file_(file) {}

  void check() {
    check_segments();
    read_entries();
    check_names();
    symbol_count_ = count_symbols();
    check_symbols();
    check_versions();
    check_relocations(DT_RELA, DT_RELASZ);
    if (has(DT_PLTRELSZ) && value(DT_PLTREL) != DT_RELA) refuse("the type of its relocations");
    check_relocations(DT_JMPREL, DT_PLTRELSZ);
    check_functions();
  }

 private:
  [[noreturn]] static void refuse(const std::string& what) {
    throw ElfRefusal{"it is damaged (" + what +
                     "): loading it would crash; build or copy it again"};
  }

  bool has(std::int64_t tag) const { return entries_.contains(tag); }
  std::uint64_t value(std::int64_t tag) const {
    const auto found = entries_.find(tag);
    return found == entries_.end() ? 0 : found->second;
  }

  /// The loaded segment that has all of these bytes in memory, with these access rights; or null.
  const Elf64_Phdr* segment_with(std::uint64_t address, std::uint64_t bytes,
                                 std::uint32_t rights) const {
    for (const Elf64_Phdr& segment : file_.segments())
      if (segment.p_type == PT_LOAD && (segment.p_flags & rights) == rights &&
          address >= segment.p_vaddr && address - segment.p_vaddr <= segment.p_memsz &&
          bytes <= segment.p_memsz - (address - segment.p_vaddr))
        return &segment;
    return nullptr;
  }

  /// Those that are parts of others: made read-only after relocation, and copied for every thread.
  void check_segments() const {
    for (const Elf64_Phdr& segment : file_.segments()) {
      if (segment.p_type == PT_GNU_RELRO &&
          segment_with(segment.p_vaddr, segment.p_memsz, PF_W) == nullptr)
        refuse("what is made read-only lies outside of its segments");
      if (segment.p_type == PT_TLS &&
          (segment.p_filesz > segment.p_memsz ||
           segment_with(segment.p_vaddr, segment.p_filesz, 0) == nullptr))
        refuse("its thread-local data lie outside of its segments");
    }
  }

  /// `count` items that are in the file.
  template <class T>
  std::vector<T> table(std::uint64_t address, std::uint64_t count, const char* what) {
    const std::uint64_t bytes = count * sizeof(T);
    const Elf64_Phdr* segment = segment_with(address, bytes, PF_R);
    if (count > (std::uint64_t{1} << 32) || segment == nullptr ||
        address - segment->p_vaddr + bytes > segment->p_filesz)
      refuse(std::string(what) + " lies outside of its segments");
    return file_.read<T>(segment->p_offset + (address - segment->p_vaddr), count);
  }

  /// Whether the tag is one of the ELF standard, or of a range for systems and processors.
  static bool is_tag(std::int64_t tag) {
    return tag >= 0 && (tag < 64 || (tag >= DT_LOOS && tag <= DT_HIPROC));
  }

  void read_entries() {
    const auto& segments = file_.segments();
    const auto dynamic = std::ranges::find(segments, Elf64_Word{PT_DYNAMIC}, &Elf64_Phdr::p_type);
    if (dynamic == segments.end()) refuse("it has no dynamic section");
    const auto entries = table<Elf64_Dyn>(dynamic->p_vaddr, dynamic->p_memsz / sizeof(Elf64_Dyn),
                                          "its dynamic section");
    const auto end = std::ranges::find(entries, Elf64_Sxword{DT_NULL}, &Elf64_Dyn::d_tag);
    if (end == entries.end()) refuse("its dynamic section has no end");
    for (auto at = entries.begin(); at != end; ++at) {
      if (!is_tag(at->d_tag)) refuse("unknown entries in its dynamic section");
      entries_[at->d_tag] = at->d_un.d_val;
      if (at->d_tag == DT_NEEDED) names_.push_back(at->d_un.d_val);
    }
    for (const std::int64_t tag : {DT_STRTAB, DT_SYMTAB, DT_STRSZ})
      if (!has(tag)) refuse("a table is missing in its dynamic section");
    constexpr std::int64_t pairs[][2] = {{DT_INIT_ARRAY, DT_INIT_ARRAYSZ},
                                         {DT_FINI_ARRAY, DT_FINI_ARRAYSZ},
                                         {DT_RELA, DT_RELASZ},
                                         {DT_JMPREL, DT_PLTRELSZ},
                                         {DT_JMPREL, DT_PLTREL},
                                         {DT_VERNEED, DT_VERNEEDNUM}};
    for (const auto& [one, other] : pairs)
      if (has(one) != has(other)) refuse("an entry is missing in its dynamic section");
    if (has(DT_VERNEED) && !has(DT_VERSYM)) refuse("an entry is missing in its dynamic section");
    if (value(DT_SYMENT) != sizeof(Elf64_Sym) ||
        (has(DT_RELA) && value(DT_RELAENT) != sizeof(Elf64_Rela)))
      refuse("sizes in its dynamic section");
  }

  void check_names() {
    const auto text = table<char>(value(DT_STRTAB), value(DT_STRSZ), "its table of names");
    if (text.empty() || text.back() != '\0') refuse("its table of names has no end");
    for (const std::int64_t tag : {DT_SONAME, DT_RPATH, DT_RUNPATH})
      if (has(tag)) names_.push_back(value(tag));
    for (const std::uint64_t name : names_) check_name(name);
  }
  void check_name(std::uint64_t name) const {
    if (name >= value(DT_STRSZ)) refuse("a name lies outside of its table");
  }

  /// The loader finds symbols by a hash table only, which therefore covers all that are defined;
  /// the undefined ones come before them.
  std::uint32_t count_symbols() {
    if (has(DT_GNU_HASH)) return count_by_gnu_hash();
    if (!has(DT_HASH)) refuse("it has no hash table of its symbols");
    const auto head = table<std::uint32_t>(value(DT_HASH), 2, "its hash table");
    const auto links = table<std::uint32_t>(value(DT_HASH) + 8, std::uint64_t{head[0]} + head[1],
                                            "its hash table");
    if (head[0] == 0 || std::ranges::any_of(links, [&](auto i) { return i >= head[1]; }))
      refuse("its hash table");
    return head[1];
  }
  std::uint32_t count_by_gnu_hash() {
    const char* const what = "its hash table";
    const std::uint64_t begin = value(DT_GNU_HASH);
    const auto head = table<std::uint32_t>(begin, 4, what);
    const auto [buckets, first, words, shift] = std::array{head[0], head[1], head[2], head[3]};
    if (buckets == 0 || words == 0 || (words & (words - 1)) != 0 || shift > 31) refuse(what);
    const std::uint64_t after_words = begin + 16 + std::uint64_t{words} * 8;
    const auto starts = table<std::uint32_t>(after_words, buckets, what);
    const auto chains = rest_of_segment(after_words + std::uint64_t{buckets} * 4);
    std::uint64_t count = 0;
    for (const std::uint32_t start : starts) {
      if (start == 0) continue;
      if (start < first) refuse(what);
      std::uint64_t at = start - first;
      while (at < chains.size() && (chains[at] & 1) == 0) ++at;
      if (at >= chains.size()) refuse(what);
      count = std::max(count, first + at + 1);
    }
    // Without a defined symbol; linkers place the names behind the symbols.
    if (count == 0) count = (value(DT_STRTAB) - value(DT_SYMTAB)) / sizeof(Elf64_Sym);
    return static_cast<std::uint32_t>(count);
  }
  std::vector<std::uint32_t> rest_of_segment(std::uint64_t address) {
    const Elf64_Phdr* segment = segment_with(address, 0, PF_R);
    if (segment == nullptr || address - segment->p_vaddr > segment->p_filesz)
      refuse("its hash table");
    const std::uint64_t rest = segment->p_filesz - (address - segment->p_vaddr);
    return table<std::uint32_t>(address, rest / 4, "its hash table");
  }

  void check_symbols() {
    const auto symbols = table<Elf64_Sym>(value(DT_SYMTAB), symbol_count_, "its table of symbols");
    for (const Elf64_Sym& symbol : symbols) {
      check_name(symbol.st_name);
      const bool is_defined = symbol.st_shndx != SHN_UNDEF && symbol.st_shndx < SHN_LORESERVE;
      const bool has_address = ELF64_ST_TYPE(symbol.st_info) != STT_TLS;
      if (is_defined && has_address && segment_with(symbol.st_value, 0, 0) == nullptr)
        refuse("a symbol lies outside of its segments");
    }
  }

  void check_versions() {
    if (has(DT_VERSYM)) table<std::uint16_t>(value(DT_VERSYM), symbol_count_, "its versions");
    if (!has(DT_VERNEED)) return;
    std::uint64_t at = value(DT_VERNEED);
    for (std::uint64_t i = 0; i < value(DT_VERNEEDNUM); ++i) {
      const auto need = table<Elf64_Verneed>(at, 1, "its versions")[0];
      check_name(need.vn_file);
      std::uint64_t detail = at + need.vn_aux;
      for (std::uint32_t k = 0; k < need.vn_cnt; ++k) {
        const auto aux = table<Elf64_Vernaux>(detail, 1, "its versions")[0];
        check_name(aux.vna_name);
        if (aux.vna_next == 0 && k + 1 < need.vn_cnt) refuse("its versions");
        detail += aux.vna_next;
      }
      if (need.vn_next == 0 && i + 1 < value(DT_VERNEEDNUM)) refuse("its versions");
      at += need.vn_next;
    }
  }

  void check_relocations(std::int64_t tag, std::int64_t size_tag) {
    if (!has(tag)) return;
    const auto relocations = table<Elf64_Rela>(value(tag), value(size_tag) / sizeof(Elf64_Rela),
                                               "its table of relocations");
    const std::uint32_t rights = has(DT_TEXTREL) ? 0 : PF_W;
    const std::uint64_t relative_count = tag == DT_RELA ? value(DT_RELACOUNT) : 0;
    if (relative_count > relocations.size()) refuse("the number of its relocations");
    for (const Elf64_Rela& r : std::span(relocations).first(relative_count))
      if (ELF64_R_TYPE(r.r_info) != relative_type) refuse("the order of its relocations");
    for (const Elf64_Rela& r : relocations) {
      const auto type = static_cast<std::uint32_t>(ELF64_R_TYPE(r.r_info));
      const auto target = static_cast<std::uint64_t>(r.r_addend);
      if (segment_with(r.r_offset, 8, rights) == nullptr)
        refuse("a relocation changes memory that is not writable");
      if (ELF64_R_SYM(r.r_info) >= symbol_count_) refuse("a relocation names no symbol");
      if ((type == relative_type && segment_with(target, 0, 0) == nullptr) ||
          (type == indirect_type && segment_with(target, 1, PF_X) == nullptr))
        refuse("a relocation points outside of its segments");
    }
  }

  /// Those that run when the library is loaded, and the slots of those that it calls. Their
  /// addresses in the arrays are relocated.
  void check_functions() const {
    for (const std::int64_t tag : {DT_INIT, DT_FINI})
      if (has(tag) && segment_with(value(tag), 1, PF_X) == nullptr)
        refuse("a function that runs when it is loaded lies outside of its code");
    constexpr std::int64_t arrays[][2] = {{DT_INIT_ARRAY, DT_INIT_ARRAYSZ},
                                          {DT_FINI_ARRAY, DT_FINI_ARRAYSZ}};
    for (const auto& [tag, size] : arrays)
      if (has(tag) && segment_with(value(tag), value(size), PF_R) == nullptr)
        refuse("the functions that run when it is loaded lie outside of its segments");
    if (has(DT_PLTGOT) && segment_with(value(DT_PLTGOT), 24, PF_W) == nullptr)
      refuse("its table of called functions is not writable");
  }

  ElfFile& file_;
  std::map<std::int64_t, std::uint64_t> entries_;  ///< of the dynamic section, the last of each tag
  std::vector<std::uint64_t> names_;
  std::uint32_t symbol_count_ = 0;
};

}  // namespace

std::string elf_problem(const std::filesystem::path& path) {
  try {
    ElfFile file(path);
    Tables(file).check();
    return {};
  } catch (const ElfRefusal& refusal) {
    return refusal.why;
  }
}

}  // namespace suture
