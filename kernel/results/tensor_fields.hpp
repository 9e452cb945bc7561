// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/results/fields.hpp"

namespace suture {

/// strain and principal_strain of every element: Green-Lagrange, from the deformation gradient at
/// its centre (mean_gradient.hpp).
std::vector<FieldChoice> strain_fields();

/// What is computed from the element field "stress" of the models: principal_stress of elements,
/// nodal_stress and nodal_von_mises of vertices. Empty if it is not among `fields`.
std::vector<FieldChoice> fields_of_stress(const std::vector<FieldChoice>& fields);

}  // namespace suture
