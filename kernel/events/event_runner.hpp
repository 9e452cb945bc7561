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

/// What an operation did.
struct EventOutcome {
  Index faces_cut = 0, faces_torn = 0, faces_sewn = 0, elements_removed = 0;
  bool changed() const { return faces_cut + faces_torn + faces_sewn + elements_removed > 0; }
  EventOutcome& operator+=(const EventOutcome& other);
  /// "cut 25 faces"; "" if nothing was changed.
  std::string text() const;
};

/// Makes the operations of a scene's events happen to a built: finds what each is
/// about (kernel/events), and hands that to cut(), pierce() or sew().
class EventRunner : private Follower {
 public:
  /// Throws InputError for lists and selections that cannot be meant, before
  /// anything has run.
  EventRunner(const Scene& scene, BuiltScene& built, Diagnostics& diagnostics);
  ~EventRunner() override;

  /// Event `i` of the scene, now. What cannot be done throws InputError or
  /// NumericalError beginning with the event's path, and then nothing has happened;
  /// what has no effect warns (a look that repeats: at the end, once).
  EventOutcome fire(std::size_t i, double time);
  /// The same for any operation, from C++: an event that is in no scene. Coordinates are
  /// those of the built's frame.
  EventOutcome apply(const Event& event, double time);
  /// The body is as it was at `time`, when no operation has changed it since.
  void go_back(double time);
  /// Warns of events that had no effect in the whole run.
  void finish();
  void state(Archive& archive);

 private:
  struct Call;  // one operation on its way
  /// What an event keeps from one time to the next, by its operation.
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
  /// What events remember of the tissue.
  void follow(const CellComplex& complex, const TopologyChange& change) override;

  const Scene& scene_;
  BuiltScene& built_;
  Diagnostics& diagnostics_;
  RemovalWatch removals_;
  std::vector<State> states_;  ///< by event
};

}  // namespace suture
