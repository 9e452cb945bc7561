// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/choice.hpp"

#include <random>

#include "kernel/solvers/block_jacobi.hpp"
#include "kernel/solvers/conjugate_gradients.hpp"
#include "kernel/solvers/direct.hpp"

namespace suture {
namespace {

/// The direct solver and the multigrid take the same time for this many elements of a compact body
/// (suture-bench solve --direct).
constexpr Index max_direct_elements = 100;

/// With a stiffness of this multiple of the mass term, block Jacobi needs about 40 iterations to
/// 1e-8, which take as long as building and applying the multigrid.
constexpr double max_stiffness = 8;

/// The trace of the stiffness in multiples of that of the mass term, estimated by one random vector
/// of +-1 (Hutchinson). Infinite without mass.
double stiffness_over_mass(const TangentMatrix& a) {
  if (!a.has_mass()) return std::numeric_limits<double>::infinity();
  std::minstd_rand random(1);
  std::vector<double> x(a.size()), y(a.size());
  for (double& value : x) value = random() % 2 == 0 ? 1 : -1;
  a.restrict(x);
  a.apply(x.data(), y.data());
  double mass = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    mass += a.mass_at(static_cast<Index>(i / 3)) * x[i] * x[i];
  return dot(x, y) / mass - 1;
}

}  // namespace

PreconditionerChoice choose_preconditioner(const CellComplex& complex, Attributes& attributes,
                                           const TangentMatrix& a,
                                           const MultigridOptions& options) {
  using Kind = PreconditionerChoice::Kind;
  if (stiffness_over_mass(a) < max_stiffness)
    return {Kind::block_jacobi, make_block_jacobi(), "because the mass term dominates the matrix"};
  const Index elements = complex.existing(3);
  const std::string count = std::to_string(elements) + " elements";
  if (elements <= max_direct_elements)
    return {Kind::direct, make_direct(complex, attributes),
            "because a body of " + count + " is small"};
  return {Kind::multigrid, make_multigrid(complex, attributes, options), "for " + count};
}

}  // namespace suture
