// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/dynamics/body.hpp"

namespace suture {

/// Forces in rows of 4 and m g, 3 numbers per vertex.
std::vector<double> with_weight(const double* rows, Attributes& attributes, const Vec3& gravity);

/// The forces of all terms on a body, gravity included, N: 3 numbers per vertex.
std::vector<double> total_forces(Body& body, double time);

/// Minus the derivative of the stored energy by the positions, N: 3 numbers per vertex.
std::vector<double> elastic_forces(Body& body, double time);

/// The transpose of their derivative by the positions, times a vector; 3 numbers per vertex. Exact
/// where the tangents of all models are symmetric.
std::vector<double> transposed_tangent(Body& body, double time, const std::vector<double>& d);
/// The same of the derivative itself.
std::vector<double> tangent(Body& body, double time, const std::vector<double>& d);

}  // namespace suture
