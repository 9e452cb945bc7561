// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/live/shown_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace suture {
namespace {

/// The number that stands for the components of one cell.
double scalar_of(const double* value, bool is_scalar) {
  if (is_scalar) return value[0];
  return std::sqrt(value[0] * value[0] + value[1] * value[1] + value[2] * value[2]);
}
double scalar_of(const FrameField& field, std::size_t i) {
  if (!field.ids.empty()) return static_cast<double>(field.ids[i]);
  return scalar_of(field.values.data() + i * static_cast<std::size_t>(field.components),
                   field.components == 1 || field.principal);
}

}  // namespace

std::vector<FieldChoice> shown_fields(BuiltScene& built) {
  std::vector<FieldChoice> fields = all_fields(built);
  std::erase_if(fields, [](const FieldChoice& field) {
    return !is_in_frames(field) || field.needs_force ||
           (field.components != 1 && field.components != 3) || field.name == "node_id" ||
           field.name == "element_id";
  });
  return fields;
}

ShownSurface::ShownSurface(BuiltScene& built) : built_(built), boundary_(built.body().complex()) {
  const CellComplex& complex = built.body().complex();
  was_boundary_.resize(std::size_t{6} * complex.element_count());
  for (const Index face : boundary_.faces()) was_boundary_[face] = true;
  built.body().add_follower(*this);
}

std::uint64_t ShownSurface::number() {
  if (is_current_) return number_;
  corners_.clear();
  inside_.clear();
  if (built_.parts().empty())
    find_boundary();
  else
    find_embedded();
  corners_.insert(corners_.end(), inside_.begin(), inside_.end());
  laid_open_ = inside_.size() / corners_per_face();
  compress();
  is_current_ = true;
  return ++number_;
}

void ShownSurface::follow(const CellComplex& complex, const TopologyChange& change) {
  boundary_.follow(complex, change);
  is_current_ = false;
}

void ShownSurface::find_again() {
  boundary_ = BoundarySurface(built_.body().complex());
  is_current_ = false;
}

template <std::size_t N>
void ShownSurface::add_face(const std::array<Index, N>& corners, bool is_laid_open) {
  std::vector<Index>& list = is_laid_open ? inside_ : corners_;
  list.insert(list.end(), corners.begin(), corners.end());
}

void ShownSurface::find_boundary() {
  for (std::size_t i = 0; i < boundary_.faces().size(); ++i) {
    const Index face = boundary_.faces()[i];
    add_face(boundary_.corners()[i], face >= was_boundary_.size() || !was_boundary_[face]);
  }
}

/// Embedded points have numbers behind those of the vertices.
void ShownSurface::find_embedded() {
  const Embedding& embedding = built_.embedding();
  const Index first = built_.body().complex().count(0);
  const auto place = [&](Index p) {
    const Index v = embedding.points.vertex(p);
    return v == none ? first + p : v;
  };
  for (std::size_t i = 0; i < embedding.triangles.size(); ++i) {
    const auto& t = embedding.triangles[i];
    add_face(std::array{place(t[0]), place(t[1]), place(t[2])}, embedding.is_laid_open[i] != 0);
  }
}

/// From numbers of vertices and embedded points to places in the list of points.
void ShownSurface::compress() {
  const std::size_t vertex_count = built_.body().complex().count(0);
  std::vector<Index> place(vertex_count + built_.embedding().points.size(), none);
  for (const Index corner : corners_) place[corner] = 0;
  vertices_.clear();
  embedded_.clear();
  Index next = 0;
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (place[i] == none) continue;
    place[i] = next++;
    if (i < vertex_count)
      vertices_.push_back(static_cast<Index>(i));
    else
      embedded_.push_back(static_cast<Index>(i - vertex_count));
  }
  for (Index& corner : corners_) corner = place[corner];
}

void ShownSurface::append_positions(std::vector<float>& out) const {
  append(built_.body().attributes().position(), out);
}

void ShownSurface::append_rest(std::vector<float>& out) const {
  append(built_.body().attributes().rest(), out);
}

void ShownSurface::append(const Column& places, std::vector<float>& out) const {
  const double* rows = places.rows();
  for (const Index v : vertices_)
    for (std::size_t c = 0; c < 3; ++c) out.push_back(static_cast<float>(rows[4 * v + c]));
  if (embedded_.empty()) return;
  const EmbeddedPoints& points = built_.embedding().points;
  for (const Index p : embedded_)
    for (std::size_t c = 0; c < 3; ++c)
      out.push_back(static_cast<float>(points.value(p, rows, 4, c)));
}

std::vector<double> ShownSurface::at_vertices(const FieldChoice& field,
                                              const FrameField& values) const {
  const CellComplex& complex = built_.body().complex();
  std::vector<double> mean(complex.count(0));
  if (field.on == FieldChoice::On::points) {
    for (std::size_t v = 0; v < mean.size(); ++v) mean[v] = scalar_of(values, v);
    return mean;
  }
  std::vector<Index> counts(mean.size());
  for (Index e = 0; e < complex.element_count(); ++e) {
    if (!complex.exists(3, e)) continue;
    const double value = scalar_of(values, e);
    if (!std::isfinite(value)) continue;
    for (const Index v : complex.vertices()[e]) {
      mean[v] += value;
      ++counts[v];
    }
  }
  for (std::size_t v = 0; v < mean.size(); ++v)
    mean[v] = counts[v] > 0 ? mean[v] / counts[v] : std::numeric_limits<double>::quiet_NaN();
  return mean;
}

void ShownSurface::append_values(const FieldChoice& field, const Vec3& gravity, double time,
                                 std::vector<float>& out) {
  if (field.on == FieldChoice::On::points && field.value && embedded_.empty()) {
    std::array<double, 3> value;
    for (const Index v : vertices_) {
      for (int c = 0; c < field.components; ++c)
        value[static_cast<std::size_t>(c)] = field.value(built_, gravity, v, c);
      out.push_back(
          static_cast<float>(scalar_of(value.data(), field.components == 1 || field.principal)));
    }
    return;
  }
  FrameField values;
  field.fill({built_, gravity, time}, values);
  const std::vector<double> mean = at_vertices(field, values);
  for (const Index v : vertices_) out.push_back(static_cast<float>(mean[v]));
  for (const Index p : embedded_)
    out.push_back(static_cast<float>(built_.embedding().points.value(p, mean.data(), 1, 0)));
}

}  // namespace suture
