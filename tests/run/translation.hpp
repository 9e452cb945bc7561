// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "kernel/run/simulation.hpp"

namespace suture::test {

inline constexpr Vec3 far_away{1e7, -3e6, 1e5};
/// Coordinates of multiples of 1/1024 m are exact here, too.
inline constexpr Vec3 exact_shift{1 << 23, -(1 << 22), 1 << 17};

/// "[x, y, z]" of a point of the scene after a shift.
std::string at(const Vec3& point, const Vec3& shift);

struct MessageList : Observer {
  std::vector<std::string> lines;
  void on_message(const std::string& line) override { lines.push_back(line); }
};

/// A run of a scene, and what must not depend on the scene's position.
struct TranslatedRun {
  explicit TranslatedRun(const Scene& scene);

  RunSummary summary;
  std::vector<std::string> events;
  std::vector<std::string> warnings;
  std::vector<double> displacement, velocity;
  Energies energies;
  double largest = 0;  ///< displacement, m
};

/// The same steps, events and islands; displacements within `tolerance` of the largest,
/// and for 0 the same bits of everything.
void expect_same(const TranslatedRun& near, const TranslatedRun& far, double tolerance);

/// Two NaNs count as near.
void expect_near(double a, double b, double tolerance, const std::string& what);

}  // namespace suture::test
