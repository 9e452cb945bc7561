// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/python/given_mesh.hpp"

#include <algorithm>

#include "kernel/mesh/vtk_order.hpp"

namespace suture::python {
namespace {

namespace py = pybind11;
using GivenNumbers = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;
using Values = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::map<std::string, std::vector<Index>> sets_of(const py::dict& sets) {
  std::map<std::string, std::vector<Index>> result;
  for (const auto& [name, cells] : sets) {
    const auto numbers = py::cast<GivenNumbers>(cells);
    auto& list = result[py::cast<std::string>(name)];
    std::transform(numbers.data(), numbers.data() + numbers.size(), std::back_inserter(list),
                   [](std::int64_t number) { return static_cast<Index>(number); });
  }
  return result;
}

void add_arrays(const py::dict& arrays, bool of_elements, Mesh& mesh) {
  for (const auto& [name, values] : arrays) {
    const auto numbers = py::cast<Values>(values);
    MeshArray& array = mesh.arrays.emplace_back();
    array.name = py::cast<std::string>(name);
    array.of_elements = of_elements;
    array.components = numbers.ndim() == 2 ? static_cast<std::size_t>(numbers.shape(1)) : 1;
    array.values.assign(numbers.data(), numbers.data() + numbers.size());
  }
}

}  // namespace

std::shared_ptr<const Mesh> mesh_of(const py::object& given) {
  if (given.is_none()) return nullptr;
  auto mesh = std::make_shared<Mesh>();
  mesh->source = "arrays";
  const auto points = py::cast<Values>(given.attr("points"));
  mesh->points.resize(static_cast<std::size_t>(points.shape(0)));
  for (std::size_t i = 0; i < mesh->points.size(); ++i)
    std::copy_n(points.data() + 3 * i, 3, mesh->points[i].begin());
  const auto hexahedra = py::cast<GivenNumbers>(given.attr("hexahedra"));
  mesh->hexahedra.resize(static_cast<std::size_t>(hexahedra.shape(0)));
  for (std::size_t e = 0; e < mesh->hexahedra.size(); ++e) {
    Hexahedron nodes;
    for (std::size_t k = 0; k < 8; ++k) nodes[k] = static_cast<Index>(hexahedra.data()[8 * e + k]);
    mesh->hexahedra[e] = swap_vtk_order(nodes);
  }
  mesh->point_sets = sets_of(given.attr("point_sets"));
  mesh->element_sets = sets_of(given.attr("element_sets"));
  add_arrays(given.attr("point_arrays"), false, *mesh);
  add_arrays(given.attr("element_arrays"), true, *mesh);
  return mesh;
}

}  // namespace suture::python
