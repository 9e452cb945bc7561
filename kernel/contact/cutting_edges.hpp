// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "kernel/contact/element_finder.hpp"
#include "kernel/contact/placed_obstacle.hpp"
#include "kernel/contact/surface_points.hpp"
#include "kernel/contact/tool.hpp"

// A blade that meets a force
// ==========================
//
//            tip of the slit
//   lips         v        intact tissue
//   ===========. |
//               >o-->  F = R l
//   ===========' edge
//
// The tissue at the edge moves with the blade as long as the force on a length l of the edge is
// below R l, R the toughness (J/m^2 = N/m). Where more would be needed, the force is R l and the
// edge advances through the tissue: it cuts.
//
// The work that advancing takes is thus R per area, whatever the elements. Cutting is to the edge
// what sliding friction is to a surface, with the limit R l instead of mu N, and is found as
// contact is: by impulses that change where the step without them would have ended (contact.hpp).
// With a the place of the tissue that is at the edge p when the step begins, and g = p' - a' what
// has come between them at its end, without the part along the edge,
//
//   dv = g / h   if  m |dv| <= R l h,   else R l h / m in the direction of g
//
// No stiffness has to be chosen, and blade and tissue keep no common memory except this: the
// direction of the last advance, because an edge pushes and does not pull. One that draws back
// leaves the tip of the slit and meets it again where it left it. The first advance may need more,
// the stress at which the tissue breaks times the thickness of the edge.
//
// Source: M. Mahvash and V. Hayward, Haptic rendering of cutting: a fracture mechanics approach,
// Haptics-e 2 (2001): the work of a blade is R dA plus what the tissue stores; deformation, rupture
// and cutting follow each other.

namespace suture {

/// The edges of blades that tissue resists, and what they do in an explicit step. The edge is
/// sampled; each sample acts on the nodes of the element in which it is.
class CuttingEdges {
 public:
  /// Whether there is material at a place in the reference cube of an element.
  using HasMaterial = std::function<bool(Index element, const Vec3& at)>;
  struct Edge {
    std::size_t obstacle = 0;       ///< that carries it
    std::vector<Vec3> points;       ///< a polyline beside the obstacle as given, m
    std::vector<double> toughness;  ///< by element, J/m^2
    double start = 0;               ///< force per length at which it begins to cut, N/m
    HasMaterial has_material{};     ///< if it divides elements; else empty
  };

  /// `edge`: a typical edge of the elements, m.
  CuttingEdges(const CellComplex& complex, Attributes& attributes, double edge)
      : complex_(complex), finder_(complex, attributes), attributes_(attributes), edge_(edge) {}
  /// Throws InputError if its points are too far apart to be sampled.
  void add(const Edge& edge);

  // ---- a step, in this order ----

  /// Before the forces are cleared: finds where the edges are. `dt` and `last`: the lengths of
  /// this step and of the one before, s.
  void begin(std::span<const PlacedObstacle> obstacles, double dt, double last);
  /// The vertices that they may push in this step, each once.
  std::span<const Index> vertices() const { return moved_; }
  /// After the step without contact: decides what resists. `gain`: of an impulse, s.
  void engage(double gain);
  /// Pushes once with each sample; returns the largest change of a velocity, m/s.
  double sweep(double dt);
  /// Compliant obstacles end the step elsewhere. Takes all pushes back, as something has put the
  /// vertices back.
  void release(std::span<const PlacedObstacle> obstacles);
  /// Adds what the edges of a compliant obstacle push (tool.hpp).
  void add_pushed_by(std::size_t obstacle, std::vector<Tool::Pushed>& pushed) const;
  /// After the last sweep: how far each sample has advanced.
  void finish();

  /// What a sample has done in the step.
  struct Grip {
    Grip(std::size_t of, const ContactPoint& point, Attributes& attributes)
        : sample(of), mass(point, attributes) {}
    std::size_t sample;
    PointMass mass;
    Vec3 tangent{}, direction{};  ///< of the edge, and in which it cuts
    double limit = 0;             ///< of the impulse, N s
    Vec3 change{};                ///< of the velocity of the tissue there, m/s
    /// N s
    Vec3 impulse() const {
      const Vec3& m = mass.mass();
      return {m[0] * change[0], m[1] * change[1], m[2] * change[2]};
    }
  };
  std::span<const Grip> grips() const { return grips_; }
  std::size_t obstacle(const Grip& grip) const { return samples_[grip.sample].obstacle; }
  /// Returns the velocity of the edge in the step, m/s.
  Vec3 velocity(const Grip& grip) const { return samples_[grip.sample].velocity; }

  void forget_places() { finder_.forget(); }
  /// An edge has divided elements: copies from `first` on resist it no more.
  void divided(std::size_t edge, Index first);
  void follow(const TopologyChange& change);
  void state(Archive& archive);

 private:
  /// Around a place on a corner there are eight elements.
  using Elements = std::array<Index, 8>;
  struct Sample {
    std::size_t edge, obstacle;
    Vec3 given, given_tangent;
    double length;  ///< of the edge, m
    // Known only during a step.
    Vec3 start{}, end{}, tangent{}, velocity{};
    std::vector<Vec3> at{};  ///< in its elements
    Vec3 rest{};             ///< where the tissue there is at rest
  };
  /// What an element was when the first sample came into it.
  struct Entered {
    Index element;
    std::uint8_t open;  ///< bits of sides without a neighbour
  };

  /// Where the slit of a sample ends.
  struct Tip {
    Vec3 at{}, direction{};  ///< of the last advance; at rest
    Index element = none;
    std::uint8_t has_moved = 0;  ///< in the last step
  };
  /// An element that a sample has crossed, and that is still whole.
  struct Passed {
    Index sample, element;
    auto operator<=>(const Passed&) const = default;
  };

  void place(std::span<const PlacedObstacle> obstacles);
  void find_elements(std::size_t sample);
  bool is_between_lips(std::size_t sample, Index element, Vec3& at) const;
  void add_weights(const Elements& elements, const std::vector<Vec3>& at);
  void enter();
  bool resists(std::size_t sample, std::size_t place, const Vec3& direction) const;
  bool divides(const Sample& sample) const { return edges_[sample.edge].has_material != nullptr; }
  void find_tip(std::size_t sample);
  bool has_passed(std::size_t sample, Index element) const;
  bool has_material(const Sample& sample, Index element, const Vec3& at) const;
  double toughness(std::size_t sample) const;
  Vec3 gap(const Grip& grip) const;
  bool holds(const Grip& grip) const;
  std::uint8_t open_sides(Index element) const;

  const CellComplex& complex_;
  ElementFinder finder_;
  Attributes& attributes_;
  double edge_;
  std::vector<Edge> edges_;
  std::vector<std::vector<std::uint8_t>> is_divided_;  ///< of each edge by it, by element
  std::vector<Sample> samples_;
  // What samples remember.
  std::vector<Elements> elements_;       ///< in which they are, `none` at the end
  std::vector<Vec3> directions_;         ///< of the last advance; zero: none in this tissue
  std::vector<double> withdrawn_;        ///< from the tip of the slit, m
  std::vector<std::uint8_t> has_begun_;  ///< to cut this tissue
  std::vector<Entered> entered_;         ///< ascending
  std::vector<Tip> tips_;                ///< of edges that divide elements, by sample
  std::vector<Passed> passed_;           ///< by these, ascending
  // Known only during a step.
  std::vector<std::size_t> first_;  ///< of each grip, in the next two
  std::vector<Index> vertices_;
  std::vector<double> weights_;
  std::vector<std::size_t> gripping_;  ///< samples
  std::vector<Grip> grips_;
  std::vector<Index> moved_;
  double dt_ = 0;
};

}  // namespace suture
