// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/results/nodal_stress.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>

namespace suture {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Stress = Eigen::Matrix<double, 6, 1>;

/// A slope is determined if the centres of the elements are spread along it at least this much,
/// relative to the nodes of the elements around their centres: 1 for two layers of equal
/// thickness, 0 for one layer, a few hundredths if that is curved.
constexpr double least_spread = 0.1;

/// Vertices per task of a thread.
constexpr Index vertices_per_task = 2048;

/// The linear function that was fitted to the elements of a patch, at one place.
struct Fit {
  Stress stress;
  bool determined;  ///< in every direction
};

class Recovery {
 public:
  Recovery(const CellComplex& complex, const Column& position, std::span<const double> stress,
           std::span<const Index> group)
      : complex_(complex), position_(position), stress_(stress), group_(group) {}

  /// NaN if no element around the vertex has a stress.
  Stress at(Index vertex) const {
    std::vector<Index> patch = elements_around(vertex);
    if (patch.empty()) return Stress::Constant(std::numeric_limits<double>::quiet_NaN());
    const Fit fit = fit_to(patch, place(vertex));
    if (fit.determined) return fit.stress;
    add_neighbours(patch);
    return fit_to(patch, place(vertex)).stress;
  }

 private:
  Vector3d place(Index vertex) const {
    return Eigen::Map<const Vector3d>(position_.rows() + std::size_t{4} * vertex);
  }
  Vector3d centre(Index element) const {
    Vector3d sum = Vector3d::Zero();
    for (const Index v : complex_.vertices_of(element)) sum += place(v) / 8;
    return sum;
  }
  Eigen::Map<const Stress> stress_of(Index element) const {
    return Eigen::Map<const Stress>(stress_.data() + std::size_t{6} * element);
  }

  /// Those of the smallest group.
  std::vector<Index> elements_around(Index vertex) const {
    std::vector<Dart> star;
    complex_.star(0, vertex, star);
    Index first = none;
    for (const Dart d : star) first = std::min(first, group_[d / hexahedron::darts]);
    std::vector<Index> elements;
    for (const Dart d : star) {
      const Index e = d / hexahedron::darts;
      if (group_[e] == first && first != none) elements.push_back(e);
    }
    return elements;
  }

  /// Adds the elements of the same group that share a face with one of the patch.
  void add_neighbours(std::vector<Index>& patch) const {
    const std::size_t inner = patch.size();
    for (std::size_t i = 0; i < inner; ++i) {
      for (int f = 0; f < hexahedron::faces; ++f) {
        const Index other = complex_.neighbour(patch[i], f);
        if (other == none || group_[other] != group_[patch[i]]) continue;
        if (std::ranges::find(patch, other) == patch.end()) patch.push_back(other);
      }
    }
  }

  /// With c_e the centres, n_ei the nodes, s_e the stresses and bars over means of the patch:
  ///   C = sum_e (c_e - c)(c_e - c)^T,   M = sum_ei (n_ei - c_e)(n_ei - c_e)^T / 8
  ///   s(x) = s + S^T (x - c),           S = C^-1 sum_e (c_e - c)(s_e - s)^T
  /// C v = l M v gives C^-1 = sum v v^T / l, without the directions in which l is too small.
  Fit fit_to(const std::vector<Index>& patch, const Vector3d& x) const {
    Vector3d c = Vector3d::Zero();
    Stress s = Stress::Zero();
    for (const Index e : patch) {
      c += centre(e) / static_cast<double>(patch.size());
      s += stress_of(e) / static_cast<double>(patch.size());
    }
    Matrix3d centres = Matrix3d::Zero(), nodes = Matrix3d::Zero();
    Eigen::Matrix<double, 3, 6> moments = Eigen::Matrix<double, 3, 6>::Zero();
    for (const Index e : patch) {
      const Vector3d own = centre(e), arm = own - c;
      centres += arm * arm.transpose();
      moments += arm * (stress_of(e) - s).transpose();
      for (const Index v : complex_.vertices_of(e))
        nodes += (place(v) - own) * (place(v) - own).transpose() / 8;
    }
    const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix3d> modes(centres, nodes);
    Fit fit{s, true};
    for (int a = 0; a < 3; ++a) {
      const Vector3d v = modes.eigenvectors().col(a);
      const double spread = modes.eigenvalues()[a];
      if (spread > least_spread)
        fit.stress += moments.transpose() * v * (v.dot(x - c) / spread);
      else
        fit.determined = false;
    }
    return fit;
  }

  const CellComplex& complex_;
  const Column& position_;
  std::span<const double> stress_;
  std::span<const Index> group_;
};

}  // namespace

std::vector<double> nodal_stress(const CellComplex& complex, const Column& position,
                                 std::span<const double> stress, std::span<const Index> group,
                                 const Workers& workers, const ShownCells& vertices) {
  const Recovery recovery(complex, position, stress, group);
  const Index count = vertices.size();
  std::vector<double> values(std::size_t{6} * count, std::numeric_limits<double>::quiet_NaN());
  const auto recover = [&](std::size_t task) {
    const auto begin = static_cast<Index>(task) * vertices_per_task;
    for (Index i = begin; i < std::min(begin + vertices_per_task, count); ++i) {
      if (!complex.exists(0, vertices[i])) continue;
      Eigen::Map<Stress>(values.data() + std::size_t{6} * i) = recovery.at(vertices[i]);
    }
  };
  workers.parallel_for((count + vertices_per_task - 1) / vertices_per_task, recover);
  return values;
}

}  // namespace suture
