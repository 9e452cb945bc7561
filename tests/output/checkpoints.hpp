// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstring>
#include <random>
#include <span>
#include <string>

#include "kernel/base/checksum.hpp"
#include "kernel/output/checkpoint_file.hpp"

namespace suture {

inline void write_checkpoint(const std::filesystem::path& path, CheckpointHeader header,
                             StateTree&& state) {
  const Folder folder = Folder::open(path.parent_path());
  AtomicFile file(folder, path.filename().string());
  write_checkpoint(file, std::move(header), std::move(state));
  file.commit();
}

/// An array of random bytes, the same for the same shape.
inline void add(StateTree& tree, const std::string& name, Archive::Scalar type, std::size_t columns,
                std::size_t rows) {
  StateTree::Array array{type, columns, rows, nullptr};
  array.bytes = std::make_unique_for_overwrite<std::byte[]>(array.size());
  std::mt19937_64 random(columns * 1000003 + rows);
  for (std::size_t i = 0; i < array.size(); ++i) array.bytes[i] = std::byte(random());
  tree.arrays[name] = std::move(array);
}

inline StateTree copy_of(const StateTree& tree) {
  StateTree copy;
  for (const auto& [name, array] : tree.arrays) {
    StateTree::Array& to = copy.arrays[name];
    to = {array.type, array.columns, array.rows, nullptr};
    to.bytes = std::make_unique_for_overwrite<std::byte[]>(array.size());
    std::copy_n(array.bytes.get(), array.size(), to.bytes.get());
  }
  for (const auto& [name, group] : tree.groups) copy.groups[name] = copy_of(group);
  return copy;
}

inline bool same(const StateTree& a, const StateTree& b) {
  return std::equal(
             a.arrays.begin(), a.arrays.end(), b.arrays.begin(), b.arrays.end(),
             [](const auto& x, const auto& y) {
               return x.first == y.first && x.second.type == y.second.type &&
                      x.second.columns == y.second.columns && x.second.rows == y.second.rows &&
                      std::equal(x.second.bytes.get(), x.second.bytes.get() + x.second.size(),
                                 y.second.bytes.get());
             }) &&
         std::equal(a.groups.begin(), a.groups.end(), b.groups.begin(), b.groups.end(),
                    [](const auto& x, const auto& y) {
                      return x.first == y.first && same(x.second, y.second);
                    });
}

/// A little of everything; larger with `size`.
inline StateTree some_state(std::size_t size) {
  StateTree tree;
  add(tree, "step", Archive::Scalar::u64, 1, 1);
  add(tree, "reason", Archive::Scalar::text, 1, 40);
  add(tree, "nothing", Archive::Scalar::text, 1, 0);
  StateTree& dynamics = tree.groups["dynamics"];
  add(dynamics, "positions", Archive::Scalar::f64, 3, 1000 * size);
  add(dynamics, "velocities", Archive::Scalar::f64, 3, 10 * size);
  add(dynamics, "held", Archive::Scalar::u8, 1, 500 * size);
  add(dynamics, "none", Archive::Scalar::u32, 8, 0);
  add(dynamics, "place", Archive::Scalar::f64, 3, 1);
  for (std::size_t i = 0; i < 5 * size; ++i)
    add(tree.groups["events"].groups[std::to_string(i)], "at", Archive::Scalar::f64, 1, 1);
  return tree;
}

inline CheckpointHeader some_header() {
  CheckpointHeader header;
  header.program = "suture 0.1.0";
  header.isa = "avx512";
  header.scene_text = "{\"suture\":1,\"title\":\"" + std::string(3000, 'x') + "\"}";
  header.scene_file = "s/beam.json";
  header.scene_hash = "0123456789abcdef";
  header.plugins = {{"tm-faure", "1.0", "p/a.so"}, {"mss-baudet", "1.1", "p/\xc3\xa9t\xc3\xa9.so"}};
  header.number = 4;
  header.step = 123456789012;
  header.time = 0.1;
  return header;
}

/// The bytes in front of HDF5.
constexpr std::size_t block_size = 512;

/// The bytes with a length and a checksum in the block in front that fit them.
inline std::string with_block(std::string bytes) {
  Checksum checksum;
  checksum.add(std::as_bytes(std::span(bytes).subspan(block_size)));
  std::string end = "\nbytes " + std::to_string(bytes.size()) + "\nxxh64 of those from 512 " +
                    checksum.text() + "\n";
  const std::size_t at = std::min(bytes.find("\nbytes "), block_size - end.size());
  end.resize(block_size - at);
  return bytes.replace(at, end.size(), end);
}

}  // namespace suture
