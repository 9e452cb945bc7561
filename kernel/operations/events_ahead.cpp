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
  bool counts;  ///< faces of planes

  Faces operator()(const CutPlane& plane) const {
    if (plane.along_blade) return {};
    const ElementBlocks* const blocks = call.blocks();
    if (!counts) return {};
    const PlanePatch patch{plane.point, plane.normal, plane.radius, plane.polygon};
    return all_at_once(faces_across_patch(complex(), call.shape(), patch, 4, blocks).size());
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
    if (pierce.where)
      select(*pierce.where, call.event.rest_shape);
    else
      call.blocks();
    return {};
  }
  Faces operator()(const SewFaces& sew) const {
    if (sew.between)
      for (const Selection& side : *sew.between) select(side, false);
    if (sew.where) select(*sew.where, true);
    return {};
  }
  template <class Other>
  Faces operator()(const Other&) const {
    return {};
  }

  void select(const Selection& where, bool at_rest) const {
    if (!where.is_listed()) call.blocks(at_rest);
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
  // Where many planes and blades cross, or miss the body, room for all would be more than it takes.
  const Index elements = body.complex().existing(3);
  Index at_once = 0, largest = 0, faces = 0;
  const auto most = [&] { return largest + elements / 8; };
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const Event& event = scene_.events[i];
    const Call call{*this, event, static_cast<std::uint32_t>(i), 0, states_[i]};
    const Ahead::Faces of_event = std::visit(Ahead{call, faces <= most()}, event.what);
    at_once = std::max(at_once, of_event.at_once);
    largest = std::max(largest, of_event.in_all);
    faces = std::min(faces + of_event.in_all, most() + 1);
    if (operates(event)) body.islands();
    if (removes(event)) removals_.find_holders();
  }
  if (faces != 0) body.make_room(std::min(faces, most()), at_once);
}

}  // namespace suture
