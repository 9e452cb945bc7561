// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "kernel/geometry/surface.hpp"
#include "kernel/scene/cell_values.hpp"
#include "kernel/scene/constraint.hpp"
#include "kernel/scene/selection.hpp"

namespace suture {

// The operations of events: one struct each.

/// Opens the faces between elements on different sides of a plane: all of them, or those where the
/// plane is crossed inside the disc or the polygon.
struct CutPlane {
  Vec3 point, normal;
  double radius = std::numeric_limits<double>::infinity();  ///< of a disc around `point`, m
  std::vector<Vec3> polygon{};                              ///< in the plane, m; empty: unbounded
  /// The cut is where the plane is, and divides the elements that it crosses.
  bool along_blade = false;
};

/// Opens the faces that a triangulated surface separates.
struct CutSurface {
  std::filesystem::path file;                        ///< absolute
  double scale = 1;                                  ///< of the coordinates in the file
  Vec3 translation{};                                ///< m, after scaling
  std::shared_ptr<const TriangleSurface> surface{};  ///< instead of a file; an event from outside
  bool along_blade = false;                          ///< as of CutPlane
};

/// Opens the faces that a moving segment or polyline crosses; every point moves along a straight
/// line between stations. One station: a blade that is stationary from then on. Or it is fixed to
/// an obstacle.
struct CutBlade {
  struct Station {
    double at = 0;               ///< s
    std::vector<Vec3> points{};  ///< m, the same number at every station
  };
  std::vector<Station> stations{};  ///< or
  struct Carried {
    std::size_t obstacle = 0;    ///< by place in /contact/obstacles
    std::string name{};          ///< of the obstacle
    std::vector<Vec3> points{};  ///< m, where they are relative to its shape as given
  };
  std::optional<Carried> carried{};
  /// What the tissue resists a carried blade with (contact/cutting_edges.hpp); none: it gives way.
  struct Resistance {
    CellValues toughness{};            ///< of elements, J/m^2
    double stress = 0, thickness = 0;  ///< Pa, m: their product begins a cut, N/m
  };
  std::optional<Resistance> resistance{};
  bool along_blade = false;  ///< as of CutPlane
};

/// Opens listed faces.
struct CutFaces {
  std::vector<std::array<std::uint64_t, 2>>
      element_pairs;  ///< user ids of the elements on both sides
};

/// Removes elements: those selected, or those around a polyline.
struct Pierce {
  std::optional<Selection> where;  ///< or
  std::vector<Vec3> path;          ///< m
  double radius = 0;               ///< m, from the polyline to the centroid
};

/// Opens faces where a value exceeds a threshold (operations/tear.hpp).
struct Tear {
  enum class By { principal_strain, elongation, field };
  By by = By::principal_strain;
  std::string model, field;  ///< for By::field: the name of the instance and its output
  double above = 0;          ///< in the unit of the value
  std::optional<Selection> where;
  /// Fraction of the faces between the elements that one check may open.
  double max_fraction = 0.25;
};

/// 3-sews boundary faces (operations/match_faces.hpp).
struct SewFaces {
  std::vector<std::array<std::uint64_t, 2>> element_pairs;  ///< user ids; or
  std::optional<std::array<Selection, 2>> between;          ///< with
  double gap = 0;                                           ///< m; or
  std::optional<Selection> where;  ///< rejoins what was cut there; none: everywhere
};

/// Removes whole islands that have too few elements, too little volume or have left a box. One of
/// the conditions that are given suffices.
struct RemoveIslands {
  std::uint64_t below = 0;                    ///< elements; 0: no limit
  double volume = 0;                          ///< m^3, at rest; 0: no limit
  std::optional<Selection::InBox> outside{};  ///< in the deformed shape
};

/// Holds nodes from where they are, and moves them by what `held` says: its selection acts on the
/// deformed shape, and its times count from the grasp. Or holds what an obstacle touches, and moves
/// it with the obstacle.
struct Grasp {
  Constraint held;
  std::optional<std::size_t> obstacle{};  ///< by place in /contact/obstacles
  std::optional<double> reach{};          ///< m: how far from the obstacle nodes may be
};

/// Lets go of the nodes of a grasp or a constraint, with the velocities that they have.
struct Release {
  std::string name;
};

using EventOperation = std::variant<CutPlane, CutSurface, CutBlade, CutFaces, Pierce, Tear,
                                    SewFaces, RemoveIslands, Grasp, Release>;

// The times of events.

/// True while a component of the mean over some nodes is above (or below) a bound.
struct Condition {
  enum class Of { displacement, velocity, position };
  Selection where;
  Of of = Of::displacement;
  int component = 3;  ///< 0 x, 1 y, 2 z, 3 the magnitude of the mean
  bool above = true;
  double bound = 0;         ///< m or m/s
  Vec3 zero{};              ///< m: the origin for the magnitude of a position
  std::uint64_t every = 1;  ///< steps between checks
};

/// What happens when an event cannot be carried out: nothing has changed then.
enum class OnFailure { by_solver, skip, stop };

/// One event: at a given time, every n steps, or as soon as a condition holds; for a moving blade,
/// at every step from its first station to its last.
struct Event {
  double at = 0;                  ///< s; or
  std::uint64_t every = 0;        ///< steps, if > 0,
  double from = 0;                ///< s,
  std::optional<double> until{};  ///< s; or
  std::optional<Condition> when{};
  EventOperation what;
  bool rest_shape = false;                      ///< "shape": "rest"
  OnFailure on_failure = OnFailure::by_solver;  ///< takes precedence over the solver's
  std::string path;                             ///< "/events/0"

  /// The key in the scene: "cut", "pierce", "grasp", ...
  const char* operation() const;
  /// May have an effect in many steps.
  bool repeats() const { return every > 0 || std::holds_alternative<CutBlade>(what); }
  bool is_timed() const { return !repeats() && !when; }
  bool is_hold() const {
    return std::holds_alternative<Grasp>(what) || std::holds_alternative<Release>(what);
  }
  bool is_along_blade() const {
    const auto is_along = [](const auto* cut) { return cut != nullptr && cut->along_blade; };
    return is_along(std::get_if<CutPlane>(&what)) || is_along(std::get_if<CutSurface>(&what)) ||
           is_along(std::get_if<CutBlade>(&what));
  }
  /// "pierce, every 4 steps from 0.5 s: ...", for `suture explain`.
  std::string summary() const;
  /// The first and the last time at which it can happen, s.
  double start() const;
  double finish() const;  ///< infinite if unknown
};

}  // namespace suture
