// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "kernel/base/diagnostics.hpp"
#include "kernel/build/built_scene.hpp"
#include "kernel/results/recorder.hpp"
#include "kernel/spectrum/modes.hpp"

namespace suture {

/// The check of the tangent that ends a search for rest: a state whose lowest eigenvalue is
/// negative is in balance, but the smallest disturbance grows (a straight column above its Euler
/// load). If the scene requests it, the body is displaced along the mode and the search continues.
class Stability {
 public:
  enum class Verdict { stable, unknown, unstable, kicked };

  Stability(const Scene& scene, BuiltScene& built, Recorder& recorder, Diagnostics& diagnostics)
      : scene_(scene), built_(built), recorder_(recorder), diagnostics_(diagnostics) {}

  /// Call when the body is at rest after `steps` steps, up to a force, N. Warns if the state is
  /// unstable, if it is indeterminate although constraints hold the body, or if it could not be
  /// examined, writes the mode, and applies the kick. `gravity` is used
  /// for the fields of the frame. Costs at most a third of the steps so far, or of 2,900 steps.
  Verdict examine(double unbalanced_force, std::uint64_t steps, double time, const Vec3& gravity);

  /// The lowest eigenvalue of the last check, 1/s^2; none if the tangent is unknown.
  std::optional<double> lowest_eigenvalue() const { return lowest_; }
  void state(Archive& archive);
  /// The result, for a note.
  std::string text() const;

 private:
  double rounding_of_rest(double unbalanced_force) const;
  std::string place_of(const LowestMode& mode) const;
  std::string describe_neutral(const LowestMode& mode) const;
  std::string describe(const LowestMode& mode, bool is_proof) const;
  void kick(const LowestMode& mode);

  static constexpr unsigned max_kicks = 5;

  const Scene& scene_;
  BuiltScene& built_;
  Recorder& recorder_;
  Diagnostics& diagnostics_;
  std::optional<double> lowest_;
  bool neutral_ = false;  ///< zero within rounding
  unsigned kicks_ = 0;
};

}  // namespace suture
