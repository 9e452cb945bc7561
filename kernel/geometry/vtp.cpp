// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/vtp.hpp"

#include <algorithm>
#include <optional>

#include "kernel/mesh/vtk_xml.hpp"

namespace suture {
namespace {

/// The arrays of one <Piece> that are of interest here.
struct Piece {
  std::uint64_t points = 0, polygons = 0;
  std::optional<VtuDataArray> coordinates, connectivity, offsets;
};

class VtpReader {
 public:
  explicit VtpReader(const FileText& file)
      : file_(file), xml_(file, "PolyData", "PolyData with polygons") {}

  PolygonSoup read() {
    while (const auto tag = xml_.next())
      if (tag->name == "Piece" && !tag->closes) add(piece(*tag), *tag);
    xml_.finish();
    return std::move(soup_);
  }

 private:
  Piece piece(const XmlTag& tag) {
    Piece piece;
    piece.points = xml_.number(tag, "NumberOfPoints");
    piece.polygons = xml_.number(tag, "NumberOfPolys", 0);
    if (tag.closes_itself) return piece;
    while (const auto inner = xml_.next()) {
      if (inner->name == "Piece") break;
      if (inner->name == "DataArray" && !inner->closes) {
        const XmlTag section = xml_.enclosing();
        const VtuDataArray array = xml_.array(*inner);
        const std::string_view name = (*inner)["Name"];
        if (section.name == "Points") piece.coordinates = array;
        if (section.name == "Polys" && name == "connectivity") piece.connectivity = array;
        if (section.name == "Polys" && name == "offsets") piece.offsets = array;
      }
    }
    return piece;
  }

  void add(const Piece& piece, const XmlTag& tag) {
    if (piece.points == 0 || piece.polygons == 0) return;
    const auto first = static_cast<Index>(soup_.points.size());
    const auto x = vtu_reals(file_, xml_.encoding(),
                             xml_.required(piece.coordinates, tag, "Points"), 3 * piece.points);
    for (std::size_t i = 0; i < piece.points; ++i)
      soup_.points.push_back({x[3 * i], x[3 * i + 1], x[3 * i + 2]});
    const auto ends = vtu_integers(file_, xml_.encoding(),
                                   xml_.required(piece.offsets, tag, "offsets"), piece.polygons);
    if (ends.front() < 0 || !std::ranges::is_sorted(ends))
      file_.fail_at_line(tag.at, "the offsets of the polygons are not ascending");
    const auto corners =
        vtu_integers(file_, xml_.encoding(), xml_.required(piece.connectivity, tag, "connectivity"),
                     static_cast<std::uint64_t>(ends.back()));
    const auto base = static_cast<Index>(soup_.corners.size());
    for (const std::int64_t end : ends) soup_.offsets.push_back(base + static_cast<Index>(end));
    for (const std::int64_t corner : corners) {
      if (corner < 0 || corner >= static_cast<std::int64_t>(piece.points))
        file_.fail_at_line(tag.at, "a polygon uses point " + std::to_string(corner) +
                                       "; the piece has " + grouped(piece.points) + " points");
      soup_.corners.push_back(first + static_cast<Index>(corner));
    }
  }

  const FileText& file_;
  VtkXml xml_;
  PolygonSoup soup_;
};

}  // namespace

PolygonSoup read_vtp(const FileText& file) { return VtpReader(file).read(); }

}  // namespace suture
