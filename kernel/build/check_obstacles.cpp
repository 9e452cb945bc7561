// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/build/check_obstacles.hpp"

#include <algorithm>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/contact/contact.hpp"
#include "kernel/contact/overlap.hpp"
#include "kernel/contact/piece_overlap.hpp"
#include "kernel/dynamics/integrator.hpp"

namespace suture {
namespace {

// In sizes of the body: obstacles that stay farther away are probably in other units.
constexpr double far_away = 100;

std::string describe(const Overlap& overlap, const BuiltScene& built, const Contact& contact) {
  std::ostringstream text;
  if (overlap.vertices == 0) {
    text << "lies inside the body: " << built.place_text(overlap.place)
         << " is a point of both; move it out of the body";
    return text.str();
  }
  text << "overlaps the body at the start: " << overlap.vertices
       << (overlap.vertices == 1 ? " node is" : " nodes are") << " inside"
       << (contact.thickness() > 0 ? " or closer than /contact/thickness" : "")
       << ", the deepest by " << overlap.depth << " m (" << overlap.depth / contact.shortest_edge()
       << " of the shortest edge) at " << built.place_text(overlap.place)
       << "; move it by that much, or set \"push_out\": true to push the body out slowly";
  return text.str();
}

/// The smallest distance between the balls around the obstacle, at its stations, and the body.
double closest(const Obstacle& obstacle, const Vec3& middle, double size) {
  std::vector<double> times{0};
  for (const RigidPath::Station& station : obstacle.motion.stations) times.push_back(station.at);
  double distance = std::numeric_limits<double>::infinity();
  for (const double time : times)
    distance =
        std::min(distance, PlacedObstacle(obstacle, 0, time, time).gap(middle).distance - size / 2);
  return distance;
}

void warn_of_far_obstacle(const Obstacle& obstacle, const Contact& contact, const Vec3& middle,
                          Diagnostics& diagnostics) {
  const double distance = closest(obstacle, middle, contact.size());
  if (!(distance > far_away * contact.size())) return;
  std::ostringstream text;
  text << obstacle.path << ": stays at least " << distance
       << " m away from the body, whose size is " << contact.size()
       << " m; check its place and units";
  diagnostics.warn(text.str());
}

/// Only nodes touch obstacles: what is narrower than a face can lie between them.
void warn_of_narrow_obstacle(const Obstacle& obstacle, const Contact& contact,
                             Diagnostics& diagnostics) {
  if (!obstacle.pushes) return;
  const double found = width(obstacle.shape) + 2 * contact.thickness();
  if (!(found < contact.mean_edge())) return;
  std::ostringstream text;
  text << obstacle.path << ": is " << found << " m wide"
       << (contact.thickness() > 0 ? " with /contact/thickness" : "")
       << ", less than a face of the body, whose typical edge is " << contact.mean_edge()
       << " m; only nodes touch obstacles, so it may enter between them without any force. Use "
          "elements of at most "
       << found << " m where it touches, or an obstacle that is at least " << contact.mean_edge()
       << " m wide";
  diagnostics.warn(text.str());
}

/// What makes the steps shorter, and what else helps.
std::string shorter_steps(const SolverOptions& solver) {
  if (solver.integrator == "static") return "give more \"frames\" in /solver/static";
  if (is_implicit(solver.integrator)) return "move it more slowly, or reduce /solver/dt";
  return "move it more slowly, reduce /solver/dt, or set it to \"auto\", which follows the "
         "obstacle";
}

std::string describe_pieces(const PieceOverlap& overlap, const BuiltScene& built, Body& body,
                            double edge, const char* when) {
  std::ostringstream text;
  text << "/contact: the piece of element " << body.user_element(overlap.elements[0])
       << " and that of element " << body.user_element(overlap.elements[1]) << " overlap at the "
       << when << ": " << overlap.vertices << (overlap.vertices == 1 ? " node is" : " nodes are")
       << " inside the other, the deepest by " << overlap.depth << " m (" << overlap.depth / edge
       << " of a typical edge) at " << built.place_text(overlap.place);
  return text.str();
}

}  // namespace

std::string too_fast(const Obstacle& obstacle, const ContactLaw& contact,
                     const SolverOptions& solver, double time) {
  if (!solver.dt || !obstacle.motion.moves()) return "";
  const double moving = obstacle.motion.last_change() - obstacle.motion.stations.front().at;
  const double way = contact.top_speed(obstacle, time) * std::min(*solver.dt, moving);
  if (!(way > contact.shortest_edge())) return "";
  std::ostringstream text;
  text << "moves by up to " << way << " m "
       << (solver.integrator == "static" ? "between two equilibria" : "in a step of /solver/dt")
       << ", more than an element (the shortest edge at the boundary is " << contact.shortest_edge()
       << " m), so it could jump over the surface; " << shorter_steps(solver);
  return text.str();
}

void check_pieces(BuiltScene& built, const Contact& contact, Diagnostics& diagnostics) {
  if (!contact.pieces()) return;
  Body& body = built.body();
  const double edge = contact.mean_edge();
  std::string mistakes;
  for (const PieceOverlap& overlap :
       find_piece_overlaps(contact, body.complex(), body.attributes())) {
    const std::string text = describe_pieces(overlap, built, body, edge, "start");
    if (overlap.depth < PieceContact::max_depth * edge)
      diagnostics.warn(text + "; contact pushes them apart slowly, or move one by that much");
    else
      mistakes += (mistakes.empty() ? "" : "\n") + text +
                  "; too deep to be pushed apart, so move one of them by that much";
  }
  if (!mistakes.empty()) throw InputError(mistakes);
}

std::string deep_overlaps(BuiltScene& built) {
  Body& body = built.body();
  const auto* law = dynamic_cast<const Contact*>(body.contact());
  if (!law || !law->pieces()) return "";
  const Contact& contact = *law;
  const double edge = contact.mean_edge();
  std::string lines;
  for (const PieceOverlap& overlap :
       find_piece_overlaps(contact, body.complex(), body.attributes(), PieceContact::max_depth))
    lines += (lines.empty() ? "" : "\n") + describe_pieces(overlap, built, body, edge, "end") +
             "; they met too fast for contact to keep them apart, so give /solver/dt a smaller "
             "value";
  return lines;
}

void check_obstacles(BuiltScene& built, const Contact& contact, Diagnostics& diagnostics) {
  Body& body = built.body();
  std::string mistakes;
  const auto complain = [&](const Obstacle& obstacle, const std::string& text) {
    if (text.empty()) return;
    mistakes += (mistakes.empty() ? "" : "\n") + obstacle.path + ": " + text;
  };
  for (const Overlap& overlap : find_overlaps(contact, body.complex(), body.attributes(), 0)) {
    const Obstacle& obstacle = contact.obstacles()[overlap.obstacle];
    if (overlap.vertices == 0 || !obstacle.push_out)
      complain(obstacle, describe(overlap, built, contact));
  }
  const Box box = contact.box();
  const Vec3 middle{(box.low[0] + box.high[0]) / 2, (box.low[1] + box.high[1]) / 2,
                    (box.low[2] + box.high[2]) / 2};
  for (const Obstacle& obstacle : contact.obstacles()) {
    complain(obstacle, too_fast(obstacle, contact, built.scene().solver, 0));
    warn_of_far_obstacle(obstacle, contact, middle, diagnostics);
  }
  if (!mistakes.empty()) throw InputError(mistakes);
  for (const Obstacle& obstacle : contact.obstacles())
    warn_of_narrow_obstacle(obstacle, contact, diagnostics);
}

}  // namespace suture
