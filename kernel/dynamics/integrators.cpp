// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/integrators.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

struct Scheme {
  const char* name;
  MakeIntegrator* make;
  bool is_implicit = false;
  double error_constant = 0;
  bool solves_equations = is_implicit;
};
constexpr std::array schemes{Scheme{"symplectic-euler", make_symplectic_euler},
                             Scheme{"velocity-verlet", make_velocity_verlet, false, 1. / 6},
                             Scheme{"implicit-euler", make_implicit_euler, true},
                             Scheme{"newmark", make_newmark, true, 1. / 12},
                             Scheme{"xpbd", make_xpbd, true, 0, false},
                             Scheme{"static", make_static_equilibrium, true}};

const Scheme* find(const std::string& name) {
  const auto found = std::ranges::find(schemes, name, &Scheme::name);
  return found == schemes.end() ? nullptr : &*found;
}

}  // namespace

bool Integrator::is_other_step(double dt) const {
  return !(std::abs(dt - motion_.last_step()) <= 1e-9 * dt);
}

std::unique_ptr<Integrator> make_integrator(const std::string& name, Motion& motion,
                                            const IntegratorOptions& options) {
  const Scheme* scheme = find(name);
  if (!scheme) throw InputError("unknown integrator '" + name + "'");
  return scheme->make(motion, options);
}

bool is_implicit(const std::string& name) {
  const Scheme* scheme = find(name);
  return scheme && scheme->is_implicit;
}

bool solves_equations(const std::string& name) {
  const Scheme* scheme = find(name);
  return scheme && scheme->solves_equations;
}

double error_constant(const std::string& name) {
  const Scheme* scheme = find(name);
  return scheme ? scheme->error_constant : 0;
}

std::vector<std::string> integrator_names() {
  std::vector<std::string> names;
  for (const Scheme& scheme : schemes) names.emplace_back(scheme.name);
  return names;
}

}  // namespace suture
