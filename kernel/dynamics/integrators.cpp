// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/integrators.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

constexpr std::array names{"symplectic-euler", "velocity-verlet"};
constexpr std::array makers{make_symplectic_euler, make_velocity_verlet};
static_assert(names.size() == makers.size());

}  // namespace

bool Integrator::is_other_step(double dt) const {
  return !(std::abs(dt - motion_.last_step()) <= 1e-9 * dt);
}

std::unique_ptr<Integrator> make_integrator(const std::string& name, Motion& motion) {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) throw InputError("unknown integrator '" + name + "'");
  return makers[static_cast<std::size_t>(found - names.begin())](motion);
}

std::span<const char* const> integrator_names() { return names; }

}  // namespace suture
