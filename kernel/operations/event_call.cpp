// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/event_call.hpp"

#include <algorithm>
#include <utility>

#include "kernel/base/error.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/base/rows.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/forces/contact_law.hpp"
#include "kernel/geometry/moving_blade.hpp"
#include "kernel/geometry/surface_blade.hpp"
#include "kernel/operations/islands.hpp"
#include "kernel/operations/pierce_path.hpp"
#include "kernel/operations/plane_patch.hpp"
#include "kernel/operations/reunite.hpp"
#include "kernel/operations/sew_embedded.hpp"
#include "kernel/operations/swept_sheet.hpp"
#include "kernel/parts/coarse_parts.hpp"

namespace suture {

const double* EventRunner::Call::rows(bool at_rest) const {
  Attributes& a = built.body().attributes();
  return (at_rest ? a.rest() : a.position()).rows();
}

const double* EventRunner::Call::shape() const { return rows(event.rest_shape); }

const ElementBlocks& EventRunner::Call::blocks(bool at_rest) const {
  return at_rest ? built.body().blocks_at_rest() : built.dynamics().motion().blocks();
}

const ElementBlocks* EventRunner::Call::blocks() const { return &blocks(event.rest_shape); }

std::vector<Index> EventRunner::Call::elements_now(const Selection& selection, bool at_rest) const {
  return built.selector().elements_now(selection, rows(at_rest),
                                       selection.is_listed() ? nullptr : &blocks(at_rest));
}

void EventRunner::Call::warn(const std::string& text) const {
  runner.diagnostics_.warn(timed(time, event.path + text));
}

void EventRunner::Call::warn_once(const std::string& text) const {
  if (event.every == 0) warn(text);
}

EventOutcome EventRunner::Call::opened(const std::vector<Dart>& faces) const {
  EventOutcome outcome;
  if (!faces.empty()) outcome.faces_cut = cut_now(faces, outcome);
  return outcome;
}

Index EventRunner::Call::cut_now(const std::vector<Dart>& faces, EventOutcome& outcome) const {
  for (const Dart side : faces) {
    const Dart other = built.body().complex().beta3(side);
    outcome.faces.push_back({element_of(side), element_of(other)});
    if (!runner.scene_.output.cuts) continue;
    for (const Dart d : {side, other}) runner.opened_.push_back({d, number, time});
  }
  if (built.is_embedded()) open_sides(faces);
  return built.body().cut(faces).faces_cut;
}

void EventRunner::Call::open_sides(const std::vector<Dart>& faces) const {
  for (const Dart side : faces)
    for (const Dart d : {side, built.body().complex().beta3(side)})
      built.embedded_parts().open(d, cut_number());
}

Index EventRunner::Call::cut_number() const {
  return number != none ? number
                        : static_cast<Index>(runner.scene_.events.size() + runner.applied_);
}

EventOutcome EventRunner::Call::cut(const std::vector<Dart>& faces) const {
  if (faces.empty()) warn_once(" cut no face: the blade misses the body" + or_is_cut());
  return opened(faces);
}

std::string EventRunner::Call::or_is_cut() const {
  return built.body().complex().has_operated() ? ", or the faces there have already been cut" : "";
}

const Workers* EventRunner::Call::workers() const { return &built.body().models().workers(); }

EventOutcome EventRunner::Call::operator()(const CutPlane& plane) const {
  const PlanePatch patch{plane.point, plane.normal, plane.radius, plane.polygon};
  if (plane.along_blade) return cut_along_blade(PlaneBlade(patch));
  CutArea area;
  EventOutcome outcome =
      cut(faces_across_patch(built.body().complex(), shape(), patch, 4, blocks(), &area));
  if (outcome.changed()) outcome.area = area;
  warn_of_area(outcome);
  return outcome;
}

EventOutcome EventRunner::Call::operator()(const CutSurface&) const {
  if (state.patch) return cut_along_blade(*state.patch);
  const Places places{shape()};
  const std::vector<Dart> faces =
      state.surface->faces_cut(built.body().complex(), places, workers(), blocks());
  if (faces.empty() && !event.every)
    warn(" cut no face: " + why_nothing_was_cut(state.surface->box(), built.body().complex(),
                                                places, built.frame().origin));
  return opened(faces);
}

EventOutcome EventRunner::Call::operator()(const CutBlade& cut) const {
  if (cut.carried) state.blade->carry_to(time, runner.points_of(*cut.carried, time));
  if (cut.along_blade) return cut_along_sheet();
  return opened(state.blade->advance(built.body().complex(),
                                     Places{built.body().attributes().position().rows()}, time,
                                     workers()));
}

EventOutcome EventRunner::Call::operator()(const CutFaces& listed) const {
  const ListedFaces faces = faces_of(listed);
  report_pairs("has already been cut", "have already been cut", faces.already_cut);
  report_pairs("was removed with an element", "were removed with an element", faces.removed);
  return opened(faces.faces);
}

void EventRunner::Call::report_pairs(const char* one, const char* many,
                                     const std::vector<ElementPair>& pairs) const {
  if (pairs.empty()) return;
  warn_once("/cut/faces: " + std::to_string(pairs.size()) + " of the faces " +
            (pairs.size() == 1 ? one : many) + ", the first between elements " +
            std::to_string(pairs[0][0]) + " and " + std::to_string(pairs[0][1]));
}

ListedFaces EventRunner::Call::faces_of(const CutFaces& listed) const {
  return faces_between(
      built.body().complex(), event.path + "/cut/faces", listed.element_pairs,
      [&](std::uint64_t id) { return built.selector().element_with_id(id); },
      built.body().user_vertex());
}

EventOutcome EventRunner::Call::operator()(const Pierce& pierce) const {
  return remove(pierce.where ? elements_now(*pierce.where, event.rest_shape)
                             : elements_along_path(built.body().complex(), shape(), pierce.path,
                                                   pierce.radius, 4, blocks()),
                " removed no element: there are none left where it pierces");
}

EventOutcome EventRunner::Call::operator()(const RemoveIslands& islands) const {
  std::vector<Index> elements;
  if (islands.below > 0 || islands.outside)
    elements =
        elements_of_islands(built.body().complex(), built.body().islands(), shape(), islands);
  if (islands.volume > 0) {
    const std::vector<Index> small = elements_of_small_islands(built, islands.volume);
    elements.insert(elements.end(), small.begin(), small.end());
    sort_unique(elements);
  }
  return remove(elements, " removed no island: all are large enough and inside the region");
}

EventOutcome EventRunner::Call::operator()(const Grasp& grasp) const {
  EventOutcome outcome;
  outcome.nodes_held = built.grasp(grasp, time, timed(time, event.path + "/grasp"));
  return outcome;
}

EventOutcome EventRunner::Call::operator()(const Release& release) const {
  EventOutcome outcome;
  outcome.nodes_released = built.release(release.name, timed(time, event.path + "/release"));
  return outcome;
}

EventOutcome EventRunner::Call::operator()(const SewFaces& sew) const {
  EventOutcome outcome;
  if (built.is_embedded()) outcome.elements_sewn = sew_divided(sew);
  const std::vector<Seam> seams = seams_of(sew);
  if (seams.empty()) {
    if (!state.reported_misfits && !outcome.changed())
      warn_once(" sewed no face: " + why_none(sew));
    return outcome;
  }
  outcome.faces_sewn = sew_now(seams).faces_sewn;
  for (const Seam& seam : seams)
    outcome.faces.push_back({element_of(seam.one), element_of(seam.other)});
  return outcome;
}

TopologyChange EventRunner::Call::sew_now(const std::vector<Seam>& seams) const {
  if (built.is_embedded()) {
    std::vector<Index> elements;
    for (const auto& [one, other] : seams)
      elements.insert(elements.end(), {element_of(one), element_of(other)});
    built.embedded_parts().join(seams);
    built.embedded_parts().coarsen(built.body().complex(), elements, 0);
  }
  return built.body().sew(seams);
}

EventOutcome EventRunner::Call::operator()(const Tear&) const {
  EventOutcome outcome;
  const std::vector<Dart> faces = state.tear->faces(built.body(), time);
  if (!faces.empty())
    outcome.faces_torn = cut_now(faces, outcome);
  else
    warn_once(" tore no face: the criterion is below its threshold everywhere");
  return outcome;
}

EventOutcome EventRunner::Call::cut_along_blade(const Blade& blade) const {
  const BladeCut cut = cut_along(built.body().complex(), built.parts(), shape(), blade);
  if (cut.empty())
    warn_once(
        " cut no element: the blade misses the body, only touches it, or holds no "
        "whole section of an element" +
        or_is_cut());
  EventOutcome outcome = divide(cut);
  warn_of_area(outcome);
  return outcome;
}

void EventRunner::Call::warn_of_area(const EventOutcome& outcome) const {
  constexpr double allowed = 0.1;
  const auto& [opened, blade] = outcome.area;
  if (std::abs(opened - blade) > allowed * blade)
    warn_once(
        " opened " + outcome.area.text() +
        ": it ends within elements, which are opened whole or not at all; a finer mesh, or an "
        "end on planes of the grid, comes nearer");
}

/// In a step, a blade may go through the whole body.
EventOutcome EventRunner::Call::cut_along_sheet() const {
  const MovingBlade& blade = *state.blade;
  EventOutcome outcome;
  if (time < blade.begin()) return outcome;
  const double from = std::clamp(state.sheet->time(), blade.begin(), time),
               to = std::max(from, std::min(time, blade.end()));
  std::vector<double> times = state.sheet->times_between(from, blade.at(from), to, blade.at(to));
  times.back() = time;
  for (const double at : times) {
    EventOutcome cut;
    runner.has_changed_ = false;
    try {
      cut = cut_to(blade.at(std::min(at, to)), at, at == time && time >= blade.end());
    } catch (const Error& error) {
      if (!outcome.changed() || !runner.is_refusal(error)) throw;
      outcome.refusal = std::current_exception();
      runner.has_changed_ = true;
      return outcome;
    }
    outcome += cut;
    outcome.faces.insert(outcome.faces.end(), cut.faces.begin(), cut.faces.end());
  }
  runner.has_changed_ = outcome.changed();
  return outcome;
}

/// What a moving blade has swept is known at rest.
EventOutcome EventRunner::Call::cut_to(const std::vector<Vec3>& edge, double at,
                                       bool is_last) const {
  const std::unique_ptr<Blade> blade = state.sheet->advance(edge, at, is_last);
  if (!blade) return {};
  BladeCut cut;
  try {
    cut = cut_along(built.body().complex(), built.parts(), built.body().attributes().rest().rows(),
                    *blade, 4, state.sheet->ties());
  } catch (...) {
    state.sheet->give_up_rows();
    throw;
  }
  state.sheet->keep(cut.heights, cut.cloning.origins);
  state.sheet->ties() = cut.ties;
  const Index first_copy = built.body().complex().element_count();
  EventOutcome outcome = divide(cut);
  sew_ties(cut.seams);
  if (state.edge) built.body().contact()->edge_divided(*state.edge, first_copy);
  return outcome;
}

EventOutcome EventRunner::Call::divide(const BladeCut& cut) const {
  EventOutcome outcome;
  if (cut.empty()) return outcome;
  outcome.faces_cut = static_cast<Index>(cut.cloning.cut.size());
  outcome.elements_cut = cut.divided;
  outcome.area = cut.area;
  for (const Dart side : cut.cloning.cut)
    outcome.faces.push_back({element_of(side), element_of(built.body().complex().beta3(side))});
  open_sides(cut.cloning.cut);
  built.body().clone_volume(cut.cloning, cut.parts, [&] {
    built.embedded_parts().refine(cut.refined);
    built.embedded_parts().append(cut.parts, cut.cloning.origins, cut_number());
    built.embedded_parts().coarsen(built.body().complex(), cut.parts.elements, many_tetrahedra);
    built.embedded_parts().coarsen(built.body().complex(), cut.refined.parts.elements,
                                   many_tetrahedra);
  });
  return outcome;
}

/// Sides that a blade has left open, and that fit to each other now: those that can be sewn
/// together are, and others stay tied. So do sides that have moved apart by half an element: sewn,
/// they would jump.
void EventRunner::Call::sew_ties(const std::vector<Seam>& seams) const {
  const CellComplex& complex = built.body().complex();
  const double* x = rows(false);
  const double most = 0.5 * state.sheet->element_size();
  const auto are_near = [&](const Seam& seam) {
    for (Dart k = 0; k < 4; ++k)
      if (norm(minus(row(x, corner_vertex(complex, seam, k)),
                     row(x, partner_vertex(complex, seam, k)))) > most)
        return false;
    return true;
  };
  SeamBatch batch(complex);
  for (const Seam& seam : seams) {
    const bool is_open = complex.beta3(seam.one) == none && complex.beta3(seam.other) == none;
    if (!is_open || !are_near(seam) || batch.add(seam))
      state.sheet->ties().push_back({seam.one, seam.other});
  }
  if (!batch.seams().empty()) sew_now(batch.seams());
}

/// Elements that blades have divided become one again, where both sides are selected.
Index EventRunner::Call::sew_divided(const SewFaces& sew) const {
  if (!sew.element_pairs.empty()) return 0;  // of elements that are whole
  Body& body = built.body();
  const std::vector<std::vector<Index>> groups = EmbeddedSewing(sew, built).groups();
  if (groups.empty()) return 0;
  const Reunion reunion = reunite(body.complex(), built.parts(), body.user_vertex(), groups);
  body.clone_volume(reunion.cloning, reunion.parts, [&] {
    built.embedded_parts().append(reunion.parts, reunion.cloning.origins);
    built.embedded_parts().join(reunion.cloning.seams);
    built.embedded_parts().coarsen(body.complex(), reunion.parts.elements, 0);
  });
  SeamBatch batch(body.complex());
  for (const Seam& seam : reunion.seams) batch.add(seam, naming());
  if (!batch.seams().empty()) sew_now(batch.seams());
  return static_cast<Index>(groups.size());
}

std::vector<Seam> EventRunner::Call::seams_of(const SewFaces& sew) const {
  const CellComplex& complex = built.body().complex();
  if (built.is_embedded() && sew.element_pairs.empty())
    return without_misfits(EmbeddedSewing(sew, built).seams(naming()));
  if (sew.between) {
    return without_misfits(
        seams_within_gap(complex, rows(false), elements_now((*sew.between)[0], false),
                         elements_now((*sew.between)[1], false), sew.gap, naming()));
  }
  if (!sew.element_pairs.empty()) return listed_seams(sew);
  std::vector<Index> where;
  if (sew.where) where = elements_now(*sew.where, true);
  if (sew.where && where.empty()) return {};
  return without_misfits(seams_of_cuts(complex, built.body().user_vertex(), where, naming()));
}

// Whoever leaves the choice of faces to us gets those that can be sewn.
std::vector<Seam> EventRunner::Call::without_misfits(MatchedSeams matched) const {
  if (!matched.misfits.empty() && !std::exchange(state.reported_misfits, true))
    warn("/suture: " + misfits_text(matched.misfits, naming()));
  return std::move(matched.seams);
}

Naming EventRunner::Call::naming() const {
  return {[this](Index e) { return std::to_string(built.element_name(e)); },
          [this](Index v) {
            return std::to_string(built.names().point_id(built.body().user_vertex()[v]));
          }};
}

std::vector<Seam> EventRunner::Call::listed_seams(const SewFaces& sew) const {
  ListedSeams listed = seams_between(
      built.body().complex(), built.body().attributes().position().rows(),
      timed(time, event.path + "/suture/faces"), sew.element_pairs,
      [&](std::uint64_t id) { return built.selector().element_with_id(id); },
      built.body().user_vertex(), naming());
  if (!listed.idle.empty() && !listed.seams.empty()) {
    warn_once("/suture/faces: " + std::to_string(listed.idle.size()) +
              " of the pairs still share a face or were removed; the first is elements " +
              std::to_string(listed.idle[0][0]) + " and " + std::to_string(listed.idle[0][1]));
  }
  return std::move(listed.seams);
}

std::string EventRunner::Call::why_none(const SewFaces& sew) {
  if (sew.between) return "no face of one side is within the gap of a face of the other";
  return sew.element_pairs.empty() ? "no cut face is open there"
                                   : "all pairs already share a face or were removed";
}

EventOutcome EventRunner::Call::remove(const std::vector<Index>& elements,
                                       const char* nothing) const {
  EventOutcome outcome;
  if (elements.empty()) {
    warn_once(nothing);
    return outcome;
  }
  if (elements.size() >= built.body().complex().existing(3)) {
    throw InputError(timed(time, event.path + ": " + event.operation()) + " would remove all " +
                     std::to_string(elements.size()) +
                     " remaining elements; nothing was removed. Make the selection smaller");
  }
  runner.removals_.before(elements);
  const TopologyChange change = built.body().pierce(elements);
  outcome.elements_removed = static_cast<Index>(change.removed[3].size());
  outcome.removed = change.removed[3];
  for (const std::string& loss : runner.removals_.after())
    warn(' ' + std::string(event.operation()) + ' ' + loss);
  return outcome;
}

}  // namespace suture
