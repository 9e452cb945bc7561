// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "kernel/live/live_server.hpp"
#include "kernel/live/plots.hpp"
#include "kernel/live/shown_surface.hpp"
#include "kernel/run/simulation.hpp"

namespace suture {

/// What a page writes beside the body.
struct LiveStatus {
  bool is_playing = false, has_ended = false, has_failed = false;
  std::string remedy{};  ///< what the page offers after a failure; "": nothing
  double speed = 1;      ///< wanted: simulated per real time; 0: as fast as possible
  double steps_per_second = 0, real_time = 0;  ///< reached
  struct Device {
    std::string name;                                       ///< "": there is none
    Vec3 place{};                                           ///< of the hand in the scene, m
    Vec3 rotation{};                                        ///< vector, rad
    Vec3 force{};                                           ///< on the hand, N
    double poses_per_second = 0, exchanges_per_second = 0;  ///< with the device, with the run
  } device{};
  struct Held {
    Vec3 place{}, force{};  ///< of the body on the hand, N; m in the scene
  };
  std::optional<Held> hand{};  ///< the mouse's
};

/// Makes the pictures of a run (docs/live.md has the format of their messages).
class Pictures {
 public:
  /// `first_number`: surfaces are numbered from there on.
  Pictures(Simulation& simulation, std::uint64_t first_number);

  /// What never changes: title, origin, fields, plots, obstacles.
  nlohmann::json greeting() const;
  /// Shows another field from now on. Throws InputError if there is none of this name.
  void choose(const std::string& field);
  /// Takes the values of the plots, which the next picture has, at most ten times per second and a
  /// fiftieth of the time. O(elements). Throws NumericalError if one is not finite.
  void plot();
  /// O(boundary), and the cost of the field.
  LivePicture picture(const LiveStatus& status);
  /// Call after the simulation has loaded a state.
  void find_surface_again() { surface_.find_again(); }
  /// The mean length of the edges of the elements at rest, m.
  double edge_length() const { return edge_length_; }
  std::uint64_t last_number() const { return last_number_; }

 private:
  std::string surface_message();
  std::string state_message(const LiveStatus& status);

  Simulation& simulation_;
  ShownSurface surface_;
  Plots plots_;
  std::chrono::steady_clock::time_point next_plot_;
  std::vector<double> plotted_;
  std::vector<FieldChoice> fields_;
  std::size_t field_ = 0;
  std::uint64_t first_number_, last_number_;
  std::shared_ptr<const std::string> surface_text_;
  double edge_length_;
};

}  // namespace suture
