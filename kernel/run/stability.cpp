// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/stability.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "kernel/base/vec3.hpp"
#include "kernel/steps/free_bodies.hpp"

namespace suture {
namespace {

/// A product with the tangent takes about as long as five steps.
unsigned products_for(std::uint64_t steps) {
  return static_cast<unsigned>(std::clamp<std::uint64_t>(steps / 16, 180, 1500));
}

Index vertex_of_largest(const LowestMode& mode) {
  const auto longer = [](const Vec3& a, const Vec3& b) { return dot(a, a) < dot(b, b); };
  return static_cast<Index>(std::ranges::max_element(mode.shape, longer) - mode.shape.begin());
}

}  // namespace

/// The forces f that are left turn with a body that nothing holds, which gives its rotations
/// eigenvalues of about f / (mass of a vertex, root of their number, radius).
double Stability::rounding_of_rest(double unbalanced_force) const {
  const Column& mass = built_.body().attributes().mass();
  double total = 0, count = 0;
  for (Index v = 0; v < built_.body().attributes().vertex_count(); ++v) {
    total += mass.get(v, 0);
    count += mass.get(v, 0) > 0;
  }
  return 4 * unbalanced_force * std::sqrt(count) / (total * built_.selector().diagonal());
}

Stability::Verdict Stability::examine(double unbalanced_force, std::uint64_t steps, double time,
                                      const Vec3& gravity) {
  if (!built_.body().has_free_vertices()) {
    lowest_.reset();
    return Verdict::stable;
  }
  if (built_.body().contact()) {
    lowest_.reset();
    diagnostics_.warn(
        "the stability of the equilibrium was not checked: the tangent does not "
        "include contact");
    return Verdict::unknown;
  }
  const ForceLoop& forces = built_.body().models();
  if (!forces.has_tangent()) {
    lowest_.reset();
    diagnostics_.warn("the stability of the equilibrium was not checked: " +
                      forces.without_tangent() + " has no tangent (suture.tangent/1)");
    return Verdict::unknown;
  }
  LowestMode mode = find_lowest_mode(built_.body(), time, products_for(steps));
  mode.noise += rounding_of_rest(unbalanced_force);
  lowest_ = mode.eigenvalue;
  neutral_ = mode.eigenvalue <= 10 * mode.noise;
  if (!mode.negative()) {
    if (neutral_ && describe_body_without_constraints(built_).empty())
      diagnostics_.warn(describe_neutral(mode));
    return Verdict::stable;
  }
  built_.dynamics().synchronise();
  recorder_.mode(time, gravity, mode.shape);
  // A column under a load that follows it can be stable far above its Euler load (Beck), so a
  // negative eigenvalue of the symmetric part proves nothing.
  const bool is_proof = built_.body().is_conservative(time);
  std::string text = describe(mode, is_proof);
  if (scene_.solver.kick > 0 && kicks_ < max_kicks) {
    ++kicks_;
    std::ostringstream push;
    push << "; displaced along the mode by " << scene_.solver.kick << " m (/solver/kick)";
    diagnostics_.warn(text + push.str());
    kick(mode);
    return Verdict::kicked;
  }
  if (built_.dynamics().is_static())
    text += "; disturb the symmetry of the loads or the mesh to reach the stable equilibrium";
  else if (kicks_ == 0)
    text += "; set /solver/kick, a displacement along the mode in m, to continue from here";
  else
    text += "; " + std::to_string(kicks_) +
            " kicks along such modes have not led to a stable equilibrium";
  diagnostics_.warn(text);
  return is_proof ? Verdict::unstable : Verdict::unknown;
}

/// "the mode is largest at element 12 at (0, 0.1, 0.2) m"
std::string Stability::place_of(const LowestMode& mode) const {
  const Index vertex = vertex_of_largest(mode);
  const Column& x = built_.body().attributes().position();
  std::ostringstream text;
  text << "the mode is largest at element "
       << built_.element_name(element_of(built_.body().complex().dart_of(0, vertex))) << " at "
       << built_.place_text({x.get(vertex, 0), x.get(vertex, 1), x.get(vertex, 2)});
  return text.str();
}

std::string Stability::describe_neutral(const LowestMode& mode) const {
  std::ostringstream text;
  text << "the equilibrium is not unique: constraints hold the body, but the lowest eigenvalue of "
          "the tangent is zero ("
       << mode.eigenvalue << " 1/s^2, with an accuracy of " << 10 * mode.noise
       << "), so that nothing resists a motion along its mode, and another path may end elsewhere "
          "with the same energy; "
       << place_of(mode)
       << "; use a model that resists every deformation (springs alone do not), or hold the body "
          "against the mode";
  return text.str();
}

std::string Stability::describe(const LowestMode& mode, bool is_proof) const {
  std::ostringstream text;
  if (!is_proof)
    text << "the equilibrium may be unstable: the symmetric part of the tangent has the "
            "eigenvalue "
         << mode.eigenvalue
         << " 1/s^2 (the whole is not symmetric: a pressure acts up to a free edge, or a model has "
            "no energy)";
  else
    text << "the equilibrium is unstable: the lowest eigenvalue of the tangent is "
         << mode.eigenvalue << " 1/s^2, so a disturbance grows at " << std::sqrt(-mode.eigenvalue)
         << " 1/s";
  text << "; " << place_of(mode);
  if (const std::string file = recorder_.mode_collection(); !file.empty())
    text << "; see the field \"unstable_mode\" of " << file;
  return text.str();
}

void Stability::kick(const LowestMode& mode) {
  built_.dynamics().jump([&] {
    Column& x = built_.body().attributes().position();
    for (Index v = 0; v < x.size(); ++v)
      for (int c = 0; c < 3; ++c)
        x.set(v, c, x.get(v, c) + scene_.solver.kick * mode.shape[v][static_cast<std::size_t>(c)]);
  });
}

std::string Stability::text() const {
  std::ostringstream text;
  if (!lowest_) return "the equilibrium is stable because every node is prescribed";
  if (neutral_) return "the equilibrium is neutral: the lowest eigenvalue of the tangent is zero";
  text << "the equilibrium is stable: the tangent has no eigenvalue below " << *lowest_ << " 1/s^2";
  if (*lowest_ > 0) text << " (" << std::sqrt(*lowest_) / (2 * std::numbers::pi) << " Hz)";
  return text.str();
}

void Stability::state(Archive& archive) {
  archive("lowest", lowest_);
  archive("neutral", neutral_);
  archive("kicks", kicks_);
}

}  // namespace suture
