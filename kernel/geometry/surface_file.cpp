// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/surface_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>

#include "kernel/base/error.hpp"
#include "kernel/base/file.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/base/safe_range.hpp"
#include "kernel/geometry/geometry_module.hpp"
#include "kernel/geometry/solid_surface.hpp"
#include "kernel/geometry/sound_soup.hpp"
#include "kernel/geometry/surface_readers.hpp"
#include "kernel/geometry/vtp.hpp"
#include "kernel/mesh/accepted_as.hpp"
#include "kernel/mesh/file_text.hpp"

namespace suture {
namespace {

const std::vector<std::string> extensions{".obj", ".off", ".ply", ".stl"};

std::string lower_extension(const std::filesystem::path& path) {
  std::string text = path.extension().string();
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

// The position in `known` of the extension; `known.size()` if it is not there.
std::size_t position_of(const std::filesystem::path& path, const std::vector<std::string>& known) {
  return std::ranges::find(known, lower_extension(path)) - known.begin();
}

std::string unknown_extension(const std::filesystem::path& path,
                              const std::vector<std::string>& known) {
  std::string list;
  for (const std::string& e : known) list += (list.empty() ? "" : " ") + e;
  const std::string extension = lower_extension(path);
  return path.string() + ": '" + extension + "' is not a surface format" +
         did_you_mean(extension, known) + "; expected one of " + list + accepted_as(path);
}

void scale_points(PolygonSoup& soup, double scale) {
  if (!(scale > 0) || !std::isfinite(scale))
    throw InputError(soup.source + ": scale must be positive and finite");
  for (std::size_t i = 0; i < soup.points.size(); ++i)
    for (double& x : soup.points[i]) {
      x *= scale;
      if (!is_safe_coordinate(x))
        throw InputError(soup.source + ": point " + std::to_string(i) +
                         " has a coordinate that is " +
                         (std::isfinite(x) ? "larger than 1e30 m" : "not finite") +
                         "; check the file and its scale");
    }
  const Box box = box_of(soup.points);
  if (std::max({box.length(0), box.length(1), box.length(2)}) < shortest_length)
    throw InputError(soup.source +
                     ": the surface is smaller than 1e-30 m in all directions; check the file and "
                     "its scale");
}

std::string plural(std::size_t n, const std::string& one, const std::string& many) {
  return grouped(n) + " " + (n == 1 ? one : many);
}

struct SurfaceReader {
  const char* extension;
  PolygonSoup (*read)(const FileText&);
};
constexpr SurfaceReader readers[] = {{".obj", read_obj},
                                     {".off", read_off},
                                     {".ply", read_ply},
                                     {".stl", read_stl},
                                     {".vtp", read_vtp}};

}  // namespace

Box box_of(const std::vector<Vec3>& points) {
  Box box = no_box;
  for (const Vec3& p : points) include(box, p);
  return box;
}

bool is_surface_file(const std::filesystem::path& path) {
  return std::ranges::find(readers, lower_extension(path), &SurfaceReader::extension) !=
         std::end(readers);
}

PolygonSoup read_soup(const std::filesystem::path& path, double scale) {
  std::vector<std::string> known;
  for (const SurfaceReader& reader : readers) known.emplace_back(reader.extension);
  const std::size_t format = position_of(path, known);
  if (format == known.size()) throw InputError(unknown_extension(path, known));
  const FileText file(path);
  PolygonSoup soup = readers[format].read(file);
  soup.source = path.string();
  if (soup.size() == 0)
    throw InputError(path.string() + ": the file contains no faces (" +
                     plural(soup.points.size(), "point", "points") + "); give a surface");
  scale_points(soup, scale);
  return soup;
}

TriangleSurface read_triangles(const std::filesystem::path& path, double scale) {
  PolygonSoup soup = read_soup(path, scale);
  TriangleSurface surface{soup.source, std::move(soup.points), {}};
  std::size_t others = 0;
  for (std::size_t i = 0; i < soup.size(); ++i) {
    const Index* corner = soup.corners.data() + soup.offsets[i];
    if (soup.offsets[i + 1] - soup.offsets[i] == 3)
      surface.triangles.push_back({corner[0], corner[1], corner[2]});
    else
      ++others;
  }
  if (others != 0)
    throw InputError(path.string() + ": " + plural(others, "face is", "faces are") +
                     " not triangular; triangulate the surface before using it as a blade");
  return surface;
}

void write_surface(const std::filesystem::path& path, const TriangleSurface& surface) {
  const std::size_t format = position_of(path, extensions);
  if (format == extensions.size()) throw UsageError(unknown_extension(path, extensions));
  write_file(path, geometry_module().write(static_cast<SurfaceFormat>(format), surface));
}

namespace {}  // namespace

Closing closing_of(const PolygonSoup& soup, bool repair) {
  Closing closing = geometry_module().close(soup, repair);
  const FoldedFace& folded = closing.folded;
  if (folded.corners != 0) {
    char text[160];
    std::snprintf(text, sizeof text, "a face of %zu corners around [%.6g, %.6g, %.6g] m",
                  folded.corners, folded.middle[0], folded.middle[1], folded.middle[2]);
    throw InputError(soup.source + ": " + text +
                     " folds back onto itself, so it cannot be divided into triangles; triangulate "
                     "the surface in the program that wrote it");
  }
  return closing;
}

namespace {

/// Closing more than these takes noticeable time.
constexpr std::size_t many_faces = 100'000;

// "\n  a hole of 12 edges, 0.3 m around, at [0, 0.1, 0.2] m" for the first of them.
std::string list_of_holes(const std::vector<Hole>& holes) {
  constexpr std::size_t shown = 8;
  std::string text;
  for (std::size_t i = 0; i < holes.size() && i < shown; ++i) text += "\n  " + hole_text(holes[i]);
  if (holes.size() > shown) text += "\n  and " + grouped(holes.size() - shown) + " more";
  return text;
}

/// Null if it is not certain that the soup is a solid.
std::shared_ptr<const SolidSurface> solid_if_sound(const PolygonSoup& soup) {
  std::optional<TriangleSurface> surface = sound_solid(soup);
  if (!surface) return nullptr;
  auto solid = std::make_shared<const SolidSurface>(std::move(*surface));
  const bool is_whole = solid->surface().triangles.size() == soup.size();  // none without area
  return is_whole && find_doubtful(solid->surface(), solid->tree()).empty() ? solid : nullptr;
}

}  // namespace

std::shared_ptr<const SolidSurface> read_solid(
    const std::filesystem::path& path, double scale,
    const std::function<void(std::size_t faces)>& announce_long_work) {
  const PolygonSoup soup = read_soup(path, scale);
  if (announce_long_work && soup.size() > many_faces) announce_long_work(soup.size());
  if (std::shared_ptr<const SolidSurface> solid = solid_if_sound(soup)) return solid;
  Closing closing = closing_of(soup, false);
  if (!closing.surface.triangles.empty())
    return std::make_shared<const SolidSurface>(std::move(closing.surface));
  if (closing.crossings != 0)
    throw InputError(path.string() + ": the surface intersects itself (" +
                     plural(closing.crossings, "pair of triangles", "pairs of triangles") +
                     "), so what lies inside is not certain; separate or join the parts");
  if (closing.border_edges == 0)
    throw InputError(path.string() + ": the surface encloses no volume, so it has no inside");
  throw InputError(path.string() + ": the surface is open, so it has no inside: " +
                   plural(closing.border_edges, "edge has", "edges have") +
                   " a face on one side only; close it" + list_of_holes(closing.holes));
}

std::string hole_text(const Hole& hole) {
  char text[200];
  std::snprintf(text, sizeof text, "a hole of %zu edges, %.4g m around, at [%.6g, %.6g, %.6g] m",
                hole.edges, hole.length, hole.middle[0], hole.middle[1], hole.middle[2]);
  return text;
}

TriangleSurface close_surface(const PolygonSoup& soup, bool repair, Diagnostics& diagnostics,
                              const std::string& repair_option) {
  if (soup.size() > many_faces)
    diagnostics.note(soup.source + ": preparing " + grouped(soup.size()) +
                     " faces, which takes about " +
                     std::to_string(std::lround(std::ceil(5e-6 * double(soup.size())))) + " s");
  Closing closing = closing_of(soup, repair);
  const std::string border = plural(closing.border_edges, "edge has", "edges have");
  const std::string crossings =
      plural(closing.crossings, "pair of triangles", "pairs of triangles") + " intersect";
  if (closing.surface.triangles.empty()) {
    if (closing.crossings != 0)
      throw InputError(soup.source + ": the surface intersects itself (" + crossings + "); use " +
                       repair_option + " to fill the region enclosed by all its sheets");
    if (closing.border_edges == 0)
      throw InputError(soup.source + ": the surface encloses no volume: there is nothing to fill");
    throw InputError(soup.source + ": the surface is not closed: " + border +
                     " a face on one side only" +
                     (repair ? ", and not every hole could be filled; close by hand"
                             : "; use " + repair_option + " to fill each hole") +
                     list_of_holes(closing.holes));
  }
  if (closing.holes_filled != 0)
    diagnostics.warn(soup.source + ": the surface is not closed, " + border +
                     " a face on one side only; " +
                     plural(closing.holes_filled, "hole was", "holes were") + " filled");
  if (closing.crossings != 0)
    diagnostics.warn(soup.source + ": the surface intersects itself (" + crossings +
                     "); the region enclosed by all its sheets is filled");
  return std::move(closing.surface);
}

}  // namespace suture
