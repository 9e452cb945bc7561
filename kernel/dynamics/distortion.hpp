// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "kernel/dynamics/body.hpp"

namespace suture {

/// How far a body is compressed and distorted at its current positions.
struct Distortion {
  double stretch = 1;  ///< the smallest principal stretch at the centre of an element
  Index compressed = none;
  double jacobian = 1;  ///< the smallest corner Jacobian, relative to that at rest
  Index distorted = none;
};

/// O(elements).
Distortion measure_distortion(Body& body);

/// "the smallest principal stretch is 0.58 (element 3), ...", by the user's numbers of elements.
std::string describe(const Distortion& distortion, const Body& body);

}  // namespace suture
