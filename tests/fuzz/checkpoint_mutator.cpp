// SPDX-License-Identifier: GPL-3.0-or-later
//
// How libFuzzer changes a checkpoint. Changed bytes end at the checksum, which is there to keep
// damaged files from HDF5. Behind it is a tree of arrays in groups, which a file of another scene
// or version, or one that another program has written, has too: so an entry of the tree is
// changed, and the file written again with a checksum that fits.
#include <algorithm>
#include <random>

#include "kernel/hdf5/hdf5_module.hpp"
#include "tests/fuzz/input_file.hpp"
#include "tests/output/checkpoints.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace suture::fuzz {
namespace {

using Array = StateTree::Array;
using Random = std::minstd_rand;

/// An array or a group, in the group that has it.
struct Entry {
  StateTree* parent;
  std::string name;
  bool is_group;
};

void list(StateTree& tree, std::vector<Entry>& entries) {
  for (const auto& [name, array] : tree.arrays) entries.push_back({&tree, name, false});
  for (auto& [name, group] : tree.groups) {
    entries.push_back({&tree, name, true});
    list(group, entries);
  }
}

/// What fits of the old bytes stays, what is new is zero.
void reshape(Array& array, Archive::Scalar type, std::size_t columns, std::size_t rows) {
  Array changed{type, columns, rows, nullptr};
  changed.bytes = std::make_unique<std::byte[]>(changed.size());
  std::copy_n(array.bytes.get(), std::min(array.size(), changed.size()), changed.bytes.get());
  array = std::move(changed);
}

void change_values(Array& array) {
  if (array.size() == 0) return;
  LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(array.bytes.get()), array.size(), array.size());
}

void change_shape(Array& array, Random& random) {
  constexpr auto text = static_cast<unsigned>(Archive::Scalar::text);
  const auto type = static_cast<Archive::Scalar>(random() % (text + 1));
  switch (random() % 4) {
    case 0:
      return reshape(array, array.type, array.columns, random() % (2 * array.rows + 2));
    case 1:
      return reshape(array, array.type, array.columns, array.rows + 1);
    case 2:
      return reshape(array, type, 1, array.rows);
    default:
      reshape(array, array.type, 1 + random() % 4, array.rows);
  }
}

void remove(const Entry& entry) {
  if (entry.is_group)
    entry.parent->groups.erase(entry.name);
  else
    entry.parent->arrays.erase(entry.name);
}

void replace(const Entry& entry, const Entry& by) {
  if (entry.is_group || by.is_group) return;
  const Array& from = by.parent->arrays[by.name];
  Array& to = entry.parent->arrays[entry.name];
  if (&from == &to) return;
  reshape(to, from.type, from.columns, from.rows);
  std::copy_n(from.bytes.get(), from.size(), to.bytes.get());
}

void change(StateTree& tree, Random& random) {
  std::vector<Entry> entries;
  list(tree, entries);
  if (entries.empty()) return;
  const Entry& entry = entries[random() % entries.size()];
  const unsigned kind = random() % 16;
  if (kind == 0) return remove(entry);
  if (kind == 1) return replace(entry, entries[random() % entries.size()]);
  if (entry.is_group) return;
  Array& array = entry.parent->arrays[entry.name];
  kind < 5 ? change_shape(array, random) : change_values(array);
}

/// The file with a changed tree, or "" if it is not a checkpoint or the new one cannot be written.
std::string changed(const std::string& bytes, Random& random) {
  StateTree tree;
  if (bytes.size() <= block_size) return "";
  if (!hdf5_module().read(input_file("m.h5", bytes).string(), tree).empty()) return "";
  for (unsigned changes = 1 + random() % 3; changes > 0; --changes) change(tree, random);
  std::string written = bytes.substr(0, block_size);
  const std::string failure =
      hdf5_module().write(std::move(tree), [&](std::span<const std::byte> file) {
        written.append(reinterpret_cast<const char*>(file.data()), file.size());
      });
  return failure.empty() ? with_block(std::move(written)) : "";
}

}  // namespace
}  // namespace suture::fuzz

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  suture::fuzz::Random random(seed);
  // What is in front of the checksum is mutated, too.
  if (random() % 32 == 0) return LLVMFuzzerMutate(data, size, most);
  const std::string file =
      suture::fuzz::changed({reinterpret_cast<const char*>(data), size}, random);
  if (file.empty() || file.size() > most) return size;
  std::copy(file.begin(), file.end(), data);
  return file.size();
}
