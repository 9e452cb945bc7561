// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "kernel/mesh/vtu_data.hpp"

namespace suture {

/// What VTK's XML files have in common, whatever their data set: the frame around it,
/// how numbers are encoded, where raw data interrupt the XML.
class VtkXml {
 public:
  /// `data_set`: "UnstructuredGrid", "PolyData"; `needed` says what for, in messages.
  VtkXml(const FileText& file, std::string data_set, std::string needed);

  /// The next tag, behind raw data if they come; none at the end. Fails for a file of
  /// another data set or compressor.
  std::optional<XmlTag> next();
  /// Fails unless the file began and ended as it should and had a <Piece>.
  void finish() const;

  /// An attribute that counts points or cells; fails if it is missing and `missing` is not given.
  std::uint64_t number(const XmlTag& tag, std::string_view key,
                       std::optional<std::uint64_t> missing = {}) const;
  /// The array of a <DataArray> that next() has just given.
  VtuDataArray array(const XmlTag& tag) const {
    return {tag, tag.closes_itself ? tag.end : xml_.end_of_text()};
  }
  /// Fails at the piece's tag for an array that is not there.
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
