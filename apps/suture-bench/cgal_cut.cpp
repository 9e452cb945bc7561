// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/cgal_cut.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Linear_cell_complex_for_combinatorial_map.h>

#include <algorithm>
#include <unordered_map>

namespace suture::bench {
namespace {

struct Items {
  template <class Refs>
  struct Dart_wrapper {
    using Vertex = CGAL::Cell_attribute_with_point<Refs>;
    using Cell = CGAL::Cell_attribute<Refs>;
    using Attributes = std::tuple<Vertex, Cell, Cell>;
  };
};

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Complex = CGAL::Linear_cell_complex_for_combinatorial_map<
    3, 3, CGAL::Linear_cell_complex_traits<3, Kernel>, Items>;
using Handle = Complex::Dart_handle;

/// An unordered set of four points, hashed by its sum.
using Face = std::array<Index, 4>;
struct Hash {
  std::size_t operator()(const Face& f) const {
    return (f[0] + std::size_t{f[1]} + f[2] + f[3]) * 0x9E3779B97F4A7C15u;
  }
};

}  // namespace

struct CgalCut::Impl {
  Complex complex;
  std::vector<Handle> faces;  ///< 6 e + f: the face's dart 24 e + 4 f

  template <int Dimension>
  void add_attributes() {
    for (auto d = complex.darts().begin(); d != complex.darts().end(); ++d)
      if (complex.attribute<Dimension>(d) == complex.null_handle)
        complex.set_attribute<Dimension>(d, complex.create_attribute<Dimension>());
  }
};

CgalCut::CgalCut(const Mesh& mesh) : impl_(std::make_unique<Impl>()) {
  Complex& complex = impl_->complex;
  std::unordered_map<Face, std::pair<Handle, Index>, Hash> open;  // dart, its first point
  for (const Hexahedron& h : mesh.hexahedra) {
    const auto x = [&](int i) {
      const Vec3& p = mesh.points[h[i]];
      return Complex::Point(p[0], p[1], p[2]);
    };
    std::array<Handle, 6> face;
    face[0] = complex.make_hexahedron(x(2), x(0), x(1), x(3), x(7), x(6), x(4), x(5));
    for (int j = 1; j < 4; ++j) face[j] = complex.beta(face[j - 1], 1, 1, 2);
    face[4] = complex.beta(face[0], 0, 2);
    face[5] = complex.beta(face[3], 1, 2);
    for (int f = 0; f < 6; ++f) {
      impl_->faces.push_back(face[f]);
      Face points;
      for (int k = 0; k < 4; ++k) points[k] = h[hexahedron::dart_vertex[4 * f + k]];
      const Index second = points[1];
      const Index first = points[0];
      std::ranges::sort(points);
      const auto [it, fresh] = open.try_emplace(points, face[f], first);
      if (fresh) continue;
      // The dart there that starts where ours ends.
      Handle there = it->second.first;
      const Complex::Point& end = complex.point(complex.beta(face[f], 1));
      if (it->second.second != second) do
          there = complex.beta(there, 1);
        while (complex.point(there) != end);
      complex.sew<3>(face[f], there);
      open.erase(it);
    }
  }
  impl_->add_attributes<1>();
  impl_->add_attributes<2>();
}

CgalCut::~CgalCut() = default;

void CgalCut::cut(const std::vector<Dart>& faces) {
  for (const Dart d : faces) impl_->complex.unsew<3>(impl_->faces[d / 4]);
}

}  // namespace suture::bench
