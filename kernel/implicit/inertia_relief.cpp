// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/implicit/inertia_relief.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <span>

#include "kernel/attributes/held.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/dynamics/pieces.hpp"

namespace suture {
namespace {

using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;
using Row = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;

/// visit(component, mass, velocities there in all motions) for components that are not constrained.
template <class Visit>
void for_each_row(Body& body, const FreePiece& motions, std::span<const Index> vertices,
                  Visit visit) {
  Attributes& attributes = body.attributes();
  const auto& modes = motions.modes;
  Row row(static_cast<Eigen::Index>(modes.size()));
  for (const Index v : vertices) {
    const double* x = attributes.position().rows() + std::size_t{v} * 4;
    const Vec3 arm = minus(Vec3{x[0], x[1], x[2]}, motions.centre);
    const unsigned held = held_components(attributes, v);
    for (std::size_t c = 0; c < 3; ++c) {
      if (is_held(held, c)) continue;
      for (std::size_t m = 0; m < modes.size(); ++m)
        row[static_cast<Eigen::Index>(m)] =
            modes[m][c] +
            cross(Vec3{modes[m][3], modes[m][4], modes[m][5]}, arm)[c] / motions.radius;
      visit(std::size_t{v} * 3 + c, attributes.mass().get(v, 0), row);
    }
  }
}

/// a with R^T M R a = b.
Row solve_masses(Body& body, const FreePiece& motions, std::span<const Index> vertices,
                 const Row& b) {
  Small sum = Small::Zero(b.size(), b.size());
  for_each_row(body, motions, vertices, [&](std::size_t, double mass, const Row& row) {
    sum += mass * row * row.transpose();
  });
  return Eigen::LLT<Small>(sum).solve(b);
}

}  // namespace

void InertiaRelief::find() {
  pieces_.clear();
  supports_.clear();
  const Index vertices = body_.attributes().vertex_count();
  std::vector<std::size_t> place;  // by number of a piece
  for (FreePiece& found : find_unheld_pieces(body_)) {
    place.resize(std::max<std::size_t>(place.size(), found.number + 1), pieces_.size());
    place[found.number] = pieces_.size();
    pieces_.push_back({std::move(found), {}});
  }
  if (pieces_.empty()) return;
  const std::vector<Index> numbers = pieces_of(body_.complex(), body_.attributes());
  for (Index v = 0; v < vertices; ++v)
    if (numbers[v] < place.size() && pieces_[place[numbers[v]]].motions.number == numbers[v])
      pieces_[place[numbers[v]]].vertices.push_back(v);
  for (const Piece& piece : pieces_) add_supports(piece);
}

void InertiaRelief::balance(std::vector<double>& forces) const {
  for (const Piece& piece : pieces_) {
    Row resultant = Row::Zero(static_cast<Eigen::Index>(piece.motions.modes.size()));
    for_each_row(body_, piece.motions, piece.vertices,
                 [&](std::size_t i, double, const Row& row) { resultant += forces[i] * row; });
    const Row acceleration = solve_masses(body_, piece.motions, piece.vertices, resultant);
    for_each_row(body_, piece.motions, piece.vertices,
                 [&](std::size_t i, double mass, const Row& row) {
                   forces[i] -= mass * row.dot(acceleration);
                 });
  }
}

void InertiaRelief::remove_rigid_motion(std::vector<double>& direction) const {
  for (const Piece& piece : pieces_) {
    Row momentum = Row::Zero(static_cast<Eigen::Index>(piece.motions.modes.size()));
    for_each_row(
        body_, piece.motions, piece.vertices,
        [&](std::size_t i, double mass, const Row& row) { momentum += mass * direction[i] * row; });
    const Row velocity = solve_masses(body_, piece.motions, piece.vertices, momentum);
    for_each_row(body_, piece.motions, piece.vertices,
                 [&](std::size_t i, double, const Row& row) { direction[i] -= row.dot(velocity); });
  }
}

/// Gaussian elimination with the largest row as pivot: the components that resist the motions most.
void InertiaRelief::add_supports(const Piece& piece) {
  std::vector<Row> rows;
  std::vector<std::size_t> components;
  for_each_row(body_, piece.motions, piece.vertices, [&](std::size_t i, double, const Row& row) {
    rows.push_back(row);
    components.push_back(i);
  });
  for (std::size_t m = 0; m < piece.motions.modes.size(); ++m) {
    std::size_t pivot = 0;
    for (std::size_t i = 1; i < rows.size(); ++i)
      if (rows[i].squaredNorm() > rows[pivot].squaredNorm()) pivot = i;
    supports_.push_back(components[pivot]);
    const Row direction = rows[pivot].normalized();
    for (Row& row : rows) row -= row.dot(direction) * direction;
  }
}

}  // namespace suture
