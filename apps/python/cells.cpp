// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/python/cells.hpp"

#include <algorithm>

#include "kernel/forces/quad.hpp"
#include "kernel/mesh/vtk_order.hpp"

namespace suture::python {
namespace {

using Numbers = py::array_t<std::int64_t>;

Numbers table(std::size_t rows, std::size_t columns) {
  return Numbers({static_cast<py::ssize_t>(rows), static_cast<py::ssize_t>(columns)});
}

}  // namespace

py::array point_ids(const BuiltScene& built) {
  const auto& point = built.body().user_vertex();
  Numbers ids(static_cast<py::ssize_t>(point.size()));
  for (std::size_t v = 0; v < point.size(); ++v)
    ids.mutable_data()[v] = static_cast<std::int64_t>(built.names().point_id(point[v]));
  return ids;
}

py::array element_ids(const BuiltScene& built) {
  const Index count = built.body().complex().element_count();
  Numbers ids(static_cast<py::ssize_t>(count));
  for (Index e = 0; e < count; ++e)
    ids.mutable_data()[e] = static_cast<std::int64_t>(built.element_name(e));
  return ids;
}

py::array exists(const BuiltScene& built, int dimension) {
  const CellComplex& complex = built.body().complex();
  py::array_t<bool> mask(static_cast<py::ssize_t>(complex.count(dimension)));
  for (Index c = 0; c < complex.count(dimension); ++c)
    mask.mutable_data()[c] = complex.exists(dimension, c);
  return mask;
}

py::array hexahedra(const BuiltScene& built) {
  const CellComplex& complex = built.body().complex();
  Numbers rows = table(complex.existing(3), 8);
  std::int64_t* to = rows.mutable_data();
  for (Index e = 0; e < complex.element_count(); ++e) {
    if (!complex.exists(3, e)) continue;
    const Hexahedron nodes = swap_vtk_order(complex.vertices_of(e));
    to = std::copy(nodes.begin(), nodes.end(), to);
  }
  return rows;
}

py::tuple boundary(const BuiltScene& built) {
  const CellComplex& complex = built.body().complex();
  std::vector<Dart> faces;
  for (Index e = 0; e < complex.element_count(); ++e)
    for (const Dart face : sides_of(e))
      if (complex.exists(3, e) && complex.beta3(face) == none) faces.push_back(face);
  Numbers rows = table(faces.size(), 4), elements(static_cast<py::ssize_t>(faces.size()));
  std::int64_t *to = rows.mutable_data(), *element = elements.mutable_data();
  for (const Dart face : faces) {
    const std::array<Index, 4> inward = face_nodes(complex, face);
    to = std::copy(inward.rbegin(), inward.rend(), to);
    *element++ = element_of(face);
  }
  return py::make_tuple(rows, elements);
}

namespace {

/// `cells` of the complex that exist and whose places in the mesh belong to a set, for each set.
template <class PlaceOf>
py::dict sets_of(const std::map<std::string, std::vector<Index>>& sets, std::size_t places,
                 const CellComplex& complex, int dimension, PlaceOf place_of) {
  py::dict found;
  for (const auto& [name, members] : sets) {
    std::vector<bool> is_member(places, false);
    for (const Index place : members) is_member[place] = true;
    std::vector<std::int64_t> cells;
    for (Index c = 0; c < complex.count(dimension); ++c)
      if (complex.exists(dimension, c) && is_member[place_of(c)]) cells.push_back(c);
    found[py::str(name)] = Numbers(static_cast<py::ssize_t>(cells.size()), cells.data());
  }
  return found;
}

}  // namespace

py::tuple sets(const BuiltScene& built) {
  const Body& body = built.body();
  const MeshNames& names = built.names();
  return py::make_tuple(sets_of(names.point_sets, names.point_count, body.complex(), 0,
                                [&](Index v) { return body.user_vertex()[v]; }),
                        sets_of(names.element_sets, names.element_count, body.complex(), 3,
                                [&](Index e) { return body.imported().user_element[e]; }));
}

py::object embedded_surface(BuiltScene& built) {
  if (built.parts().empty()) return py::none();
  const Embedding& embedding = built.embedding();
  const std::size_t count = embedding.triangles.size(), points = embedding.points.size();
  Numbers triangles = table(count, 3), elements(static_cast<py::ssize_t>(count)),
          cuts(static_cast<py::ssize_t>(count)), vertices = table(points, 8);
  py::array_t<bool> is_laid_open(static_cast<py::ssize_t>(count));
  py::array_t<double> weights({static_cast<py::ssize_t>(points), py::ssize_t{8}});
  for (std::size_t t = 0; t < count; ++t)
    std::ranges::copy(embedding.triangles[t], triangles.mutable_data() + 3 * t);
  std::ranges::copy(embedding.triangle_element, elements.mutable_data());
  std::ranges::copy(embedding.is_laid_open, is_laid_open.mutable_data());
  std::ranges::transform(built.embedded_parts().cuts(built.body().complex()), cuts.mutable_data(),
                         [](Index cut) { return cut == none ? -1 : std::int64_t{cut}; });
  for (std::size_t p = 0; p < points; ++p) {
    const Index first = embedding.points.first[p], end = embedding.points.first[p + 1];
    for (Index i = 0; i < 8; ++i) {
      const bool is_used = first + i < end;
      vertices.mutable_data()[8 * p + i] = embedding.points.vertices[is_used ? first + i : first];
      weights.mutable_data()[8 * p + i] = is_used ? embedding.points.weights[first + i] : 0;
    }
  }
  return py::make_tuple(triangles, elements, is_laid_open, cuts, vertices, weights);
}

py::array named(const BuiltScene& built, const std::vector<std::array<Index, 2>>& pairs) {
  Numbers rows = table(pairs.size(), 2);
  std::int64_t* to = rows.mutable_data();
  for (const auto& pair : pairs)
    for (const Index e : pair) *to++ = static_cast<std::int64_t>(built.element_name(e));
  return rows;
}

}  // namespace suture::python
