// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "kernel/dynamics/ledger.hpp"
#include "tests/dynamics/rig.hpp"

namespace rig {

inline Options with(const char* scheme, double damping = 0, suture::Vec3 gravity = {},
                    suture::TimeRamp ramp = {}) {
  return {scheme, damping, gravity, ramp};
}

/// The equation in the header, by the numbers of a row of energies.csv.
inline void expect_to_add_up(const suture::EnergyBalance& start, const suture::EnergyBalance& b) {
  double explained = b.prescribed + b.models + b.events - b.dissipated + b.balance;
  for (const suture::EnergyBalance::Work& work : b.works) explained += work.value;
  EXPECT_NEAR(b.kinetic + b.elastic - start.kinetic - start.elastic, explained,
              1e-12 * (b.exchanged + start.elastic));
}

}  // namespace rig
