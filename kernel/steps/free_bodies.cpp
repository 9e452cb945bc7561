// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/steps/free_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/dynamics/free_motions.hpp"

namespace suture {
namespace {

constexpr std::size_t max_reported = 3;

/// Gravity and loads after their ramps, in rows of 4.
std::vector<double> final_forces(const Scene& scene, BuiltScene& built) {
  const Attributes& attributes = built.body().attributes();
  std::vector<double> force(4 * std::size_t{attributes.vertex_count()});
  const double end = built.body().last_change();
  for (const auto& term : built.body().loads()) term->add_forces(end, {}, force.data());
  for (Index v = 0; v < attributes.vertex_count(); ++v)
    for (std::size_t c = 0; c < 3; ++c)
      force[4 * std::size_t{v} + c] +=
          built.body().attributes().mass().get(v, 0) * scene.gravity[c];
  return force;
}

std::vector<FreePiece> free_pieces(const Scene& scene, BuiltScene& built) {
  return find_free_pieces(built.body().complex(), built.body().attributes(),
                          final_forces(scene, built));
}

std::string describe(const FreePiece& piece) {
  std::ostringstream text;
  text << (piece.elements == 1 ? "a piece of 1 element" : "a piece of ");
  if (piece.elements != 1) text << piece.elements << " elements";
  text << " (the first: element " << piece.first_element << ") is free to " << piece.motions();
  return text.str();
}

std::string resultant_text(const FreePiece& piece) {
  std::ostringstream text;
  text << "gravity and loads act on it with a resultant of (" << piece.force[0] << ", "
       << piece.force[1] << ", " << piece.force[2] << ") N";
  return text.str();
}

/// The translations along which it is pushed.
bool forces_allow_motion(BuiltScene& built, const FreePiece& piece) {
  const Vec3& f = piece.force;
  return suture::forces_allow_motion(built.body(), piece, {f[0] != 0, f[1] != 0, f[2] != 0});
}

}  // namespace

void check_free_bodies(const Scene& scene, BuiltScene& built, Diagnostics& diagnostics) {
  const std::vector<FreePiece> pieces = free_pieces(scene, built);
  for (const FreePiece& piece : pieces) {
    if (!piece.is_pushed() || scene.solver.end || !scene.events.empty()) continue;
    if (built.body().contact()) continue;  // an obstacle may hold it
    if (!forces_allow_motion(built, piece)) continue;
    throw InputError(
        "/constraints: " + describe(piece) + ", and " + resultant_text(piece) +
        ", so it never comes to rest; constrain it, balance the loads, or give /solver/end");
  }
  const std::string contact = built.body().contact() ? ", unless contact holds it" : "";
  for (std::size_t i = 0; i < std::min(pieces.size(), max_reported); ++i)
    diagnostics.warn("/constraints: " + describe(pieces[i]) + contact +
                     (pieces[i].is_pushed() ? "; " + resultant_text(pieces[i]) : std::string()));
  if (pieces.size() > max_reported)
    diagnostics.warn("/constraints: " + std::to_string(pieces.size() - max_reported) +
                     " more pieces are unconstrained");
}

std::string describe_unheld_body(BuiltScene& built) {
  return built.body().contact() ? "" : describe_body_without_constraints(built);
}

std::string describe_body_without_constraints(BuiltScene& built) {
  const std::vector<FreePiece> pieces = find_unheld_pieces(built.body());
  return pieces.empty() ? "" : describe(pieces.front());
}

std::vector<std::string> HeldPieces::added(BuiltScene& built) {
  std::vector<std::string> texts;
  for (const FreePiece& piece : find_unheld_pieces(built.body())) {
    if (std::ranges::find(known_, piece.first_element) != known_.end()) continue;
    known_.push_back(piece.first_element);
    texts.push_back(describe(piece) +
                    "; inertia relief holds it: accelerations as a rigid body balance its loads");
  }
  return texts;
}

void HeldPieces::state(Archive& archive) { archive("known", known_); }

std::string describe_falling_body(const Scene& scene, BuiltScene& built) {
  if (built.body().contact()) return "";  // onto an obstacle, perhaps
  for (const Event& event : scene.events)
    if (event.finish() > built.dynamics().time()) return "";
  for (const FreePiece& piece : free_pieces(scene, built))
    if (piece.is_pushed() && forces_allow_motion(built, piece))
      return describe(piece) + ", and " + resultant_text(piece);
  return "";
}

}  // namespace suture
