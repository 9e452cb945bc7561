// SPDX-License-Identifier: GPL-3.0-or-later
//
// OFF
// 3 1 0              <- points, faces, edges
// 0.05 -1 1          <- a point, a colour may follow
// 3 0 1 2            <- a face: how many corners, which points
#include "kernel/geometry/surface_readers.hpp"

namespace suture {

PolygonSoup read_off(const FileText& file) {
  TextCursor cursor(file, TextCursor::Comments::hash);
  const std::string_view key = cursor.word("OFF");
  if (!key.ends_with("OFF")) cursor.fail("expected OFF, found " + in_quotes(key));
  if (cursor.peek_word() == "BINARY" || key.find_first_of("n4") != key.npos)
    cursor.fail(
        "only text OFF files with three coordinates per point are supported; use .ply for binary "
        "data");
  const auto points = cursor.integer<std::uint64_t>("the number of points");
  const auto faces = cursor.integer<std::uint64_t>("the number of faces");
  cursor.skip_line();
  PolygonSoup soup;
  cursor.require_room(points, 3, "points");
  for (std::uint64_t i = 0; i < points; ++i) {
    Vec3& point = soup.points.emplace_back();
    point[0] = cursor.real("x");
    point[1] = cursor.real("y");
    point[2] = cursor.real("z");
    cursor.skip_line();
  }
  cursor.require_room(faces, 1, "faces");
  for (std::uint64_t i = 0; i < faces; ++i) {
    const auto corners = cursor.integer<std::uint64_t>("the number of corners of a face");
    if (corners != 0) cursor.require_room(corners, 1, "corners");
    for (std::uint64_t n = 0; n < corners; ++n) {
      const auto point = cursor.integer<std::int64_t>("the corner of a face");
      if (point < 0 || static_cast<std::uint64_t>(point) >= points)
        cursor.fail("a face uses point " + std::to_string(point) + ", but the " + grouped(points) +
                    " points are numbered from 0");
      soup.corners.push_back(static_cast<Index>(point));
    }
    soup.offsets.push_back(static_cast<Index>(soup.corners.size()));
    cursor.skip_line();
  }
  return soup;
}

}  // namespace suture
