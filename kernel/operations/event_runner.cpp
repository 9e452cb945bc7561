// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/event_runner.hpp"

#include <utility>

#include "kernel/base/error.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/forces/contact_law.hpp"
#include "kernel/geometry/moving_blade.hpp"
#include "kernel/geometry/surface_blade.hpp"
#include "kernel/geometry/surface_file.hpp"
#include "kernel/operations/cut_along.hpp"
#include "kernel/operations/cut_faces.hpp"
#include "kernel/operations/islands.hpp"
#include "kernel/operations/match_faces.hpp"
#include "kernel/operations/pierce_path.hpp"
#include "kernel/operations/plane_patch.hpp"
#include "kernel/operations/reunite.hpp"
#include "kernel/operations/sew_embedded.hpp"
#include "kernel/operations/swept_sheet.hpp"

namespace suture {
// ------------------------------------------------------------ operations --

/// One operation on its way: everything it needs, and an overload per kind.
struct EventRunner::Call {
  EventRunner& runner;
  const Event& event;
  std::uint32_t number;  ///< of the event in the scene, or none
  double time;
  State& state;
  BuiltScene& built = runner.built_;

  const double* rows(bool at_rest) const {
    Attributes& a = built.body().attributes();
    return (at_rest ? a.rest() : a.position()).rows();
  }
  const double* shape() const { return rows(event.rest_shape); }
  const ElementBlocks& blocks(bool at_rest) const {
    return at_rest ? built.body().blocks_at_rest() : built.dynamics().motion().blocks();
  }
  const ElementBlocks* blocks() const { return &blocks(event.rest_shape); }
  std::vector<Index> elements_now(const Selection& selection, bool at_rest) const {
    return built.selector().elements_now(selection, rows(at_rest),
                                         selection.is_listed() ? nullptr : &blocks(at_rest));
  }
  void warn(const std::string& text) const {
    runner.diagnostics_.warn(timed(time, event.path + text));
  }
  /// Warns about an event that happens once; finish() reports repeated events after the run.
  void warn_once(const std::string& text) const {
    if (event.every == 0) warn(text);
  }

  EventOutcome opened(const std::vector<Dart>& faces) const {
    EventOutcome outcome;
    if (!faces.empty()) outcome.faces_cut = cut_now(faces, outcome);
    return outcome;
  }
  Index cut_now(const std::vector<Dart>& faces, EventOutcome& outcome) const {
    for (const Dart side : faces) {
      const Dart other = built.body().complex().beta3(side);
      outcome.faces.push_back({element_of(side), element_of(other)});
      if (!runner.scene_.output.cuts) continue;
      for (const Dart d : {side, other}) runner.opened_.push_back({d, number, time});
    }
    if (built.is_embedded()) open_sides(faces);
    return built.body().cut(faces).faces_cut;
  }
  /// Both sides of each belong to the cut.
  void open_sides(const std::vector<Dart>& faces) const {
    for (const Dart side : faces)
      for (const Dart d : {side, built.body().complex().beta3(side)})
        built.embedded_parts().open(d, cut_number());
  }
  /// Those of events that are not part of the scene follow.
  Index cut_number() const {
    return number != none ? number
                          : static_cast<Index>(runner.scene_.events.size() + runner.applied_);
  }
  EventOutcome cut(const std::vector<Dart>& faces) const {
    if (faces.empty()) warn_once(" cut no face: the blade misses the body" + or_is_cut());
    return opened(faces);
  }
  /// What else it can be that nothing is cut, once anything has been done to the map.
  std::string or_is_cut() const {
    return built.body().complex().has_operated() ? ", or the faces there have already been cut"
                                                 : "";
  }
  const Workers* workers() const { return &built.body().models().workers(); }

  EventOutcome operator()(const CutPlane& plane) const {
    const PlanePatch patch{plane.point, plane.normal, plane.radius, plane.polygon};
    if (plane.along_blade) return cut_along_blade(PlaneBlade(patch));
    return cut(faces_across_patch(built.body().complex(), shape(), patch, 4, blocks()));
  }

  EventOutcome cut_along_blade(const Blade& blade) const;
  EventOutcome cut_along_sheet() const;
  EventOutcome cut_to(const std::vector<Vec3>& edge, double at, bool is_last) const;
  EventOutcome divide(const BladeCut& cut) const;

  EventOutcome operator()(const CutSurface&) const {
    if (state.patch) return cut_along_blade(*state.patch);
    const Places places{shape()};
    const std::vector<Dart> faces =
        state.surface->faces_cut(built.body().complex(), places, workers(), blocks());
    if (faces.empty() && !event.every)
      warn(" cut no face: " + why_nothing_was_cut(state.surface->box(), built.body().complex(),
                                                  places, built.frame().origin));
    return opened(faces);
  }

  EventOutcome operator()(const CutBlade& cut) const {
    if (cut.carried) state.blade->carry_to(time, runner.points_of(*cut.carried, time));
    if (cut.along_blade) return cut_along_sheet();
    return opened(state.blade->advance(built.body().complex(),
                                       Places{built.body().attributes().position().rows()}, time,
                                       workers()));
  }

  EventOutcome operator()(const CutFaces& listed) const {
    const ListedFaces faces = faces_of(listed);
    report_pairs("has already been cut", "have already been cut", faces.already_cut);
    report_pairs("was removed with an element", "were removed with an element", faces.removed);
    return opened(faces.faces);
  }
  void report_pairs(const char* one, const char* many,
                    const std::vector<ElementPair>& pairs) const {
    if (pairs.empty()) return;
    warn_once("/cut/faces: " + std::to_string(pairs.size()) + " of the faces " +
              (pairs.size() == 1 ? one : many) + ", the first between elements " +
              std::to_string(pairs[0][0]) + " and " + std::to_string(pairs[0][1]));
  }
  ListedFaces faces_of(const CutFaces& listed) const {
    return faces_between(
        built.body().complex(), event.path + "/cut/faces", listed.element_pairs,
        [&](std::uint64_t id) { return built.selector().element_with_id(id); },
        built.body().user_vertex());
  }

  EventOutcome operator()(const Pierce& pierce) const {
    return remove(pierce.where ? elements_now(*pierce.where, event.rest_shape)
                               : elements_along_path(built.body().complex(), shape(), pierce.path,
                                                     pierce.radius, 4, blocks()),
                  " removed no element: there are none left where it pierces");
  }

  EventOutcome operator()(const RemoveIslands& islands) const {
    return remove(
        elements_of_islands(built.body().complex(), built.body().islands(), shape(), islands),
        " removed no island: all are large enough and inside the region");
  }

  EventOutcome operator()(const Grasp& grasp) const {
    EventOutcome outcome;
    outcome.nodes_held = built.grasp(grasp, time, timed(time, event.path + "/grasp"));
    return outcome;
  }
  EventOutcome operator()(const Release& release) const {
    EventOutcome outcome;
    outcome.nodes_released = built.release(release.name, timed(time, event.path + "/release"));
    return outcome;
  }

  EventOutcome remove(const std::vector<Index>& elements, const char* nothing) const;

  EventOutcome operator()(const SewFaces& sew) const {
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

  TopologyChange sew_now(const std::vector<Seam>& seams) const {
    if (built.is_embedded()) built.embedded_parts().join(seams);
    return built.body().sew(seams);
  }
  Index sew_divided(const SewFaces& sew) const;
  std::vector<Seam> seams_of(const SewFaces& sew) const;

  std::vector<Seam> without_misfits(MatchedSeams matched) const;

  Naming naming() const;

  std::vector<Seam> listed_seams(const SewFaces& sew) const;

  static std::string why_none(const SewFaces& sew);

  EventOutcome operator()(const Tear&) const {
    EventOutcome outcome;
    const std::vector<Dart> faces = state.tear->faces(built.body(), time);
    if (!faces.empty())
      outcome.faces_torn = cut_now(faces, outcome);
    else
      warn_once(" tore no face: the criterion is below its threshold everywhere");
    return outcome;
  }
};

EventOutcome EventRunner::Call::cut_along_blade(const Blade& blade) const {
  const BladeCut cut =
      cut_along(built.body().complex(), built.parts(), shape(), blade, event.path + "/cut/along");
  if (cut.empty())
    warn_once(
        " cut no element: the blade misses the body, only touches it, or holds no "
        "whole section of an element" +
        or_is_cut());
  return divide(cut);
}

/// In a step, a blade may go through the whole body.
EventOutcome EventRunner::Call::cut_along_sheet() const {
  const MovingBlade& blade = *state.blade;
  EventOutcome outcome;
  if (time < blade.begin()) return outcome;
  const double from = std::clamp(state.sheet->time(), blade.begin(), time),
               to = std::max(from, std::min(time, blade.end()));
  const int parts = state.sheet->rows_between(blade.at(from), blade.at(to));
  for (int i = 1; i <= parts; ++i) {
    const double at = i < parts ? from + (to - from) * i / parts : time;
    const EventOutcome cut =
        cut_to(blade.at(std::min(at, to)), at, i == parts && time >= blade.end());
    outcome += cut;
    outcome.faces.insert(outcome.faces.end(), cut.faces.begin(), cut.faces.end());
  }
  return outcome;
}

/// What a moving blade has swept is known at rest.
EventOutcome EventRunner::Call::cut_to(const std::vector<Vec3>& edge, double at,
                                       bool is_last) const {
  if (!state.sheet->advance(edge, at, is_last)) return {};
  const BladeCut cut =
      cut_along(built.body().complex(), built.parts(), built.body().attributes().rest().rows(),
                *state.sheet, event.path + "/cut/along", 4, state.sheet->ties());
  state.sheet->keep(cut.heights, cut.cloning.origins);
  state.sheet->ties() = cut.ties;
  const Index first_copy = built.body().complex().element_count();
  EventOutcome outcome = divide(cut);
  if (state.edge) built.body().contact()->edge_divided(*state.edge, first_copy);
  return outcome;
}

EventOutcome EventRunner::Call::divide(const BladeCut& cut) const {
  EventOutcome outcome;
  if (cut.empty()) return outcome;
  outcome.faces_cut = static_cast<Index>(cut.cloning.cut.size());
  outcome.elements_cut = cut.divided;
  for (const Dart side : cut.cloning.cut)
    outcome.faces.push_back({element_of(side), element_of(built.body().complex().beta3(side))});
  open_sides(cut.cloning.cut);
  built.body().clone_volume(cut.cloning, cut.parts, [&] {
    built.embedded_parts().refine(cut.refined);
    built.embedded_parts().append(cut.parts, cut.cloning.origins, cut_number());
  });
  if (!cut.seams.empty()) sew_now(cut.seams);
  return outcome;
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

/// Cells by the numbers of the user's mesh.
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

// ---------------------------------------------------------------- runner --

EventRunner::EventRunner(const Scene& scene, BuiltScene& built, Diagnostics& diagnostics)
    : scene_(scene), built_(built), diagnostics_(diagnostics), removals_(scene, built) {
  std::size_t edges = 0;
  for (const Event& event : scene.events) {
    states_.push_back(prepare(event));
    const auto* blade = std::get_if<CutBlade>(&event.what);
    if (blade && blade->resistance) states_.back().edge = edges++;
  }
  built.body().add_follower(*this);
}

EventRunner::~EventRunner() = default;

/// Events that are not part of the scene look at elements nearby only.
EventRunner::State EventRunner::prepare(const Event& event, bool is_applied) {
  State state;
  check(event);
  if (const auto* tear = std::get_if<Tear>(&event.what)) {
    const bool in_blocks = is_applied && tear->where && !tear->where->is_listed();
    std::vector<Index> elements;
    if (tear->where)
      elements = built_.selector().elements(*tear->where,
                                            in_blocks ? &built_.body().blocks_at_rest() : nullptr);
    state.tear = std::make_unique<TearCheck>(*tear, elements, event.path + "/tear");
  }
  try {
    if (const auto* cut = std::get_if<CutSurface>(&event.what)) {
      TriangleSurface surface =
          cut->surface ? *cut->surface : read_triangles(cut->file, cut->scale);
      for (Vec3& p : surface.points)
        for (std::size_t c = 0; c < 3; ++c) p[c] += cut->translation[c];
      if (cut->along_blade)
        state.patch = std::make_unique<SurfacePatch>(std::move(surface));
      else
        state.surface = std::make_unique<SurfaceBlade>(std::move(surface), diagnostics_);
    } else if (const auto* blade = std::get_if<CutBlade>(&event.what)) {
      state.blade = std::make_unique<MovingBlade>(blade_of(*blade));
      if (blade->along_blade)
        state.sheet =
            std::make_unique<SweptSheet>(built_.body().complex(), built_.body().attributes(),
                                         state.blade->at(state.blade->begin()));
    }
  } catch (const InputError& error) {
    throw InputError(event.path + "/cut: " + error.what());
  }
  return state;
}

// Lists and sets that the mesh does not have are mistakes in the scene, reported before
// anything runs. What geometry selects is known when the event fires.
void EventRunner::check(const Event& event) {
  const auto check_names = [&](const Selection& selection) {
    if (selection.is_listed()) built_.selector().elements(selection);
  };
  if (const auto* faces = std::get_if<CutFaces>(&event.what)) {
    State unused;
    Call{*this, event, none, 0, unused}.faces_of(*faces);
  } else if (const auto* pierce = std::get_if<Pierce>(&event.what)) {
    if (pierce->where) check_names(*pierce->where);
  } else if (const auto* grasp = std::get_if<Grasp>(&event.what)) {
    if (grasp->held.where.is_listed()) built_.selector().vertices(grasp->held.where);
  } else if (const auto* sew = std::get_if<SewFaces>(&event.what)) {
    if (sew->where) check_names(*sew->where);
    if (sew->between)
      for (const Selection& selection : *sew->between) check_names(selection);
    check_pairs(event, *sew);
  }
}

void EventRunner::check_pairs(const Event& event, const SewFaces& sew) const {
  for (std::size_t i = 0; i < sew.element_pairs.size(); ++i)
    for (const std::uint64_t id : sew.element_pairs[i])
      if (built_.selector().element_with_id(id) == none)
        throw InputError(event.path + "/suture/faces/" + std::to_string(i) +
                         ": the mesh has no element " + std::to_string(id));
}

// Tissue that was sewn has jumped, and not past a blade.
void EventRunner::follow(const CellComplex& complex, const TopologyChange& change) {
  const bool sewn = change.faces_sewn != 0;
  for (State& state : states_) {
    if (state.tear && (sewn || !change.removed[3].empty())) state.tear->invalidate(change.copies);
    if (state.sheet) state.sheet->follow(change);
    if (state.blade && sewn)
      state.blade->reset();
    else if (state.blade)
      state.blade->follow(complex, change);
  }
}

EventOutcome EventRunner::fire(std::size_t i, double time) {
  const Event& event = scene_.events[i];
  const EventOutcome outcome =
      std::visit(Call{*this, event, static_cast<std::uint32_t>(i), time, states_[i]}, event.what);
  states_[i].had_effect |= outcome.changed();
  states_[i].has_fired = true;
  states_[i].last = time;
  return outcome;
}

EventOutcome EventRunner::apply(const Event& event, double time) {
  if (std::holds_alternative<CutBlade>(event.what))
    throw InputError(
        event.path +
        "/cut: a moving blade cannot be applied at one instant; add it to the scene as an event");
  State state = prepare(event, true);
  const EventOutcome outcome = std::visit(Call{*this, event, none, time, state}, event.what);
  ++applied_;
  return outcome;
}

// A blade knows where the tissue was at its last step.
void EventRunner::roll_back(double time) {
  const Places places{built_.body().attributes().position().rows()};
  for (std::size_t i = 0; i < states_.size(); ++i) {
    State& state = states_[i];
    if (state.sheet) state.sheet->roll_back(time);
    if (!state.blade || state.sheet || !state.has_fired) continue;
    state.blade->reset();
    const auto* cut = std::get_if<CutBlade>(&scene_.events[i].what);
    if (cut->carried) state.blade->carry_to(time, points_of(*cut->carried, time));
    state.blade->advance(built_.body().complex(), places, time);
  }
}

void EventRunner::state(Archive& archive) {
  std::span states = states_;
  archive.each("events", states, [](Archive& each, State& state) {
    each("has fired", state.has_fired);
    each("had effect", state.had_effect);
    each("last", state.last);
    each("reported misfits", state.reported_misfits);
    if (state.tear) each("tear", *state.tear);
    if (state.sheet) each("sheet", *state.sheet);
    if (state.blade && !state.sheet) each("blade", *state.blade);
  });
  archive("removals", removals_);
  archive.each("opened", opened_);
  archive("applied", applied_);
}

}  // namespace suture
