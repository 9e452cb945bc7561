// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/checkpoint_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "kernel/base/checksum.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/input_file.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/hdf5/hdf5_module.hpp"

namespace suture {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t block_size = 512;
constexpr std::uint64_t format = 9;
constexpr std::string_view begins = "suture checkpoint, format ";
using Block = std::array<char, block_size>;

// ------------------------------------------------------- the block in front --

Block block_of(std::uint64_t size, const std::string& checksum) {
  Block block{};
  const std::string text = std::string(begins) + std::to_string(format) +
                           "\nHDF5 from byte 512 (h5py, h5dump)\nbytes " + std::to_string(size) +
                           "\nxxh64 of those from 512 " + checksum + "\n";
  std::copy(text.begin(), text.end(), block.begin());
  return block;
}

// The number behind `key`, if there is one.
std::optional<std::uint64_t> number_after(std::string_view text, std::string_view key) {
  const std::size_t at = text.find(key);
  if (at == text.npos) return std::nullopt;
  std::uint64_t number = 0;
  const char* first = text.data() + at + key.size();
  const auto [end, error] = std::from_chars(first, text.data() + text.size(), number);
  if (error != std::errc()) return std::nullopt;
  return number;
}

bool is_hdf5(std::string_view start) { return start.starts_with("\x89HDF\r\n\x1a\n"); }

// ------------------------------------------------------------ what is wrong --

[[noreturn]] void refuse(const fs::path& path, const std::string& why) {
  throw InputError(path.string() + ": " + why);
}

// The file that was meant, perhaps: the newest one there.
std::string newest_in(const fs::path& folder) {
  const std::vector<std::uint64_t> numbers = checkpoints_in(folder);
  if (numbers.empty()) return "; no checkpoint was found in " + folder.string();
  return "; the newest one is " + (folder / checkpoint_name(numbers.back())).string();
}

void require_readable(const InputFile& file, const fs::path& path) {
  if (file.problem().empty()) return;
  if (file.is_folder()) refuse(path, "is a folder; give a checkpoint file" + newest_in(path));
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  refuse(path, file.problem() + (file.is_missing() ? newest_in(folder) : ""));
}

constexpr const char* older = "; resume from an older checkpoint";

[[noreturn]] void refuse_foreign(const fs::path& path, std::string_view start) {
  if (start.empty()) refuse(path, std::string("is empty") + older);
  if (is_hdf5(start))
    refuse(path, "is an HDF5 file, but not a Suture checkpoint (checkpoint_NNNN.h5)");
  refuse(path, "is not a Suture checkpoint (checkpoint_NNNN.h5)");
}

// The whole file against the block in front of it, so that HDF5 never sees a damaged one.
void check_bytes(const fs::path& path) {
  InputFile file(path);
  require_readable(file, path);
  Block block{};
  const std::string_view start(block.data(), file.read(block));
  const auto version = number_after(start, begins);
  if (!start.starts_with(begins) || !version) refuse_foreign(path, start);
  if (*version != format)
    refuse(path, "has format " + std::to_string(*version) +
                     "; this version of Suture reads format " + std::to_string(format) +
                     "; resume it with the version that wrote it");

  Checksum checksum;
  std::uint64_t size = start.size();
  constexpr std::size_t piece = 1 << 20;
  const auto buffer = std::make_unique_for_overwrite<char[]>(piece);
  for (std::size_t n = piece; n == piece; size += n) {
    n = file.read({buffer.get(), piece});
    checksum.add(std::as_bytes(std::span(buffer.get(), n)));
  }
  const auto expected = number_after(start, "\nbytes ");
  if (expected && size < *expected)
    refuse(path, "is truncated: it has " + std::to_string(size) + " of " +
                     std::to_string(*expected) + " bytes" + older);
  if (block != block_of(size, checksum.text()))
    refuse(path, std::string("is damaged: its checksum does not match its contents") + older);
}

}  // namespace

void CheckpointHeader::Plugin::state(Archive& archive) {
  archive("id", id);
  archive("version", version);
  archive("file", file);
}

void CheckpointHeader::state(Archive& archive) {
  archive("program", program);
  archive("isa", isa);
  archive("scene_text", scene_text);
  archive("scene_file", scene_file);
  archive("working_folder", working_folder);
  archive("scene_hash", scene_hash);
  archive("mesh_source", mesh_source);
  archive("mesh_hash", mesh_hash);
  archive("plugins", plugins);
  archive("run", run);
  archive("number", number);
  archive("step", step);
  archive("time", time);
  archive("inputs", inputs);
}

void write_checkpoint(OutputFile& file, CheckpointHeader header, StateTree&& state) {
  StateTree tree;
  save_state(tree, header);
  tree.groups["state"] = std::move(state);
  const auto take = [&](std::span<const std::byte> bytes) {
    Checksum checksum;
    checksum.add(bytes);
    const Block block = block_of(block_size + bytes.size(), checksum.text());
    file.write({block.data(), block.size()});
    file.write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    file.sync();
  };
  const std::string failure = hdf5_module().write(std::move(tree), take);
  if (!failure.empty()) throw IoError(file.path().string() + ": cannot be written: " + failure);
}

void write_checkpoint(const fs::path& path, CheckpointHeader header, StateTree&& state) {
  const Folder folder = Folder::open(path.parent_path());
  AtomicFile file(folder, path.filename().string());
  write_checkpoint(file, std::move(header), std::move(state));
  file.commit();
}

bool is_checkpoint(const fs::path& path) {
  InputFile file(path);
  if (!file.problem().empty()) return false;
  std::string start(begins.size(), ' ');
  return file.read(start) == start.size() && start == begins;
}

Checkpoint read_checkpoint(const fs::path& path) {
  check_bytes(path);
  StateTree tree;
  const std::string failure = hdf5_module().read(path.string(), tree);
  if (!failure.empty()) refuse(path, "cannot be read: " + failure);
  Checkpoint checkpoint;
  try {
    load_state(tree, checkpoint.header);
    const auto found = tree.groups.find("state");
    if (found == tree.groups.end()) throw InputError("/: the group 'state' is missing");
    checkpoint.state = std::move(found->second);
  } catch (const InputError& error) {
    refuse(path, error.what());
  }
  return checkpoint;
}

std::string checkpoint_name(std::uint64_t number) {
  char name[40];
  std::snprintf(name, sizeof name, "checkpoint_%04llu.h5", static_cast<unsigned long long>(number));
  return name;
}

std::vector<std::uint64_t> checkpoints_in(const fs::path& folder) {
  std::vector<std::uint64_t> numbers;
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end;
       entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    const auto number = number_after(name, "checkpoint_");
    if (number && name == checkpoint_name(*number)) numbers.push_back(*number);
  }
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

}  // namespace suture
