// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "kernel/base/types.hpp"
#include "tests/stability/trial.hpp"

namespace suture::test {

/// A model with the parameters that give it E and nu at small strain, as far as it has them.
struct Material {
  std::string name;  ///< "neo-hookean", or with its element "neo-hookean+trilinear"
  double young = 1, poisson = 0.3, density = 1;
  double period = 1;  ///< s: `visco` relaxes within it
};

/// All models that are shipped; some with both elements.
const std::vector<std::string>& material_names();

bool is_lattice(const std::string& name);   ///< of springs
bool has_poisson(const std::string& name);  ///< a parameter sets Poisson's ratio
bool keeps_state(const std::string& name);  ///< dissipates: `visco` and damage

Json model_entry(const Material& material);

// Homogeneous deformations, from the equations in plugins/*/README.md: this is the reference, which
// shares no code with the plugins. Elements are boxes with these edges; viscous terms have relaxed.

/// J/m^3 of rest volume.
double energy_density(const Material& material, const Vec3& edges, const Vec3& stretch);
/// Nominal stresses dW/d(stretch) at fixed damage, Pa.
Vec3 nominal_stress(const Material& material, const Vec3& edges, const Vec3& stretch);
/// Stretches under a dead traction along x with free sides.
Vec3 stretch_under(const Material& material, const Vec3& edges, double traction);

}  // namespace suture::test
