// SPDX-License-Identifier: GPL-3.0-or-later
//
// VTK's XML files of unstructured grids. Read here and not by VTK, whose reader
// ends the program for some damaged files and allocates what a corrupt header
// asks for; VTK's compressors are used, behind its module.
#include <algorithm>

#include "kernel/mesh/readers.hpp"
#include "kernel/mesh/vtk_mesh.hpp"
#include "kernel/mesh/vtu_data.hpp"

namespace suture {
namespace {

class VtuReader {
 public:
  VtuReader(const FileText& file, Diagnostics& diagnostics)
      : file_(file), diagnostics_(diagnostics), xml_(file) {}

  Mesh read() {
    find_appended();
    bool opened = false, closed = false;
    while (const auto tag = next()) {
      if (tag->name == "VTKFile") {
        (tag->closes ? closed : opened) = true;
        if (!tag->closes) file_header(*tag);
      } else if (!opened) {
        file_.fail_at_line(tag->at, "the file begins with <" +
                                        std::string(tag->name.substr(0, 40)) +
                                        ">, not with <VTKFile>");
      } else if (tag->name == "Piece" && !tag->closes) {
        piece(*tag);
      }
    }
    if (!opened) file_.fail_at_line(file_.begin(), "there is no element <VTKFile>");
    if (!closed)
      file_.fail_at_byte(file_.end(), "the file does not end with </VTKFile>: it is truncated");
    if (pieces_ == 0) file_.fail_at_line(file_.begin(), "there is no element <Piece>");
    drop_incomplete_labels();
    return mesh_from_vtk(std::move(grid_), file_, diagnostics_);
  }

 private:
  // Raw data may contain anything: the XML ends where they begin, and goes on
  // behind the last </AppendedData>.
  void find_appended() {
    const std::string_view text = file_.view();
    const std::size_t open = text.find("<AppendedData");
    if (open == text.npos) return;
    const std::size_t start = text.find('_', open);
    const std::size_t close = text.rfind("</AppendedData>");
    if (start == text.npos || close == text.npos || close < start) {
      file_.fail_at_byte(file_.end(), "the appended data have no end: the file is truncated");
    }
    appended_tag_ = file_.begin() + open;
    encoding_.appended = file_.begin() + start + 1;
    encoding_.appended_end = file_.begin() + close;
    encoding_.appended_base64 = text.substr(open, start - open).find("\"base64\"") != text.npos;
  }

  std::optional<XmlTag> next() {
    const auto tag = xml_.next();
    if (tag && tag->at == appended_tag_) xml_.seek(encoding_.appended_end);
    return tag;
  }

  void file_header(const XmlTag& tag) {
    if (tag["type"] != "UnstructuredGrid") {
      file_.fail_at_line(tag.at, "the data set is " + in_quotes(tag["type"]) +
                                     "; an UnstructuredGrid with hexahedra is needed");
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
      file_.fail_at_line(tag.at, "compressor " + in_quotes(compressor) + " is not known");
  }

  std::uint64_t number(const XmlTag& tag, std::string_view key,
                       std::optional<std::uint64_t> missing = {}) {
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

  void piece(const XmlTag& tag) {
    ++pieces_;
    points_ = number(tag, "NumberOfPoints");
    cells_ = number(tag, "NumberOfCells");
    first_point_ = grid_.points.size();
    first_cell_ = grid_.types.size();
    if (tag.closes_itself) return;
    std::optional<VtuDataArray> points, connectivity, offsets, types;
    XmlTag section;
    while (const auto inner = next()) {
      if (inner->name == "Piece") break;
      if (inner->name != "DataArray") {
        section = *inner;
      } else if (!inner->closes) {
        const VtuDataArray array{*inner, inner->closes_itself ? inner->end : xml_.end_of_text()};
        const std::string_view name = (*inner)["Name"];
        if (section.name == "Points")
          points = array;
        else if (section.name == "Cells" && name == "connectivity")
          connectivity = array;
        else if (section.name == "Cells" && name == "offsets")
          offsets = array;
        else if (section.name == "Cells" && name == "types")
          types = array;
        else if (section.name == "PointData")
          label(section, array, false);
        else if (section.name == "CellData")
          label(section, array, true);
      }
    }
    if (points_ > 0) add_points(required(points, tag, "Points"));
    if (cells_ == 0) return;
    add_cells(required(connectivity, tag, "connectivity"), required(offsets, tag, "offsets"),
              required(types, tag, "types"));
  }

  const VtuDataArray& required(const std::optional<VtuDataArray>& array, const XmlTag& tag,
                               const char* name) {
    if (!array) file_.fail_at_line(tag.at, std::string("the piece has no array of ") + name);
    return *array;
  }

  void add_points(const VtuDataArray& array) {
    if (number(array.tag, "NumberOfComponents", 1) != 3) {
      file_.fail_at_line(array.tag.at, "points must have 3 components");
    }
    const std::vector<double> x = vtu_reals(file_, encoding_, array, 3 * points_);
    for (std::size_t i = 0; i < points_; ++i)
      grid_.points.push_back({x[3 * i], x[3 * i + 1], x[3 * i + 2]});
  }

  // Offsets of the file are the ends of the cells.
  void add_cells(const VtuDataArray& connectivity, const VtuDataArray& offsets,
                 const VtuDataArray& types) {
    const auto ends = vtu_integers(file_, encoding_, offsets, cells_);
    const auto nodes = vtu_integers(file_, encoding_, connectivity, std::nullopt);
    if (ends.front() < 0 || !std::is_sorted(ends.begin(), ends.end()) ||
        ends.back() != static_cast<std::int64_t>(nodes.size())) {
      file_.fail_at_line(offsets.tag.at, "the offsets of the cells do not fit their connectivity");
    }
    const auto base = static_cast<std::int64_t>(grid_.connectivity.size());
    if (grid_.offsets.empty()) grid_.offsets.push_back(0);
    for (const std::int64_t end : ends) grid_.offsets.push_back(base + end);
    for (const std::int64_t node : nodes) {
      if (node < 0 || node >= static_cast<std::int64_t>(points_)) {
        file_.fail_at_line(connectivity.tag.at, "a cell has point " + std::to_string(node) +
                                                    "; the piece has " + grouped(points_) +
                                                    " points");
      }
      grid_.connectivity.push_back(node + static_cast<std::int64_t>(first_point_));
    }
    for (const std::int64_t type : vtu_integers(file_, encoding_, types, cells_)) {
      grid_.types.push_back(static_cast<std::uint8_t>(type));
    }
  }

  void label(const XmlTag& section, const VtuDataArray& array, bool of_cells) {
    if (!vtu_is_integer(array) || number(array.tag, "NumberOfComponents", 1) != 1) return;
    const std::string_view name = array.tag["Name"];
    const bool global = !name.empty() && section["GlobalIds"] == name;
    const std::string plain = unescaped(name);
    auto found = std::find_if(
        grid_.labels.begin(), grid_.labels.end(),
        [&](const VtkGrid::Labels& l) { return l.name == plain && l.of_cells == of_cells; });
    if (found == grid_.labels.end()) {
      if (pieces_ > 1) return;
      grid_.labels.push_back({plain, of_cells, vtu_bytes(array) == 1, global, {}});
      found = grid_.labels.end() - 1;
    }
    const auto values = vtu_integers(file_, encoding_, array, of_cells ? cells_ : points_);
    if (found->values.size() != (of_cells ? first_cell_ : first_point_)) return;
    found->values.insert(found->values.end(), values.begin(), values.end());
  }

  // Arrays that not all pieces have.
  void drop_incomplete_labels() {
    std::erase_if(grid_.labels, [&](const VtkGrid::Labels& labels) {
      return labels.values.size() != (labels.of_cells ? grid_.types.size() : grid_.points.size());
    });
  }

  const FileText& file_;
  Diagnostics& diagnostics_;
  XmlCursor xml_;
  VtuEncoding encoding_;
  const char* appended_tag_ = nullptr;
  VtkGrid grid_;
  std::uint64_t points_ = 0, cells_ = 0, first_point_ = 0, first_cell_ = 0;
  int pieces_ = 0;
};

}  // namespace

Mesh read_vtu(const FileText& file, Diagnostics& diagnostics) {
  return VtuReader(file, diagnostics).read();
}

}  // namespace suture
