// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <functional>

#include "kernel/build/built_scene.hpp"
#include "tests/run/beam.hpp"

namespace suture::test {

/// A box at the origin, of `cells` elements, without loads and constraints.
Scene block(PluginHost& host, const std::string& model, const Vec3& size,
            const std::array<Index, 3>& cells, const std::map<std::string, double>& values);

/// All points between two corners, with some slack.
Selection within(const Vec3& min, const Vec3& max);
/// Points with these coordinates; NaN stands for any.
Selection at(const Vec3& coordinates);
inline constexpr double any = std::numeric_limits<double>::quiet_NaN();

/// Holds `components` (bits 1 x, 2 y, 4 z), or moves them by `translation` until time 1.
Constraint& hold(Scene& scene, const Selection& where, std::uint8_t components,
                 const Vec3& translation = {});
/// A dead traction, Pa of the surface at rest, that grows until time 1.
void load(Scene& scene, const Selection& where, const Vec3& traction);

/// A scene at its equilibrium of time 1.
class Equilibrium {
 public:
  /// Reaches it in `steps` steps.
  explicit Equilibrium(const Scene& scene, int steps = 1);

  /// Goes on to the equilibrium at `time`.
  void proceed(double time);
  Eigen::Vector3d displacement(const Selection& where);  ///< mean, m
  Eigen::Vector3d reaction(const Selection& where);      ///< sum, N
  Eigen::Vector3d moment(const Selection& where);        ///< of reactions about 0, N m
  double energy();                                       ///< of the models, J
  /// The largest distance of a vertex from where `place` has it, by its place at rest, m.
  double distance(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& place);
  Body& body() { return built_.body(); }

 private:
  Diagnostics diagnostics_;
  BuiltScene built_;
};

}  // namespace suture::test
