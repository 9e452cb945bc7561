// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/local_error.hpp"

#include <cmath>
#include <limits>

#include "kernel/attributes/held.hpp"
#include "kernel/dynamics/residual.hpp"

namespace suture {
namespace {

/// The root mean square of lengths, weighted by mass.
struct MeanSquare {
  double sum = 0, mass = 0;
  void add(double weight, double length) {
    sum += weight * length * length;
    mass += weight;
  }
  double root() const { return mass > 0 ? std::sqrt(sum / mass) : 0; }
};

}  // namespace

/// visit(vertex, component, mass) for what the forces move.
template <class Visit>
void LocalError::for_each_free(Visit visit) const {
  Attributes& attributes = motion_.body().attributes();
  for (Index vertex = 0; vertex < attributes.vertex_count(); ++vertex) {
    const double mass = attributes.mass().get(vertex, 0);
    const unsigned held = held_components(attributes, vertex);
    for (std::size_t c = 0; c < 3; ++c)
      if (!is_held(held, c)) visit(vertex, static_cast<int>(c), mass);
  }
}

void LocalError::begin() {
  motion_.evaluate();
  const Residual now(motion_);
  start_.resize(motion_.body().attributes().vertex_count());
  for (Index vertex = 0; vertex < start_.size(); ++vertex)
    start_[vertex] = now.acceleration(vertex);
}

StepError LocalError::measure(double dt) {
  motion_.evaluate();
  Attributes& attributes = motion_.body().attributes();
  const Residual now(motion_);
  MeanSquare change, displacement;
  double largest = -1;
  StepError result;
  for_each_free([&](Index vertex, int c, double mass) {
    const auto component = static_cast<std::size_t>(c);
    const double jump = now.acceleration(vertex)[component] - start_[vertex][component];
    change.add(mass, jump);
    displacement.add(mass, attributes.position().get(vertex, c) - attributes.rest().get(vertex, c));
    if (!(std::abs(jump) <= largest)) {
      largest = std::abs(jump);
      result.vertex = vertex;
    }
  });
  result.error = constant_ * dt * dt * change.root();
  result.displacement = displacement.root();
  return result;
}

/// The positive root of a/2 t^2 + v t = distance, in a form that exists for a = 0.
double LocalError::time_to_move(double distance) {
  begin();
  MeanSquare velocity, acceleration;
  for_each_free([&](Index vertex, int c, double mass) {
    velocity.add(mass, motion_.body().attributes().velocity().get(vertex, c));
    acceleration.add(mass, start_[vertex][static_cast<std::size_t>(c)]);
  });
  const double v = velocity.root(), a = acceleration.root();
  return 2 * distance / (v + std::sqrt(v * v + 2 * a * distance));
}

}  // namespace suture
