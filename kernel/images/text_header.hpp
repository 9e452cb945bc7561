// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>

#include "kernel/images/header_readers.hpp"

namespace suture {

/// By name, in lower case.
using VoxelTypes = std::map<std::string, VoxelType>;

/// The lines "key = value" of MetaImage or "key: value" of NRRD.
class TextHeader {
 public:
  /// Keys are compared without case. Comments ("# ..."), key/value pairs of NRRD ("key:=value",
  /// which state nothing about the image) and lines without the separator are skipped. The header
  /// ends after the line with the key `last`, and at an empty line if `last` is "".
  TextHeader(const FileHead& head, char separator, const std::string& last);

  /// The value, without blanks around it, of the first of the keys that is present; else nothing.
  std::optional<std::string> find(std::initializer_list<const char*> keys) const;
  std::string require(const char* key) const;
  /// The numbers of a value, which may stand in parentheses; fails for other words.
  std::optional<std::vector<double>> numbers(std::initializer_list<const char*> keys) const;
  /// The numbers of `value`, which is all or a part of what `key` states.
  std::vector<double> numbers_of(const char* key, std::string value) const;
  VoxelType type_named(const char* key, const VoxelTypes& types) const;
  bool is_true(std::initializer_list<const char*> keys) const;

  std::size_t end() const { return end_; }  ///< the first byte behind the header
  const FileHead& head() const { return head_; }

  /// The file that holds the voxels.
  std::filesystem::path beside(const std::string& name) const;

 private:
  const FileHead& head_;
  std::map<std::string, std::string> values_;
  std::size_t end_ = 0;
};

/// In lower case.
std::string lowered(std::string text);

}  // namespace suture
