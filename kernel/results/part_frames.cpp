// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/results/part_frames.hpp"

namespace suture {
namespace {

/// The points of a frame: vertices, then points within elements.
struct ShownPoints {
  std::vector<Index> vertices;  ///< ascending
  std::vector<Index> embedded;  ///< points of the embedding, ascending
  std::vector<Index> of_vertex, of_embedded;

  /// `is_used`: by vertex. Embedded points that lie on a vertex stand for it.
  ShownPoints(const EmbeddedPoints& points, std::vector<std::uint8_t> is_used,
              const std::vector<std::uint8_t>& is_embedded_used) {
    of_vertex.assign(is_used.size(), none);
    of_embedded.assign(points.size(), none);
    for (Index p = 0; p < points.size(); ++p)
      if (is_embedded_used[p] != 0 && points.vertex(p) != none) is_used[points.vertex(p)] = 1;
    for (Index v = 0; v < is_used.size(); ++v) {
      if (is_used[v] == 0) continue;
      of_vertex[v] = static_cast<Index>(vertices.size());
      vertices.push_back(v);
    }
    for (Index p = 0; p < points.size(); ++p) {
      if (is_embedded_used[p] == 0) continue;
      if (const Index v = points.vertex(p); v != none) {
        of_embedded[p] = of_vertex[v];
      } else {
        of_embedded[p] = static_cast<Index>(vertices.size() + embedded.size());
        embedded.push_back(p);
      }
    }
  }
  std::size_t size() const { return vertices.size() + embedded.size(); }
};

/// Takes the values of the shown points from those of the vertices.
void interpolate(FrameField& field, const ShownPoints& shown, const EmbeddedPoints& points) {
  const auto width = static_cast<std::size_t>(field.components);
  if (!field.ids.empty()) {
    std::vector<std::int64_t> ids;
    for (const Index v : shown.vertices) ids.push_back(field.ids[v]);
    ids.resize(shown.size(), -1);
    field.ids = std::move(ids);
    return;
  }
  std::vector<double> values;
  values.reserve(shown.size() * width);
  for (const Index v : shown.vertices)
    for (std::size_t c = 0; c < width; ++c) values.push_back(field.values[width * v + c]);
  for (const Index p : shown.embedded)
    for (std::size_t c = 0; c < width; ++c)
      values.push_back(points.value(p, field.values.data(), width, c));
  field.values = std::move(values);
}

void interpolate(Frame& frame, const ShownPoints& shown, const EmbeddedPoints& points) {
  std::vector<Vec3> places;
  places.reserve(shown.size());
  for (const Index v : shown.vertices) places.push_back(frame.points[v]);
  for (const Index p : shown.embedded) {
    Vec3& place = places.emplace_back();
    for (std::size_t a = 0; a < 3; ++a) place[a] = points.value(p, frame.points[0].data(), 3, a);
  }
  frame.points = std::move(places);
  for (FrameField& field : frame.point_fields) interpolate(field, shown, points);
}

template <class T>
std::vector<T> of_elements(const std::vector<T>& values, const std::vector<Index>& elements,
                           std::size_t width) {
  std::vector<T> result;
  if (values.empty()) return result;
  result.reserve(elements.size() * width);
  for (const Index e : elements)
    for (std::size_t c = 0; c < width; ++c) result.push_back(values[width * e + c]);
  return result;
}

/// Takes the values of cells from those of the elements to which they belong.
void copy(std::vector<FrameField>& fields, const std::vector<Index>& elements) {
  for (FrameField& field : fields) {
    const auto width = static_cast<std::size_t>(field.components);
    field.values = of_elements(field.values, elements, width);
    field.ids = of_elements(field.ids, elements, width);
    field.global_ids = false;  // several cells have the number of one element
  }
}

/// The existing elements that are full, ascending.
std::vector<Index> full_elements(const Parts& parts, const CellComplex& complex) {
  std::vector<Index> full;
  std::size_t next = 0;
  for (Index e = 0; e < complex.element_count(); ++e)
    if (next < parts.elements.size() && parts.elements[next] == e)
      ++next;
    else if (complex.exists(3, e))
      full.push_back(e);
  return full;
}

template <class Cells>
std::vector<std::uint8_t> corners_of(const Cells& cells, std::size_t points) {
  std::vector<std::uint8_t> is_corner(points);
  for (const auto& cell : cells)
    for (const Index corner : cell) is_corner[corner] = 1;
  return is_corner;
}

}  // namespace

void show_parts(Frame& frame, const Parts& parts, const Embedding& embedding,
                const CellComplex& complex) {
  std::vector<Index> elements = full_elements(parts, complex);
  std::vector<Hexahedron> hexahedra;
  for (const Index e : elements) hexahedra.push_back(frame.hexahedra[e]);
  const ShownPoints shown(embedding.points, corners_of(hexahedra, frame.points.size()),
                          corners_of(embedding.tetrahedra, embedding.points.size()));
  for (Hexahedron& nodes : hexahedra)
    for (Index& v : nodes) v = shown.of_vertex[v];
  frame.hexahedra = std::move(hexahedra);
  frame.tetrahedra = embedding.tetrahedra;
  for (auto& corners : frame.tetrahedra)
    for (Index& p : corners) p = shown.of_embedded[p];
  interpolate(frame, shown, embedding.points);
  elements.insert(elements.end(), embedding.tetrahedron_element.begin(),
                  embedding.tetrahedron_element.end());
  copy(frame.cell_fields, elements);
}

void show_surface(Frame& frame, const Embedding& embedding) {
  const ShownPoints shown(embedding.points, std::vector<std::uint8_t>(frame.points.size()),
                          corners_of(embedding.triangles, embedding.points.size()));
  frame.hexahedra.clear();
  frame.tetrahedra.clear();
  frame.cells.clear();
  for (const auto& [a, b, c] : embedding.triangles)
    frame.cells.push_back({shown.of_embedded[a], shown.of_embedded[b], shown.of_embedded[c], none});
  interpolate(frame, shown, embedding.points);
  copy(frame.cell_fields, embedding.triangle_element);
  FrameField& cut = frame.cell_fields.emplace_back();
  cut.name = "cut";
  cut.ids.assign(embedding.is_laid_open.begin(), embedding.is_laid_open.end());
}

}  // namespace suture
