// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/gradients/rest_slopes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "kernel/base/aligned.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/gradients/element_colours.hpp"
#include "kernel/gradients/total_forces.hpp"
#include "kernel/solvers/conjugate_gradients.hpp"

namespace suture {
namespace {

// A step as a part of the shortest edge: the error of central differences is least there.
constexpr double relative_step = 1e-5;

// What may be missing, as a part of the sum of absolute values over vertices.
constexpr double uncovered_part = 1e-6;

std::vector<Index> live_elements(const CellSet& cells) {
  std::vector<Index> elements;
  for (Index row = 0; row < cells.size(); ++row)
    if (cells.is_live(row)) elements.push_back(cells.cell(row));
  std::ranges::sort(elements);
  return elements;
}

/// The values of all columns but those that are computed from elements; their rows may differ.
void copy_values(const Instance& from, Instance& to) {
  for (std::uint32_t a = 0; a < to.model().attribute_count; ++a) {
    const Column* const source = from.column(a);
    Column* const column = to.column(a);
    if (source == nullptr || column == nullptr || source->spec().policy == SUTURE_FROM_VOLUMES)
      continue;
    const CellSet &cells = to.table(column->dimension()).cells,
                  &theirs = from.table(column->dimension()).cells;
    for (Index row = 0; row < cells.size(); ++row)
      for (int c = 0; c < column->spec().components; ++c)
        column->set(row, c, source->get(theirs.row(cells.cell(row)), c));
  }
}

/// The models of a body with other rest positions, at its current positions.
class Rebuilt {
 public:
  Rebuilt(Body& body, std::span<const Vec3> rest) : attributes_(body.complex(), rest) {
    CellComplex& complex = body.complex();
    Diagnostics known;
    for (const auto& instance : body.attributes().instances()) {
      auto copy = std::make_unique<Instance>(
          instance->model(), instance->name(),
          std::vector<double>(instance->parameters().begin(), instance->parameters().end()), known,
          instance->skips());
      copy_values(*instance, attributes_.add(std::move(copy), complex,
                                             live_elements(instance->table(3).cells)));
    }
    attributes_.user_element = body.attributes().user_element;
    attributes_.initialise(complex, known);
    const double* x = body.attributes().position().rows();
    std::copy_n(x, std::size_t{attributes_.vertex_count()} * 4, attributes_.position().rows());
    models_ = std::make_unique<ForceLoop>(attributes_, complex, 1);
  }

  /// The forces of the models and of gravity, 3 numbers per vertex.
  std::vector<double> forces(double time, const Vec3& gravity) {
    AlignedVector<double> rows(std::size_t{attributes_.vertex_count()} * 4);
    models_->add_forces(time, 0, ForceLoop::Part::all, rows.data());
    return with_weight(rows.data(), attributes_, gravity);
  }
  double energy(double time) { return models_->energy(time); }

 private:
  Attributes attributes_;
  std::unique_ptr<ForceLoop> models_;
};

void require_plain_rest(const Body& body) {
  const Attributes& attributes = body.attributes();
  if (!attributes.parts().empty())
    throw InputError(
        "there is no derivative by rest positions: elements of which only a part is material stay "
        "on their grid");
  if (!attributes.rest_places(body.complex()).own().empty())
    throw InputError(
        "there is no derivative by rest positions: elements around a seam have rest positions of "
        "their own");
}

/// The rest positions, moved along a direction.
std::vector<Vec3> moved_rest(const Column& rest, std::span<const double> direction, double way) {
  std::vector<Vec3> places;
  for (Index v = 0; v < rest.size(); ++v) {
    const double* d = direction.data() + std::size_t{v} * 3;
    places.push_back(plus({rest.get(v, 0), rest.get(v, 1), rest.get(v, 2)},
                          {way * d[0], way * d[1], way * d[2]}));
  }
  return places;
}

/// In a direction in which every vertex moves.
void require_sum(Body& body, double time, const std::vector<double>& multipliers,
                 const std::vector<double>& slopes) {
  std::vector<double> direction(slopes.size());
  double size = 0;
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    direction[i] = std::sin(static_cast<double>(i) + 1);
    size += std::abs(slopes[i] * direction[i]);
  }
  const double whole = dot(multipliers, rest_slope(body, time, direction).forces);
  if (std::abs(whole - dot(slopes, direction)) <= uncovered_part * size) return;
  throw InputError(
      "there is no derivative by the rest position of each vertex: forces depend on more than the "
      "elements around them; take the derivative along a direction (along_rest)");
}

}  // namespace

double shortest_edge(const Body& body) {
  const RestPlaces rest = body.attributes().rest_places(body.complex());
  double least = std::numeric_limits<double>::infinity();
  for (Index e = 0; e < body.complex().element_count(); ++e)
    for (std::size_t node = 1; node < hexahedron::vertices && body.complex().exists(3, e);
         node *= 2) {
      const double *a = rest.corner(e, 0), *b = rest.corner(e, node);
      least = std::min(least, std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]));
    }
  return least;
}

RestSlope rest_slope(Body& body, double time, std::span<const double> direction) {
  require_plain_rest(body);
  const Column& rest = body.attributes().rest();
  const double largest =
      std::abs(*std::ranges::max_element(direction, {}, [](double d) { return std::abs(d); }));
  if (largest == 0) return {std::vector<double>(direction.size()), 0};
  const double step = relative_step * shortest_edge(body) / largest;
  const Vec3 gravity = body.acceleration(time);
  const auto at = [&](double way) {
    Rebuilt models(body, moved_rest(rest, direction, way));
    return RestSlope{models.forces(time, gravity), models.energy(time)};
  };
  RestSlope up = at(step);
  const RestSlope down = at(-step);
  for (std::size_t i = 0; i < up.forces.size(); ++i)
    up.forces[i] = (up.forces[i] - down.forces[i]) / (2 * step);
  up.energy = (up.energy - down.energy) / (2 * step);
  return up;
}

std::vector<double> rest_slopes(Body& body, double time, const std::vector<double>& multipliers) {
  require_plain_rest(body);
  const Column& rest = body.attributes().rest();
  const double step = relative_step * shortest_edge(body);
  const Vec3 gravity = body.acceleration(time);
  const std::vector<std::vector<Index>> stars = stars_of(body.complex());
  std::vector<double> slopes(multipliers.size());
  for (const std::vector<Index>& group : colour_stars(stars))
    for (std::size_t c = 0; c < 3; ++c) {
      std::vector<double> direction(slopes.size());
      for (const Index v : group) direction[std::size_t{v} * 3 + c] = 1;
      const auto forces = [&](double way) {
        return Rebuilt(body, moved_rest(rest, direction, way)).forces(time, gravity);
      };
      const std::vector<double> up = forces(step), down = forces(-step);
      for (const Index v : group)
        for (const Index u : stars[v])
          for (std::size_t i = std::size_t{u} * 3; i < std::size_t{u} * 3 + 3; ++i)
            slopes[std::size_t{v} * 3 + c] += multipliers[i] * (up[i] - down[i]) / (2 * step);
    }
  require_sum(body, time, multipliers, slopes);
  return slopes;
}

}  // namespace suture
