// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/scene/event.hpp"

#include <cmath>
#include <sstream>

namespace suture {
namespace {

// What an event acts on, per kind of operation.
struct What {
  std::string operator()(const CutPlane& cut) const {
    const bool bounded = cut.radius < std::numeric_limits<double>::infinity();
    const std::string blade = bounded ? "a disc" : cut.polygon.empty() ? "a plane" : "a polygon";
    return cut.along_blade ? "along " + blade : "the faces crossed by " + blade;
  }
  std::string operator()(const CutSurface& cut) const {
    const std::string triangles = "the triangles of " + cut.file.filename().string();
    return cut.along_blade ? "along " + triangles : "the faces that " + triangles + " separate";
  }
  std::string operator()(const CutBlade& cut) const {
    if (cut.carried)
      return (cut.along_blade
                  ? "along the blade of obstacle '" + cut.carried->name + "'"
                  : "the faces that the blade of obstacle '" + cut.carried->name + "' crosses") +
             (cut.resistance ? ", against the resistance of the tissue" : "");
    return (cut.along_blade ? "along a blade of " : "the faces that a blade of ") +
           std::to_string(cut.stations.front().points.size()) + " points " +
           (cut.along_blade ? "" : "crosses ") + "as it moves through the tissue";
  }
  std::string operator()(const CutFaces& cut) const {
    return std::to_string(cut.element_pairs.size()) + " listed faces";
  }
  std::string operator()(const Pierce& pierce) const {
    return pierce.where ? "the elements of a selection" : "the elements along a path";
  }
  std::string operator()(const Tear& tear) const {
    static constexpr const char* values[] = {"the largest principal strain of each element",
                                             "the elongation of each edge", ""};
    const std::string field =
        tear.model + "/" + tear.field + ", computed by the model at each check";
    return "faces by " +
           (tear.by == Tear::By::field ? field : values[static_cast<std::size_t>(tear.by)]);
  }
  std::string operator()(const SewFaces& sew) const {
    return sew.between                 ? "boundary faces between two selections"
           : sew.element_pairs.empty() ? "faces that were cut"
                                       : std::to_string(sew.element_pairs.size()) + " listed faces";
  }
  std::string operator()(const RemoveIslands&) const {
    return "islands, tracked through all operations";
  }
  std::string operator()(const Grasp& grasp) const {
    return "'" + grasp.held.name + "', nodes where they are then";
  }
  std::string operator()(const Release& release) const { return "'" + release.name + "'"; }
};

}  // namespace

std::string Event::summary() const {
  std::ostringstream text;
  text << operation() << ' ' << std::visit(What{}, what);
  if (std::holds_alternative<CutBlade>(what)) {
    text << ", every step from " << start() << " s";
    if (std::isfinite(finish())) text << " until " << finish() << " s";
  } else if (every > 0) {
    text << ", every " << every << (every == 1 ? " step" : " steps") << " from " << from << " s";
    if (until) text << " until " << *until << " s";
  } else if (when) {
    text << ", as soon as a condition holds, checked every " << when->every
         << (when->every == 1 ? " step" : " steps");
  } else {
    text << ", at " << at << " s";
  }
  return text.str();
}

const char* Event::operation() const {
  static constexpr const char* names[] = {
      "cut", "cut", "cut", "cut", "pierce", "tear", "suture", "remove_islands", "grasp", "release"};
  static_assert(std::size(names) == std::variant_size_v<EventOperation>);
  return names[what.index()];
}

double Event::start() const {
  if (const auto* blade = std::get_if<CutBlade>(&what))
    return blade->carried ? 0 : blade->stations.front().at;
  return every > 0 ? from : when ? 0 : at;
}

double Event::finish() const {
  if (const auto* blade = std::get_if<CutBlade>(&what); blade && blade->stations.size() > 1)
    return blade->stations.back().at;
  if (std::holds_alternative<CutBlade>(what)) return std::numeric_limits<double>::infinity();
  if (every > 0) return until.value_or(std::numeric_limits<double>::infinity());
  if (when) return std::numeric_limits<double>::infinity();
  const auto* grasp = std::get_if<Grasp>(&what);
  return grasp ? at + grasp->held.end() : at;
}

}  // namespace suture
