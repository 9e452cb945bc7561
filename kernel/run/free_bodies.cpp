// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/free_bodies.hpp"

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

/// Whether models leave the translations that `matters(c)` names alone: not those with springs to
/// the ground.
template <class Matters>
bool models_allow_motion(BuiltScene& built, const FreePiece& piece, Matters matters) {
  if (!built.body().models().has_tangent()) return false;
  const std::size_t size = 3 * std::size_t{built.body().attributes().vertex_count()};
  const auto largest_image = [&](auto value) {
    std::vector<double> direction(size), image(size);
    for (std::size_t i = 0; i < size; ++i) direction[i] = value(i);
    built.body().add_tangent(direction.data(), 1, 0, 0, image.data());
    double largest = 0;
    for (const double f : image) largest = std::max(largest, std::abs(f));
    return largest;
  };
  const double stiff = largest_image([](std::size_t i) { return i * 7 % 5 < 2 ? 1.0 : -1.0; });
  for (std::size_t c = 0; c < 3; ++c) {
    if (piece.translations[c] && matters(c) &&
        largest_image([&](std::size_t i) { return i % 3 == c ? 1.0 : 0.0; }) > 1e-8 * stiff)
      return false;
  }
  return true;
}

/// The translations along which it is pushed.
bool models_allow_motion(BuiltScene& built, const FreePiece& piece) {
  return models_allow_motion(built, piece, [&](std::size_t c) { return piece.force[c] != 0; });
}

}  // namespace

void check_free_bodies(const Scene& scene, BuiltScene& built, Diagnostics& diagnostics) {
  const std::vector<FreePiece> pieces = free_pieces(scene, built);
  for (const FreePiece& piece : pieces) {
    if (!piece.is_pushed() || scene.solver.end || !scene.events.empty()) continue;
    if (!models_allow_motion(built, piece)) continue;
    throw InputError(
        "/constraints: " + describe(piece) + ", and " + resultant_text(piece) +
        ", so it never comes to rest; constrain it, balance the loads, or give /solver/end");
  }
  for (std::size_t i = 0; i < std::min(pieces.size(), max_reported); ++i)
    diagnostics.warn("/constraints: " + describe(pieces[i]) +
                     (pieces[i].is_pushed() ? "; " + resultant_text(pieces[i]) : std::string()));
  if (pieces.size() > max_reported)
    diagnostics.warn("/constraints: " + std::to_string(pieces.size() - max_reported) +
                     " more pieces are unconstrained");
}

std::string describe_unheld_body(const Scene& scene, BuiltScene& built) {
  for (const FreePiece& piece : free_pieces(scene, built))
    if (models_allow_motion(built, piece, [](std::size_t) { return true; })) return describe(piece);
  return "";
}

std::string describe_falling_body(const Scene& scene, BuiltScene& built) {
  for (const Event& event : scene.events)
    if (event.finish() > built.dynamics().time()) return "";
  for (const FreePiece& piece : free_pieces(scene, built))
    if (piece.is_pushed() && models_allow_motion(built, piece))
      return describe(piece) + ", and " + resultant_text(piece);
  return "";
}

}  // namespace suture
