// SPDX-License-Identifier: GPL-3.0-or-later
//
// VTK's XML files of unstructured grids. Not read by VTK, because its reader ends the
// program for some damaged files and allocates as much as a corrupt header requests;
// VTK's compressors are used, through the module in kernel/vtk.
#include <algorithm>

#include "kernel/mesh/readers.hpp"
#include "kernel/mesh/vtk_mesh.hpp"
#include "kernel/mesh/vtk_xml.hpp"

namespace suture {
namespace {

class VtuReader {
 public:
  VtuReader(const FileText& file, const MeshWants& wants, Diagnostics& diagnostics)
      : file_(file),
        wants_(wants),
        diagnostics_(diagnostics),
        xml_(file, "UnstructuredGrid", "an UnstructuredGrid with hexahedra") {}

  Mesh read() {
    while (const auto tag = xml_.next())
      if (tag->name == "Piece" && !tag->closes) piece(*tag);
    xml_.finish();
    drop_incomplete_labels();
    empty_incomplete_arrays();
    return mesh_from_vtk(std::move(grid_), file_, wants_.all_solids, diagnostics_);
  }

 private:
  void piece(const XmlTag& tag) {
    ++pieces_;
    points_ = xml_.number(tag, "NumberOfPoints");
    cells_ = xml_.number(tag, "NumberOfCells");
    first_point_ = grid_.points.size();
    first_cell_ = grid_.types.size();
    if (tag.closes_itself) return;
    std::optional<VtuDataArray> points, connectivity, offsets, types;
    while (const auto inner = xml_.next()) {
      if (inner->name == "Piece") break;
      if (inner->name == "DataArray" && !inner->closes) {
        const XmlTag section = xml_.enclosing();
        const VtuDataArray array = xml_.array(*inner);
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
          data(section, array, false);
        else if (section.name == "CellData")
          data(section, array, true);
      }
    }
    if (points_ > 0) add_points(xml_.required(points, tag, "Points"));
    if (cells_ == 0) return;
    add_cells(xml_.required(connectivity, tag, "connectivity"),
              xml_.required(offsets, tag, "offsets"), xml_.required(types, tag, "types"));
  }

  void add_points(const VtuDataArray& array) {
    if (xml_.number(array.tag, "NumberOfComponents", 1) != 3) {
      file_.fail_at_line(array.tag.at, "points must have 3 components");
    }
    const std::vector<double> x = vtu_reals(file_, xml_.encoding(), array, 3 * points_);
    for (std::size_t i = 0; i < points_; ++i)
      grid_.points.push_back({x[3 * i], x[3 * i + 1], x[3 * i + 2]});
  }

  // Offsets of the file are the ends of the cells.
  void add_cells(const VtuDataArray& connectivity, const VtuDataArray& offsets,
                 const VtuDataArray& types) {
    const auto ends = vtu_integers(file_, xml_.encoding(), offsets, cells_);
    if (ends.front() < 0 || !std::is_sorted(ends.begin(), ends.end()))
      file_.fail_at_line(offsets.tag.at, "the offsets of the cells are not ascending");
    const auto nodes =
        vtu_integers(file_, xml_.encoding(), connectivity, static_cast<std::uint64_t>(ends.back()));
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
    for (const std::int64_t type : vtu_integers(file_, xml_.encoding(), types, cells_)) {
      if (type < 0 || type > 255)
        file_.fail_at_line(types.tag.at, "cell type " + std::to_string(type) + " is unknown");
      grid_.types.push_back(static_cast<std::uint8_t>(type));
    }
  }

  void data(const XmlTag& section, const VtuDataArray& array, bool of_cells) {
    vtu_check_type(file_, array);
    const std::string_view name = array.tag["Name"];
    const std::uint64_t components = xml_.number(array.tag, "NumberOfComponents", 1);
    const bool global = !name.empty() && section["GlobalIds"] == name;
    if (vtu_is_integer(array) && components == 1) label(unescaped(name), array, of_cells, global);
    if (!global) values(unescaped(name), array, of_cells, std::max<std::uint64_t>(components, 1));
  }

  void label(const std::string& plain, const VtuDataArray& array, bool of_cells, bool global) {
    auto found = std::find_if(
        grid_.labels.begin(), grid_.labels.end(),
        [&](const VtkGrid::Labels& l) { return l.name == plain && l.of_cells == of_cells; });
    if (found == grid_.labels.end()) {
      if (pieces_ > 1) return warn_of_missing(plain);
      grid_.labels.push_back({plain, of_cells, vtu_bytes(array) == 1, global, {}});
      found = grid_.labels.end() - 1;
    }
    const auto values = vtu_integers(file_, xml_.encoding(), array, of_cells ? cells_ : points_);
    if (found->values.size() != (of_cells ? first_cell_ : first_point_)) return;
    found->values.insert(found->values.end(), values.begin(), values.end());
  }

  void values(const std::string& plain, const VtuDataArray& array, bool of_cells,
              std::uint64_t components) {
    const bool wanted = wants_.wants_array(plain);
    MeshArray* found = grid_.find_array(plain, of_cells);
    if (!found) {
      grid_.arrays.push_back({plain, of_cells, components, {}, {}});
      found = &grid_.arrays.back();
      if (vtu_bytes(array) == 0)
        found->unreadable = "its type is " + in_quotes(array.tag["type"]) + ", not a number";
      if (pieces_ > 1) found->unreadable = not_in_every_piece;
    }
    if (!found->unreadable.empty() || !wanted) return;
    if (found->components != components)
      found->unreadable = "its number of components differs between the pieces";
    else if (found->values.size() != components * (of_cells ? first_cell_ : first_point_))
      found->unreadable = not_in_every_piece;
    if (!found->unreadable.empty()) return;
    const auto more =
        vtu_numbers(file_, xml_.encoding(), array, components * (of_cells ? cells_ : points_));
    found->values.insert(found->values.end(), more.begin(), more.end());
  }

  void empty_incomplete_arrays() {
    for (MeshArray& array : grid_.arrays) {
      const std::size_t count = array.of_elements ? grid_.types.size() : grid_.points.size();
      if (!array.values.empty() && array.values.size() != array.components * count)
        array.unreadable = not_in_every_piece;
      if (!array.unreadable.empty()) array.values.clear();
    }
  }

  // Arrays that not all pieces have.
  void drop_incomplete_labels() {
    std::erase_if(grid_.labels, [&](const VtkGrid::Labels& labels) {
      const std::size_t count = labels.of_cells ? grid_.types.size() : grid_.points.size();
      if (labels.values.size() != count) warn_of_missing(labels.name);
      return labels.values.size() != count;
    });
  }
  void warn_of_missing(const std::string& name) {
    diagnostics_.warn(file_.name() + ": array " + in_quotes(name) +
                      " does not appear exactly once in every piece; it is not read");
  }

  static constexpr const char* not_in_every_piece =
      "it does not appear exactly once in every piece of the file";

  const FileText& file_;
  const MeshWants& wants_;
  Diagnostics& diagnostics_;
  VtkXml xml_;
  VtkGrid grid_;
  std::uint64_t points_ = 0, cells_ = 0, first_point_ = 0, first_cell_ = 0;
  int pieces_ = 0;
};

}  // namespace

Mesh read_vtu(const FileText& file, const MeshWants& wants, Diagnostics& diagnostics) {
  return VtuReader(file, wants, diagnostics).read();
}

}  // namespace suture
