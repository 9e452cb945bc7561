// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/parts/plane_parts.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernel/base/vec3.hpp"
#include "kernel/parts/embedding.hpp"
#include "kernel/parts/general_part.hpp"
#include "kernel/parts/moments.hpp"

namespace parts_test {
namespace {

using suture::dot;
using suture::minus;

Vec3 on_edge(const Vec3& a, const Vec3& b, double at_a, double at_b) {
  const double t = at_a / (at_a - at_b);
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

/// Appends the tetrahedra of a wedge with the triangles 0 1 2 and 3 4 5.
void add_wedge(const std::array<Vec3, 6>& w, std::vector<Tetrahedron>& out) {
  out.push_back({w[0], w[1], w[2], w[3]});
  out.push_back({w[1], w[2], w[3], w[4]});
  out.push_back({w[2], w[3], w[4], w[5]});
}

void clip(const Tetrahedron& t, const Level& level, std::vector<Tetrahedron>& out) {
  std::vector<std::size_t> in, off;
  double at[4];
  for (std::size_t i = 0; i < 4; ++i)
    (at[i] = level(t[i])) < 0 ? in.push_back(i) : off.push_back(i);
  const auto edge = [&](std::size_t i, std::size_t j) {
    return on_edge(t[in[i]], t[off[j]], at[in[i]], at[off[j]]);
  };
  if (in.size() == 4) out.push_back(t);
  if (in.size() == 1) out.push_back({t[in[0]], edge(0, 0), edge(0, 1), edge(0, 2)});
  if (in.size() == 2)
    add_wedge({t[in[0]], edge(0, 0), edge(0, 1), t[in[1]], edge(1, 0), edge(1, 1)}, out);
  if (in.size() == 3)
    add_wedge({t[in[0]], t[in[1]], t[in[2]], edge(0, 0), edge(1, 0), edge(2, 0)}, out);
}

std::vector<Tetrahedron> kuhn() {
  std::vector<Tetrahedron> cube;
  std::array<std::size_t, 3> axes{0, 1, 2};
  do {
    Tetrahedron t;
    t[0] = {-1, -1, -1};
    for (std::size_t i = 0; i < 3; ++i) (t[i + 1] = t[i])[axes[i]] = 1;
    cube.push_back(t);
  } while (std::ranges::next_permutation(axes).found);
  return cube;
}

double shape_gradient(const Vec3& x, int node, std::size_t axis) {
  double product = 0.125;
  for (std::size_t a = 0; a < 3; ++a) {
    const double sign = node >> a & 1 ? 1 : -1;
    product *= a == axis ? sign : 1 + sign * x[a];
  }
  return product;
}

}  // namespace

Level half_space(const Vec3& normal, const Vec3& point) {
  return [=](const Vec3& x) { return dot(normal, minus(x, point)); };
}

std::vector<Tetrahedron> clipped_cube(std::span<const Level> levels) {
  std::vector<Tetrahedron> part = kuhn();
  for (const Level& level : levels) {
    std::vector<Tetrahedron> kept;
    for (const Tetrahedron& t : part) clip(t, level, kept);
    part = std::move(kept);
  }
  return part;
}

double volume(const Tetrahedron& t) { return std::abs(suture::six_volumes(t)) / 6; }

PartMoments moments_of(std::span<const Tetrahedron> part) {
  suture::MomentSum sum;
  for (Tetrahedron t : part) {
    if (suture::six_volumes(t) < 0) std::swap(t[0], t[1]);
    sum.add(t);
  }
  return sum.moments();
}

Vec3 gradient_integral(std::span<const Tetrahedron> part, int node) {
  const double near = (5 - std::sqrt(5)) / 20, far = (5 + 3 * std::sqrt(5)) / 20;
  Vec3 sum{};
  for (const Tetrahedron& t : part)
    for (std::size_t q = 0; q < 4; ++q) {
      Vec3 x{};
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t a = 0; a < 3; ++a) x[a] += (i == q ? far : near) * t[i][a];
      for (std::size_t a = 0; a < 3; ++a) sum[a] += volume(t) / 4 * shape_gradient(x, node, a);
    }
  return sum;
}

std::vector<Level> local_levels(std::span<const Level> levels, const Vec3& low, const Vec3& size) {
  std::vector<Level> local;
  for (const Level& level : levels)
    local.push_back([&level, low, size](const Vec3& x) {
      return level({low[0] + (x[0] + 1) / 2 * size[0], low[1] + (x[1] + 1) / 2 * size[1],
                    low[2] + (x[2] + 1) / 2 * size[2]});
    });
  return local;
}

Mesh cut_box(const suture::BoxOptions& box, std::span<const Level> levels) {
  Mesh mesh = suture::make_box(box);
  std::vector<suture::Hexahedron> kept;
  for (const suture::Hexahedron& nodes : mesh.hexahedra) {
    const Vec3 low = mesh.points[nodes[0]], size = minus(mesh.points[nodes[7]], low);
    const std::vector<Tetrahedron> part = clipped_cube(local_levels(levels, low, size));
    const PartMoments moments = moments_of(part);
    if (part.empty() || moments.fraction < 1e-18) continue;
    if (moments.fraction < 1 - 1e-12) {
      mesh.parts.elements.push_back(static_cast<Index>(kept.size()));
      mesh.parts.moments.push_back(moments);
    }
    kept.push_back(nodes);
  }
  mesh.hexahedra = std::move(kept);
  return mesh;
}

Mesh cut_mesh(Mesh mesh, std::span<const Level> levels) {
  std::vector<suture::Hexahedron> kept;
  mesh.parts.first.push_back(0);
  for (const suture::Hexahedron& nodes : mesh.hexahedra) {
    std::vector<Level> local;
    for (const Level& level : levels)
      local.push_back([&](const Vec3& at) {
        return level(suture::place_in(nodes, at, mesh.points[0].data(), 3));
      });
    const std::vector<Tetrahedron> part = clipped_cube(local);
    const PartMoments moments = moments_of(part);
    if (part.empty() || moments.fraction < 1e-18) continue;
    const auto element = static_cast<Index>(kept.size());
    kept.push_back(nodes);
    if (moments.fraction > 1 - 1e-12) continue;
    suture::Parts& parts = mesh.parts;
    for (Tetrahedron t : part) {
      if (suture::six_volumes(t) < 0) std::swap(t[0], t[1]);
      const auto first = static_cast<Index>(parts.points.size());
      for (const Vec3& at : t) parts.points.push_back({element, at});
      parts.tetrahedra.push_back({first, first + 1, first + 2, first + 3});
    }
    parts.elements.push_back(element);
    parts.moments.push_back(moments);
    parts.first.push_back(static_cast<Index>(parts.tetrahedra.size()));
    std::array<Vec3, 8> corners;
    for (std::size_t n = 0; n < 8; ++n) corners[n] = mesh.points[nodes[n]];
    parts.general.push_back(general_part(parts, parts.elements.size() - 1, corners));
  }
  mesh.hexahedra = std::move(kept);
  return mesh;
}

Mesh warped(Mesh mesh, double most) {
  const auto [first, last] =
      std::ranges::minmax(mesh.points, {}, [](const Vec3& x) { return x[0]; });
  std::mt19937_64 random(17);
  for (Vec3& x : mesh.points) {
    const bool is_end = x[0] == first[0] || x[0] == last[0];
    for (std::size_t a = is_end ? 1 : 0; a < 3; ++a) x[a] += between(random, -most, most);
  }
  return mesh;
}

double volume(const Mesh& mesh) {
  double sum = 0;
  std::size_t next = 0;
  for (Index e = 0; e < mesh.hexahedra.size(); ++e) {
    const suture::Hexahedron& nodes = mesh.hexahedra[e];
    const Vec3 size = minus(mesh.points[nodes[7]], mesh.points[nodes[0]]);
    const bool is_part = next < mesh.parts.elements.size() && mesh.parts.elements[next] == e;
    sum += (is_part ? mesh.parts.moments[next++].fraction : 1) * size[0] * size[1] * size[2];
  }
  return sum;
}

double between(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

Level random_plane(std::mt19937_64& random, const Vec3& size) {
  Vec3 normal, point;
  for (std::size_t a = 0; a < 3; ++a) {
    normal[a] = between(random, -1, 1);
    point[a] = between(random, 0, size[a]);
  }
  return half_space(normal, point);
}

}  // namespace parts_test
