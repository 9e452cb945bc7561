// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>

#include "kernel/base/archive.hpp"
#include "kernel/contact/placed_obstacle.hpp"

// A tool in a hand
// ================
//
//      hand (path) o----/\/\/\----o tool, mass m      The body stops the tool,
//                  |     k, b     |                   and the hand feels the spring.
//                  o----[====]----o
//                                 |  pushes F, T
//                            ~~~~~~~~~~~  body
//
// Spring and damper act as they are at the end of the step, which adds h b + h dt k to the mass.
// The coupling is therefore stable and passive for any stiffness.
//
// The vertices that the tool pushes end the step on its surface where it ends. Their impulses
// depend on its motion, and its motion on them, so both are solved together. With one exchange of
// forces per step, nodes heavier than the tool throw it back faster than it came. The unknowns are
// the six velocities of the tool: Gauss-Seidel over the vertices converges slowly if the tool is
// lighter than they are. Newton's method uses the exact derivative of each push, sliding or
// sticking, until the tool moves by less than 1e-9 of an edge. A step that leads further away is
// cut to a quarter. Every iteration repeats the pushes of the vertices near obstacles: about six
// per step while in contact. What resists the edge of a blade that the tool carries is found in
// the same iterations (cutting_edges.hpp); its derivative is nearly exact.
//
// Where pieces touch each other as well, tool and vertices agree to 0.001 of an edge. For a tool
// of 1/37,000 of the mass of a node, the iteration may end before both agree. The tool then keeps
// the motion with which its vertices were pushed, so nothing enters it, but an impact can add
// energy.

namespace suture {

/// The motion of a compliant obstacle: a rigid body with mass, tied by a spring and a damper to the
/// pose that its path prescribes, the hand: the virtual coupling of Colgate, Stanley and Brown
/// (Issues in the haptic display of tool use, IROS 1995). With x the centre, theta the rotation
/// vector from tool to hand, h the kick and dt the drift of a step,
///
///   m (v' - v) / h = k (x_hand - x - dt v') + b (v_hand - v') + F            x' = x + dt v'
///   I (w' - w) / h = k_r (theta - dt w') + b_r (w_hand - w') + T             R' = exp(dt w') R
///
/// The coupling acts as it is at the end of the step, so it is stable and passive for any
/// stiffness. F and T are those of the vertices that the tool pushes. They depend on v' and w',
/// since pushed vertices end the step on the surface of the tool where it ends: Contact repeats the
/// step of the vertices, and calls improve(), until both agree.
class Tool {
 public:
  /// A place of the body that the tool pushes.
  struct Pushed {
    Vec3 place;  ///< m
    double mass;
    /// How the change of its velocity follows that of the place of the tool which pushes it, by
    /// rows.
    std::array<Vec3, 3> response;
  };
  /// That of a vertex on the surface of the tool, which sticks or slides.
  static std::array<Vec3, 3> response(const Push& push, double friction);
  /// On the tool, N s, and about its centre where the step ends, N m s.
  struct Impulse {
    Vec3 linear{}, angular{};
  };

  /// At rest where the path begins.
  explicit Tool(const Obstacle& obstacle);
  /// It has a point, beside its shape as given.
  void include(const Vec3& given);

  /// Begins a step; end() is that without contact.
  void begin(const RigidPath& hand, double time, double end, double dt, double gain);
  /// The vertices answered the motion to end() with `answer`. Changes end() towards the motion that
  /// agrees with its answer, by a step of Newton's method in which `pushed` stay pushed, sliding or
  /// sticking; takes three quarters of the last step back if that led further away. Returns a bound
  /// on the change of the place of any point of the tool, m.
  double improve(const Impulse& answer, std::span<const Pushed> pushed);
  /// Ends the step with the motion that the impulse causes, or, if both do not agree, with that to
  /// end(): of a tool much lighter than what it pushes, the impulse would be mostly error.
  void finish(const Impulse& impulse, bool agree = true);

  const Pose& pose() const { return pose_; }  ///< at the start of the step in progress, or now
  const Pose& end() const { return end_; }
  /// Force of the tool on the hand in the last step, and torque about the centre, N, N m.
  const Vec3& hand_force() const { return state_.hand_force; }
  const Vec3& hand_torque() const { return state_.hand_torque; }
  const Vec3& velocity() const { return state_.velocity; }  ///< of the centre, m/s
  const Vec3& spin() const { return state_.spin; }          ///< rad/s
  double top_speed() const;                                 ///< of its points, m/s

  void state(Archive& archive);

 private:
  struct State {
    Vec3 velocity{}, spin{}, hand_force{}, hand_torque{};
  };
  struct Motion {
    Vec3 velocity{}, spin{};
  };
  void move_end();

  Coupling coupling_;
  double reach_;  ///< of its points from the centre, m
  Pose pose_, end_;
  State state_;
  // In the step in progress:
  double dt_ = 0, gain_ = 0;
  double mass_ = 0, inertia_ = 0;  ///< including what the coupling resists
  Motion free_, now_;              ///< without contact, and to end()
  Motion base_, step_;             ///< of Newton's method; now_ = base_ + part_ * step_
  double part_ = 1;
  double misfit_ = 0;  ///< of the impulses at base_, in sqrt(J)
};

}  // namespace suture
