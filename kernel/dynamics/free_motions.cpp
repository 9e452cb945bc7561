// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/free_motions.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "kernel/base/vec3.hpp"
#include "kernel/dynamics/pieces.hpp"
#include "kernel/solvers/symmetric_eigen.hpp"

namespace suture {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double rank_tolerance = 1e-9;
constexpr double balanced = 1e-9;  // resultant over the sum of the forces

/// What is summed over the vertices of a piece.
struct Sums {
  FreePiece piece;
  Vec3 centre{};
  double vertices = 0, radius_squared = 0;
  Matrix6 normal = Matrix6::Zero();
};

Vec3 position_of(Attributes& attributes, Index vertex) {
  const double* row = attributes.position().rows() + std::size_t{vertex} * 4;
  return {row[0], row[1], row[2]};
}

/// Velocity of component c at `arm` from the centre in the six rigid motions.
Vector6 row_of(std::size_t c, const Vec3& arm, double radius) {
  Vector6 row = Vector6::Zero();
  row[static_cast<Eigen::Index>(c)] = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    Vec3 axis{};
    axis[a] = 1;
    row[static_cast<Eigen::Index>(3 + a)] = cross(axis, arm)[c] / radius;
  }
  return row;
}

void add_elements(const CellComplex& complex, Attributes& attributes,
                  const std::vector<Index>& pieces, std::vector<Sums>& sums) {
  const auto& users = attributes.user_element;
  for (Index e = 0; e < complex.element_count(); ++e) {
    if (!complex.exists(3, e)) continue;
    FreePiece& piece = sums[pieces[complex.vertices_of(e)[0]]].piece;
    ++piece.elements;
    piece.first_element = std::min(piece.first_element, users.empty() ? e : users[e]);
  }
}

/// Without the sign that nobody chose, and without rounding.
Vec3 tidy(Eigen::Vector3d axis) {
  Eigen::Index last = 2;
  while (last > 0 && std::abs(axis[last]) < 1e-9) --last;
  if (axis[last] < 0) axis = -axis;
  Vec3 result;
  for (Eigen::Index c = 0; c < 3; ++c)
    result[static_cast<std::size_t>(c)] = std::abs(axis[c]) < 1e-9 ? 0 : axis[c];
  return result;
}

/// Rotations about as many independent axes as the null space has: the principal ones of its
/// rotations T, eigenvectors of T T^T.
void find_motions(Sums& sums) {
  for (Eigen::Index c = 0; c < 3; ++c)
    sums.piece.translations[static_cast<std::size_t>(c)] = sums.normal(c, c) == 0;
  const SymmetricEigen normal = symmetric_eigen(sums.normal);
  const double bound = rank_tolerance * std::max(sums.normal.trace(), 1.0);
  Eigen::Index free = 0;
  while (free < 6 && normal.values[free] <= bound) ++free;
  if (free == 0) return;
  for (Eigen::Index i = 0; i < free; ++i)
    Eigen::Map<Vector6>(sums.piece.modes.emplace_back().data()) = normal.vectors.col(i);
  const Eigen::MatrixXd turns = normal.vectors.leftCols(free).bottomRows(3);
  const SymmetricEigen axes = symmetric_eigen(turns * turns.transpose());
  for (Eigen::Index i = 2; i >= 0; --i)
    if (axes.values[i] > 1e-8) sums.piece.axes.push_back(tidy(axes.vectors.col(i)));
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
  return text;
}

std::string name_of(const Vec3& axis) {
  for (std::size_t c = 0; c < 3; ++c)
    if (std::abs(axis[c]) > 1 - 1e-6) return std::string(1, static_cast<char>('x' + c));
  std::ostringstream text;
  text.precision(3);
  text << '(' << axis[0] << ", " << axis[1] << ", " << axis[2] << ')';
  return text.str();
}

}  // namespace

bool FreePiece::is_pushed() const {
  for (std::size_t c = 0; c < 3; ++c)
    if (translations[c] && std::abs(force[c]) > balanced * force_scale) return true;
  return false;
}

std::string FreePiece::motions() const {
  if (axes.size() == 3 && translations == std::array{true, true, true})
    return "move and turn in every direction";
  std::vector<std::string> along, about;
  for (std::size_t c = 0; c < 3; ++c)
    if (translations[c]) along.emplace_back(1, static_cast<char>('x' + c));
  for (const Vec3& axis : axes) about.push_back(name_of(axis));
  std::vector<std::string> parts;
  if (!along.empty()) parts.push_back("move along " + joined(along));
  if (axes.size() == 3)
    parts.emplace_back("turn about every axis");
  else if (!about.empty())
    parts.push_back("turn about " + joined(about));
  return joined(parts);
}

std::vector<FreePiece> find_free_pieces(const CellComplex& complex, Attributes& attributes,
                                        const std::vector<double>& force) {
  const std::vector<Index> pieces = pieces_of(complex, attributes);
  std::vector<Sums> sums;
  const auto for_each_vertex = [&](auto visit) {
    for (Index v = 0; v < pieces.size(); ++v) {
      if (pieces[v] == none) continue;
      if (pieces[v] >= sums.size()) sums.resize(pieces[v] + 1);
      visit(v, sums[pieces[v]]);
    }
  };
  for_each_vertex([&](Index v, Sums& sum) {
    const double* f = &force[std::size_t{v} * 4];
    const Vec3 x = position_of(attributes, v);
    for (std::size_t c = 0; c < 3; ++c) {
      sum.centre[c] += x[c];
      sum.piece.force[c] += f[c];
    }
    sum.piece.force_scale += std::hypot(f[0], f[1], f[2]);
    ++sum.vertices;
  });
  for (Sums& sum : sums)
    for (double& component : sum.centre) component /= sum.vertices;
  for_each_vertex([&](Index v, Sums& sum) {
    const Vec3 arm = minus(position_of(attributes, v), sum.centre);
    sum.radius_squared += dot(arm, arm) / sum.vertices;
  });
  for_each_vertex([&](Index v, Sums& sum) {
    const int held = static_cast<int>(attributes.fixed().get(v, 0));
    const Vec3 arm = minus(position_of(attributes, v), sum.centre);
    for (std::size_t c = 0; c < 3; ++c) {
      if ((held >> c & 1) == 0) continue;
      const Vector6 row = row_of(c, arm, std::sqrt(sum.radius_squared));
      sum.normal += row * row.transpose();
    }
  });
  add_elements(complex, attributes, pieces, sums);
  for (std::size_t i = 0; i < sums.size(); ++i) {
    sums[i].piece.number = static_cast<Index>(i);
    sums[i].piece.centre = sums[i].centre;
    sums[i].piece.radius = std::sqrt(sums[i].radius_squared);
  }
  std::vector<FreePiece> found;
  for (Sums& sum : sums) {
    find_motions(sum);
    const auto& moves = sum.piece.translations;
    if (!sum.piece.axes.empty() || moves[0] || moves[1] || moves[2]) found.push_back(sum.piece);
  }
  return found;
}

bool forces_allow_motion(Body& body, const FreePiece& piece, const std::array<bool, 3>& matters) {
  if (!body.models().has_tangent()) return false;
  const std::vector<Index> pieces = pieces_of(body.complex(), body.attributes());
  const std::size_t size = 3 * std::size_t{body.attributes().vertex_count()};
  const auto largest_image = [&](auto value) {
    std::vector<double> direction(size), image(size);
    for (std::size_t i = 0; i < size; ++i) direction[i] = value(i);
    body.models().add_tangent(direction.data(), 1, 0, 0, image.data());
    for_each_with<TangentTerm>(body.terms(), [&](TangentTerm& term) {
      if (term.is_anchored()) term.add_tangent(direction.data(), 1, 0, 0, image.data());
    });
    double largest = 0;
    for (std::size_t i = 0; i < size; ++i)
      if (i / 3 < pieces.size() && pieces[i / 3] == piece.number)
        largest = std::max(largest, std::abs(image[i]));
    return largest;
  };
  const double stiff = largest_image([](std::size_t i) { return i * 7 % 5 < 2 ? 1.0 : -1.0; });
  for (std::size_t c = 0; c < 3; ++c) {
    if (piece.translations[c] && matters[c] &&
        largest_image([&](std::size_t i) { return i % 3 == c ? 1.0 : 0.0; }) > 1e-8 * stiff)
      return false;
  }
  return true;
}

std::vector<FreePiece> find_unheld_pieces(Body& body) {
  const std::vector<double> no_forces(4 * std::size_t{body.attributes().vertex_count()});
  std::vector<FreePiece> pieces = find_free_pieces(body.complex(), body.attributes(), no_forces);
  std::erase_if(pieces, [&](const FreePiece& piece) {
    return !forces_allow_motion(body, piece, {true, true, true});
  });
  return pieces;
}

}  // namespace suture
