// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "kernel/dynamics/body.hpp"

namespace suture {

/// A free vibration about the present state of a body: K u = w^2 M u on the free components.
struct NaturalMode {
  enum class Kind {
    vibration,
    zero,     ///< within rounding: a rigid motion, or a mechanism of the model
    unstable  ///< w^2 < 0: a disturbance grows
  };
  Kind kind = Kind::vibration;
  double eigenvalue = 0;    ///< w^2, 1/s^2
  double residual = 0;      ///< EigenPairs::residuals (lobpcg.hpp)
  std::vector<Vec3> shape;  ///< displacement of each vertex; the largest component is 1

  double frequency() const;  ///< Hz; of a vibration
  double growth() const;     ///< 1/s; of an unstable mode
};

struct NaturalModes {
  std::vector<NaturalMode> modes;  ///< ascending by w^2
  unsigned iterations = 0;
  unsigned products = 0;  ///< with the tangent
  std::string preconditioner;
};

/// For `suture modes -v`.
struct ModalIteration {
  unsigned number, converged;
  double lowest;    ///< w^2 of the first mode so far
  double residual;  ///< the largest
};

/// Throws InputError if the body has fewer free components than `count`. O(vertices).
void require_modes(Body& body, unsigned count);

/// Finds the `count` lowest modes by LOBPCG (lobpcg.hpp), preconditioned by the solver that
/// choose_preconditioner() selects for K, or for K + s M where K is not positive definite: with
/// pieces that may move freely, or once a negative Ritz value has shown that the state is unstable.
/// Frequencies are exact to about 1e-8.
///
/// K = -df/dx is the symmetric part of the tangent of all terms. Needs
/// body.models().has_tangent(), and require_modes(). Throws NumericalError if the tangent is not
/// finite or a mode does not converge.
///
/// Memory: 240 B per vertex and mode. Beyond about 50 modes, time grows as their number squared.
NaturalModes find_natural_modes(
    Body& body, double time, unsigned count,
    const std::function<void(const ModalIteration&)>& on_iteration = {});

}  // namespace suture
