// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/topology/cgal_map.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Linear_cell_complex_for_combinatorial_map.h>

#include <algorithm>
#include <map>
#include <stdexcept>

namespace suture {
namespace {

struct Items {
  template <class Refs>
  struct Dart_wrapper {
    using Dart_info = std::uint32_t;
    using Vertex = CGAL::Cell_attribute_with_point<Refs>;
    using Attributes = std::tuple<Vertex>;
  };
};

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Complex = CGAL::Linear_cell_complex_for_combinatorial_map<
    3, 3, CGAL::Linear_cell_complex_traits<3, Kernel>, Items>;
using Handle = Complex::Dart_handle;

/// The first darts of the six faces, from the one that make_hexahedron returns.
std::array<Handle, 6> faces_of(Complex& complex, Handle d1) {
  std::array<Handle, 6> f;
  f[0] = d1;
  for (int j = 1; j < 4; ++j) f[j] = complex.beta(f[j - 1], 1, 1, 2);
  f[4] = complex.beta(f[0], 0, 2);
  f[5] = complex.beta(f[3], 1, 2);
  return f;
}

}  // namespace

struct CgalMap::Impl {
  mutable Complex complex;
  std::vector<Handle> darts;

  /// With the corners X0..X7.
  void add_element(const std::array<Complex::Point, 8>& x) {
    for (Handle d :
         faces_of(complex, complex.make_hexahedron(x[2], x[0], x[1], x[3], x[7], x[6], x[4], x[5])))
      for (int k = 0; k < 4; ++k, d = complex.beta(d, 1)) {
        complex.info(d) = static_cast<Dart>(darts.size());
        darts.push_back(d);
      }
  }

  template <class Darts>
  void give(Darts range, std::vector<Dart>& smallest) const {
    Dart low = none;
    for (auto it = range.begin(); it != range.end(); ++it) low = std::min(low, complex.info(it));
    for (auto it = range.begin(); it != range.end(); ++it) smallest[complex.info(it)] = low;
  }
};

CgalMap::CgalMap(const Mesh& mesh) : impl_(std::make_unique<Impl>()) {
  Complex& complex = impl_->complex;
  std::map<std::array<Index, 4>, Dart> open;  // points of a face, sorted
  std::vector<Index> origin;
  for (const Hexahedron& h : mesh.hexahedra) {
    std::array<Complex::Point, 8> x;
    for (int i = 0; i < 8; ++i) {
      const Vec3& p = mesh.points[h[i]];
      x[i] = Complex::Point(p[0], p[1], p[2]);
    }
    const auto begin = static_cast<Dart>(impl_->darts.size());
    impl_->add_element(x);
    for (Dart first = begin; first < begin + 24; first += 4) {
      std::array<Index, 4> points;
      for (int k = 0; k < 4; ++k) {
        const Handle d = impl_->darts[first + k];
        const auto corner = std::ranges::find_if(h, [&](Index v) {
          return Complex::Point(mesh.points[v][0], mesh.points[v][1], mesh.points[v][2]) ==
                 complex.point(d);
        });
        points[k] = *corner;
        origin.push_back(*corner);
      }
      std::ranges::sort(points);
      const auto [it, fresh] = open.try_emplace(points, first);
      if (fresh) continue;
      for (Dart k = 0; k < 4; ++k)  // the dart there that runs the other way
        if (origin[it->second + k] == origin[first + 1] &&
            origin[it->second + (k + 1) % 4] == origin[first]) {
          if (!complex.is_sewable<3>(impl_->darts[first], impl_->darts[it->second + k]))
            throw std::logic_error("not sewable");
          complex.sew<3>(impl_->darts[first], impl_->darts[it->second + k]);
        }
      open.erase(it);
    }
  }
}

CgalMap::~CgalMap() = default;

void CgalMap::cut(const std::vector<Dart>& faces) {
  for (const Dart d : faces) impl_->complex.unsew<3>(impl_->darts[d]);
}

void CgalMap::pierce(const std::vector<Index>& elements) {
  for (const Index e : elements) {
    impl_->complex.remove_cell<3>(impl_->darts[24 * e]);
    std::fill_n(impl_->darts.begin() + 24 * std::ptrdiff_t(e), 24, nullptr);
  }
}

void CgalMap::sew(const std::vector<Seam>& seams) {
  for (const auto& [one, other] : seams) {
    if (!impl_->complex.is_sewable<3>(impl_->darts[one], impl_->darts[other]))
      throw std::logic_error("not sewable");
    impl_->complex.sew<3>(impl_->darts[one], impl_->darts[other]);
  }
}

void CgalMap::clone(const Cloning& cloning) {
  for (const Index e : cloning.origins) {
    std::array<Complex::Point, 8> x;
    for (Dart d = 0; d < 24; ++d)
      x[hexahedron::dart_vertex[d]] = impl_->complex.point(impl_->darts[24 * e + d]);
    impl_->add_element(x);
  }
  cut(cloning.cut);
  std::vector<Index> originals = cloning.origins;
  originals.erase(std::unique(originals.begin(), originals.end()), originals.end());
  pierce(originals);
  for (const Split& absorbed : cloning.absorbed) pierce({absorbed.old_cell});
  sew(cloning.seams);
}

bool CgalMap::folds(const std::vector<Seam>& seams) {
  // Darts only: CGAL 5.5 does not find its own points valid after such a sew and unsew.
  for (const auto& [one, other] : seams)
    impl_->complex.topo_sew<3>(impl_->darts[one], impl_->darts[other]);
  const std::vector<Dart> vertex = orbits(0);
  bool result = false;
  for (std::size_t element = 0; element < vertex.size(); element += 24) {
    if (vertex[element] == none) continue;
    std::vector<Dart> corners(vertex.begin() + std::ptrdiff_t(element),
                              vertex.begin() + std::ptrdiff_t(element) + 24);
    std::ranges::sort(corners);
    result |= std::unique(corners.begin(), corners.end()) - corners.begin() < 8;
  }
  for (const Seam& seam : seams) impl_->complex.topo_unsew<3>(impl_->darts[seam.one]);
  return result;
}

std::vector<Dart> CgalMap::orbits(int dimension) const {
  Complex& c = impl_->complex;
  std::vector<Dart> smallest(impl_->darts.size(), none);
  for (std::size_t d = 0; d < smallest.size(); ++d) {
    if (smallest[d] != none || impl_->darts[d] == nullptr) continue;
    const Handle h = impl_->darts[d];
    switch (dimension) {
      case 0:
        impl_->give(c.darts_of_cell<0>(h), smallest);
        break;
      case 1:
        impl_->give(c.darts_of_cell<1>(h), smallest);
        break;
      case 2:
        impl_->give(c.darts_of_cell<2>(h), smallest);
        break;
      case 3:
        impl_->give(c.darts_of_cell<3>(h), smallest);
        break;
      default:
        impl_->give(c.darts_of_orbit<1, 2, 3>(h), smallest);
    }
  }
  return smallest;
}

bool CgalMap::is_valid() const { return impl_->complex.is_valid(); }

}  // namespace suture
