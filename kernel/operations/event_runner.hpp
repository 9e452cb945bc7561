// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kernel/build/built_scene.hpp"
#include "kernel/operations/cut_area.hpp"
#include "kernel/operations/debris.hpp"
#include "kernel/operations/removal_watch.hpp"
#include "kernel/operations/tear.hpp"

namespace suture {

/// A side of a face that an event opened. Both sides are listed.
struct OpenedFace {
  Dart side = none;         ///< any dart of it
  std::uint32_t event = 0;  ///< by place in the scene; none for an event from C++
  double time = 0;          ///< s
  void state(Archive& archive);
};

/// A blade as it is now, in coordinates of the body's frame.
struct BladeShape {
  std::uint32_t event = 0;  ///< by place in the scene
  std::vector<Vec3> points;
  std::vector<std::array<Index, 3>> triangles;  ///< of a surface; empty: the points are a polyline
};

class MovingBlade;
class SurfaceBlade;
class SurfacePatch;
class SweptSheet;

/// The effect of an operation.
struct EventOutcome {
  Index faces_cut = 0, faces_torn = 0, faces_sewn = 0, elements_removed = 0;
  Index nodes_held = 0, nodes_released = 0;
  Index elements_cut = 0;                     ///< along the blade
  Index elements_sewn = 0;                    ///< that such cuts had divided
  std::vector<std::array<Index, 2>> faces{};  ///< the elements on both sides of each face
  std::vector<Index> removed{};               ///< elements, those of debris, too
  RemovedMatter debris{};
  CutArea area{};
  /// Why a moving blade has gone no further, after all that is listed here; null: it has.
  std::exception_ptr refusal{};
  bool changed() const {
    return faces_cut + faces_torn + faces_sewn + elements_removed + elements_cut + elements_sewn +
               nodes_held + nodes_released >
           0;
  }
  EventOutcome& operator+=(const EventOutcome& other);
  /// Archives all that operator+= adds up.
  void state(Archive& archive);
  /// "cut 25 faces"; "" if nothing was changed.
  std::string text() const;
};

/// Applies the operations of a scene's events to a built scene: finds the cells that each affects
/// (kernel/operations) and passes them to cut(), pierce() or sew().
class EventRunner : private Follower {
 public:
  /// Throws InputError for invalid lists and selections before anything has run.
  EventRunner(const Scene& scene, BuiltScene& built, Diagnostics& diagnostics);
  ~EventRunner() override;

  /// Builds, before the run, what the first events of the scene would build: lists for searches by
  /// place, the islands, room for the cells that cuts add. O(elements), if there are such events.
  void make_ready();
  /// Applies event `i` of the scene now. If that is not possible, throws InputError or
  /// NumericalError that begins with the path of the event, and nothing has changed. Warns of an
  /// event without effect (for a repeating event: once, at the end).
  EventOutcome fire(std::size_t i, double time);
  /// The same for an event from C++ that is not part of the scene. Its coordinates are those of the
  /// body's frame.
  EventOutcome apply(const Event& event, double time);
  /// Whether a call of fire() or apply() that has thrown `error` was refused: nothing has changed,
  /// and the state is sound. Otherwise, the body or its state is at fault.
  bool is_refusal(const Error& error) const;
  /// Whether the last such call has changed the body.
  bool has_changed() const { return has_changed_; }
  /// All debris that was removed, and which islands are.
  const RemovedMatter& removed_debris() const { return removed_debris_; }
  const Debris& debris() const { return debris_; }
  /// Call after a rollback to `time`; no operation has changed the body since then.
  void roll_back(double time);
  /// Warns of events that had no effect in the whole run.
  void finish();
  /// What cuts and tears opened so far, in order; sewn faces and those of removed elements stay in
  /// the list. Empty unless the scene asks for it (/output/cuts).
  const std::vector<OpenedFace>& opened() const { return opened_; }
  /// The moving blades that are present at `time`, and the surfaces that have not cut before it.
  std::vector<BladeShape> blades(double time) const;
  void state(Archive& archive);
  /// Of it, what steps change without an operation: saved with the motion, before which a rollback
  /// needs roll_back().
  void motion(Archive& archive);

 private:
  struct Call;  // one operation in progress
  struct Ahead;
  /// What an event keeps between calls, depending on its operation.
  struct State {
    std::unique_ptr<TearCheck> tear;
    std::unique_ptr<SurfaceBlade> surface;
    std::unique_ptr<SurfacePatch> patch;  ///< instead, if the cut is along it
    std::unique_ptr<MovingBlade> blade;
    std::unique_ptr<SweptSheet> sheet;  ///< of the blade, if the cut is along it
    std::optional<std::size_t> edge{};  ///< of the blade, if tissue resists it
    bool has_fired = false, had_effect = false;
    double last = 0;  ///< s, when it last fired
    bool reported_misfits = false;
  };

  State prepare(const Event& event, bool is_applied = false);
  MovingBlade blade_of(const CutBlade& cut) const;
  std::vector<Vec3> points_of(const CutBlade::Carried& carried, double time) const;
  void check(const Event& event);
  void check_pairs(const Event& event, const SewFaces& sew) const;
  EventOutcome call(const Event& event, std::uint32_t number, double time, State& state);
  void remove_debris(const Event& event, double time, EventOutcome& outcome);
  void before(const ComingOperation&) override { is_changing_ = true; }
  /// Updates the stored positions of the tissue.
  void follow(const CellComplex& complex, const TopologyChange& change) override;

  const Scene& scene_;
  BuiltScene& built_;
  Diagnostics& diagnostics_;
  RemovalWatch removals_;
  Debris debris_;
  RemovedMatter removed_debris_;
  bool has_changed_ = false, is_changing_ = false;  ///< in the last call
  std::vector<State> states_;                       ///< by event
  std::vector<OpenedFace> opened_;
  std::uint32_t applied_ = 0;  ///< events that are not part of the scene
};

}  // namespace suture
