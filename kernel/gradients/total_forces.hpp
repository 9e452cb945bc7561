// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "kernel/dynamics/body.hpp"

namespace suture {

/// When forces act in a run, and what else masses resist.
struct Moment {
  TangentTime at = 0;
  /// An acceleration a, m/s^2, 3 numbers per vertex; empty: none.
  std::vector<double> inertia{};
};

/// Why a body whose models have fields has no derivatives; "" without fields.
std::string why_fields_have_none(const Body& body);

/// Forces in rows of 4 and m g, 3 numbers per vertex.
std::vector<double> with_weight(const double* rows, Attributes& attributes, const Vec3& gravity);

/// The forces of all terms on a body, gravity included, N: 3 numbers per vertex. `at`: in a step
/// of length dt, those of models with a memory depend on it.
std::vector<double> total_forces(Body& body, const TangentTime& at);

/// The same without those of the models.
std::vector<double> load_forces(Body& body, double time);
/// The same at a moment of a run: f - m a.
std::vector<double> balanced_forces(Body& body, const Moment& moment);

/// Minus the derivative of the stored energy by the positions, N: 3 numbers per vertex.
std::vector<double> elastic_forces(Body& body, double time);

/// The transpose of their derivative by the positions, times a vector; 3 numbers per vertex. Exact
/// where the tangents of all models are symmetric.
std::vector<double> transposed_tangent(Body& body, const TangentTime& at,
                                       const std::vector<double>& d);
/// The same of the derivative itself.
std::vector<double> tangent(Body& body, const TangentTime& at, const std::vector<double>& d);
/// The same by the velocities, which is symmetric.
std::vector<double> damping_tangent(Body& body, const TangentTime& at,
                                    const std::vector<double>& d);

}  // namespace suture
