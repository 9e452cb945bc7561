// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "kernel/operations/event_call.hpp"
#include "kernel/operations/plane_patch.hpp"

namespace suture {
namespace {

/// Whether events of this kind change the cells.
bool operates(const Event& event) {
  return !std::holds_alternative<Grasp>(event.what) && !std::holds_alternative<Release>(event.what);
}

bool removes(const Event& event) {
  return std::holds_alternative<Pierce>(event.what) ||
         std::holds_alternative<RemoveIslands>(event.what);
}

}  // namespace

/// Builds the lists that a search by place needs, and returns about how many faces the event opens
/// at once, and in the whole run: those that a plane or a list separates now; others depend on the
/// motion.
struct EventRunner::Ahead {
  struct Faces {
    Index at_once = 0, in_all = 0;
  };
  Call call;

  Faces operator()(const CutPlane& plane) const {
    if (plane.along_blade) return {};
    const PlanePatch patch{plane.point, plane.normal, plane.radius, plane.polygon};
    return all_at_once(faces_across_patch(complex(), call.shape(), patch, 4, call.blocks()).size());
  }
  Faces operator()(const CutFaces& listed) const {
    return all_at_once(listed.element_pairs.size());
  }
  Faces operator()(const CutSurface&) const {
    if (call.state.patch) return {};
    call.blocks();
    return all_at_once(across());
  }
  Faces operator()(const CutBlade& cut) const { return {0, cut.along_blade ? 0 : across()}; }
  Faces operator()(const Tear&) const { return {0, across()}; }
  Faces operator()(const Pierce& pierce) const {
    if (!pierce.where || !pierce.where->is_listed()) call.blocks();
    return {};
  }
  template <class Other>
  Faces operator()(const Other&) const {
    return {};
  }

  const CellComplex& complex() const { return call.built.body().complex(); }
  /// By a cut through a cube of as many elements.
  Index across() const { return static_cast<Index>(std::pow(complex().existing(3), 2. / 3)); }
  static Faces all_at_once(std::size_t faces) {
    return {static_cast<Index>(faces), static_cast<Index>(faces)};
  }
};

void EventRunner::make_ready() {
  Body& body = built_.body();
  std::uint64_t faces = 0;
  Index largest = 0;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const Event& event = scene_.events[i];
    const Call call{*this, event, static_cast<std::uint32_t>(i), 0, states_[i]};
    const Ahead::Faces of_event = std::visit(Ahead{call}, event.what);
    faces += of_event.in_all;
    largest = std::max(largest, of_event.at_once);
    if (operates(event)) body.islands();
    if (removes(event)) removals_.find_holders();
  }
  const std::uint64_t all = std::uint64_t{3} * body.complex().existing(3);
  if (faces != 0) body.make_room(static_cast<Index>(std::min(faces, all)), largest);
}

}  // namespace suture
