// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "kernel/mesh/vtu_data.hpp"

namespace suture {

/// The parts that VTK's XML files of all data sets have in common: the enclosing tags, the encoding
/// of numbers, and the place where raw data interrupt the XML.
class VtkXml {
 public:
  /// `data_set`: "UnstructuredGrid" or "PolyData"; `needed` says in messages what it is needed for.
  VtkXml(const FileText& file, std::string data_set, std::string needed);

  /// The next tag, skipping raw data; none at the end. Fails for a file with another data set or
  /// compressor.
  std::optional<XmlTag> next();
  /// Fails unless the file is complete, from its first to its last tag, and has a <Piece>.
  void finish() const;

  /// An attribute with a number of points or cells; if it is missing, returns `missing`, or fails
  /// if that is not given.
  std::uint64_t number(const XmlTag& tag, std::string_view key,
                       std::optional<std::uint64_t> missing = {}) const;
  /// The array of the <DataArray> that next() has just returned.
  VtuDataArray array(const XmlTag& tag) const {
    return {tag, tag.closes_itself ? tag.end : xml_.end_of_text()};
  }
  /// Returns the array; fails at the tag of the piece if it is missing.
  const VtuDataArray& required(const std::optional<VtuDataArray>& array, const XmlTag& piece,
                               const char* name) const;
  /// The element around the tag that next() has just given.
  const XmlTag& enclosing() const { return xml_.enclosing(); }
  VtuEncoding& encoding() { return encoding_; }

 private:
  void find_appended();
  void file_header(const XmlTag& tag);
  void check_place(const XmlTag& tag) const;

  const FileText& file_;
  XmlCursor xml_;
  std::string data_set_, needed_;
  VtuEncoding encoding_;
  const char* appended_tag_ = nullptr;
  bool opened_ = false, closed_ = false;
  int pieces_ = 0;
};

}  // namespace suture
