// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/mesh/vtk_xml.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include "kernel/mesh/readers.hpp"

namespace suture {

VtkXml::VtkXml(const FileText& file, std::string data_set, std::string needed)
    : file_(file), xml_(file), data_set_(std::move(data_set)), needed_(std::move(needed)) {
  find_appended();
  // Meshes of VTK's writers expand to 60 times their file at most; 16 MB are for small files.
  encoding_.memory_left = (std::uint64_t{16} << 20) + 128 * file.view().size();
}

// Raw data may contain anything: the XML ends where they begin and continues after the last
// </AppendedData>.
void VtkXml::find_appended() {
  const std::string_view text = file_.view();
  const std::size_t open = text.find("<AppendedData");
  if (open == text.npos) return;
  const std::size_t start = text.find('_', open);
  const std::size_t close = text.rfind("</AppendedData>");
  if (start == text.npos || close == text.npos || close < start) {
    file_.fail_at_byte(file_.end(),
                       "the end of the appended data is missing: the file is truncated");
  }
  appended_tag_ = file_.begin() + open;
  encoding_.appended = file_.begin() + start + 1;
  encoding_.appended_end = file_.begin() + close;
  encoding_.appended_base64 = text.substr(open, start - open).find("\"base64\"") != text.npos;
}

std::optional<XmlTag> VtkXml::next() {
  const auto tag = xml_.next();
  if (!tag) return tag;
  if (tag->at == appended_tag_) xml_.seek(encoding_.appended_end);
  if (tag->name == "VTKFile") {
    (tag->closes ? closed_ : opened_) = true;
    if (!tag->closes) file_header(*tag);
  } else if (!opened_) {
    file_.fail_at_line(tag->at,
                       "the file begins with <" + printable(tag->name) + ">, not with <VTKFile>");
  }
  if (tag->name == "Piece" && !tag->closes) ++pieces_;
  if (!tag->closes) check_place(*tag);
  return tag;
}

// Sections of a piece hold arrays and nothing else.
void VtkXml::check_place(const XmlTag& tag) const {
  constexpr std::array<std::string_view, 8> sections{"PointData", "CellData", "Points", "Cells",
                                                     "Verts",     "Lines",    "Strips", "Polys"};
  const std::string_view outer = enclosing().name;
  if (std::find(sections.begin(), sections.end(), outer) == sections.end()) return;
  if (tag.name == "DataArray" || tag.name == "Array") return;
  file_.fail_at_line(tag.at, "<" + std::string(outer) + "> has an element <" + printable(tag.name) +
                                 ">, where only <DataArray> is expected: the file is damaged");
}

void VtkXml::finish() const {
  if (!opened_) file_.fail_at_line(file_.begin(), "element <VTKFile> is missing");
  if (!closed_)
    file_.fail_at_byte(file_.end(), "the file does not end with </VTKFile>: it is truncated");
  if (pieces_ == 0) file_.fail_at_line(file_.begin(), "element <Piece> is missing");
}

void VtkXml::file_header(const XmlTag& tag) {
  if (tag["type"] != data_set_) {
    file_.fail_at_line(
        tag.at, "the data set is " + in_quotes(tag["type"]) + "; " + needed_ + " is expected");
  }
  encoding_.swap_bytes = tag["byte_order"] == "BigEndian";
  encoding_.long_headers = tag["header_type"] == "UInt64";
  const std::string_view compressor = tag["compressor"];
  if (compressor == "vtkZLibDataCompressor")
    encoding_.compression = VtuCompression::zlib;
  else if (compressor == "vtkLZ4DataCompressor")
    encoding_.compression = VtuCompression::lz4;
  else if (compressor == "vtkLZMADataCompressor")
    encoding_.compression = VtuCompression::lzma;
  else if (!compressor.empty())
    file_.fail_at_line(tag.at, "compressor " + in_quotes(compressor) + " is unknown");
}

std::uint64_t VtkXml::number(const XmlTag& tag, std::string_view key,
                             std::optional<std::uint64_t> missing) const {
  const std::string_view word = tag[key];
  if (word.empty() && missing) return *missing;
  std::uint64_t value = 0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || stop != word.data() + word.size() || word.empty()) {
    file_.fail_at_line(tag.at, std::string(key) + " is " + in_quotes(word) + ", not a number");
  }
  check_count(file_, value, "points or cells");
  return value;
}

const VtuDataArray& VtkXml::required(const std::optional<VtuDataArray>& array, const XmlTag& tag,
                                     const char* name) const {
  if (!array) file_.fail_at_line(tag.at, std::string("the piece has no array for ") + name);
  return *array;
}

}  // namespace suture
