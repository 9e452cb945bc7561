// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "kernel/base/archive.hpp"
#include "kernel/base/types.hpp"
#include "kernel/base/vec3.hpp"

namespace suture {

/// Matter that has left a body, with all that it took along.
struct RemovedMatter {
  Index pieces = 0;    ///< whole islands; 0: parts of elements that stayed connected
  Index elements = 0;  ///< or copies of them
  double volume = 0;   ///< at rest, m^3
  double mass = 0;     ///< kg
  Vec3 momentum{};     ///< N s
  double energy = 0;   ///< kinetic and stored, J

  RemovedMatter& operator+=(const RemovedMatter& other) {
    pieces += other.pieces;
    elements += other.elements;
    volume += other.volume;
    mass += other.mass;
    momentum = plus(momentum, other.momentum);
    energy += other.energy;
    return *this;
  }
  void state(Archive& archive) {
    archive("pieces", pieces);
    archive("elements", elements);
    archive("volume", volume);
    archive("mass", mass);
    archive("momentum", momentum);
    archive("energy", energy);
  }
};

/// "0.0012 ml".
std::string volume_text(double volume);
/// "2 pieces, 0.0012 ml of 310 ml, 1.3e-06 kg, momentum 2e-07 N s, energy 3e-09 J".
std::string describe(const RemovedMatter& removed, double of_volume);

}  // namespace suture
