// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kernel/events/removal_watch.hpp"
#include "kernel/events/tear.hpp"
#include "kernel/scene/built_scene.hpp"

namespace suture {

class MovingBlade;
class SurfaceBlade;

/// The effect of an operation.
struct EventOutcome {
  Index faces_cut = 0, faces_torn = 0, faces_sewn = 0, elements_removed = 0;
  bool changed() const { return faces_cut + faces_torn + faces_sewn + elements_removed > 0; }
  EventOutcome& operator+=(const EventOutcome& other);
  /// "cut 25 faces"; "" if nothing was changed.
  std::string text() const;
};

/// Applies the operations of a scene's events to a built scene: finds the cells that each affects
/// (kernel/events) and passes them to cut(), pierce() or sew().
class EventRunner : private Follower {
 public:
  /// Throws InputError for invalid lists and selections before anything has run.
  EventRunner(const Scene& scene, BuiltScene& built, Diagnostics& diagnostics);
  ~EventRunner() override;

  /// Applies event `i` of the scene now. If that is not possible, throws InputError or
  /// NumericalError that begins with the path of the event, and nothing has changed. Warns of an
  /// event without effect (for a repeating event: once, at the end).
  EventOutcome fire(std::size_t i, double time);
  /// The same for an event from C++ that is not part of the scene. Its coordinates are those of the
  /// body's frame.
  EventOutcome apply(const Event& event, double time);
  /// Call after a rollback to `time`; no operation has changed the body since then.
  void go_back(double time);
  /// Warns of events that had no effect in the whole run.
  void finish();
  void state(Archive& archive);

 private:
  struct Call;  // one operation in progress
  /// What an event keeps between calls, depending on its operation.
  struct State {
    std::unique_ptr<TearCheck> tear;
    std::unique_ptr<SurfaceBlade> surface;
    std::unique_ptr<MovingBlade> blade;
    bool came = false, had_effect = false;
    bool told_misfits = false;
  };

  State prepare(const Event& event);
  void check(const Event& event);
  void check_pairs(const Event& event, const SewFaces& sew) const;
  /// Updates the stored positions of the tissue.
  void follow(const CellComplex& complex, const TopologyChange& change) override;

  const Scene& scene_;
  BuiltScene& built_;
  Diagnostics& diagnostics_;
  RemovalWatch removals_;
  std::vector<State> states_;  ///< by event
};

}  // namespace suture
