// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/event_runner.hpp"

#include "kernel/base/error.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/geometry/moving_blade.hpp"
#include "kernel/geometry/surface_blade.hpp"
#include "kernel/geometry/surface_file.hpp"
#include "kernel/operations/event_call.hpp"
#include "kernel/operations/plane_patch.hpp"
#include "kernel/operations/refused_operation.hpp"
#include "kernel/operations/swept_sheet.hpp"

namespace suture {

EventRunner::EventRunner(const Scene& scene, BuiltScene& built, Diagnostics& diagnostics)
    : scene_(scene),
      built_(built),
      diagnostics_(diagnostics),
      removals_(scene, built),
      debris_(scene, built) {
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
        state.patch = std::make_unique<SurfacePatch>(std::move(surface), built_.frame().origin);
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
  has_changed_ = true;
  is_changing_ = false;
  for (State& state : states_) {
    if (state.tear && (sewn || !change.removed[3].empty())) state.tear->invalidate(change.copies);
    if (state.sheet) state.sheet->follow(change);
    if (state.blade && sewn)
      state.blade->reset();
    else if (state.blade)
      state.blade->follow(complex, change);
  }
}

EventOutcome EventRunner::call(const Event& event, std::uint32_t number, double time,
                               State& state) {
  has_changed_ = is_changing_ = false;
  if (debris_.is_removed()) built_.body().islands();  // follow the operation
  EventOutcome outcome = std::visit(Call{*this, event, number, time, state}, event.what);
  if (has_changed_) remove_debris(event, time, outcome);
  return outcome;
}

/// Never the whole body.
void EventRunner::remove_debris(const Event& event, double time, EventOutcome& outcome) {
  const std::vector<Index> elements = debris_.find();
  if (elements.empty() || elements.size() >= built_.body().complex().existing(3)) return;
  outcome.debris = debris_.matter(elements);
  removals_.before(elements);
  built_.body().pierce(elements);
  removed_debris_ += outcome.debris;
  outcome.elements_removed += static_cast<Index>(elements.size());
  outcome.removed.insert(outcome.removed.end(), elements.begin(), elements.end());
  for (const std::string& loss : removals_.after())
    diagnostics_.warn(timed(time, event.path + ": its debris " + loss));
}

/// Forces that cannot be computed are the fault of the state. The map refuses before it changes.
bool EventRunner::is_refusal(const Error& error) const {
  if (has_changed_) return false;
  if (is_changing_) return dynamic_cast<const TopologyError*>(&error) != nullptr;
  return dynamic_cast<const InputError*>(&error) != nullptr ||
         dynamic_cast<const RefusedOperation*>(&error) != nullptr;
}

EventOutcome EventRunner::fire(std::size_t i, double time) {
  const Event& event = scene_.events[i];
  const EventOutcome outcome = call(event, static_cast<std::uint32_t>(i), time, states_[i]);
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
  const EventOutcome outcome = call(event, none, time, state);
  ++applied_;
  return outcome;
}

void EventRunner::motion(Archive& archive) {
  std::span states = states_;
  archive.each("sheets", states, [](Archive& each, State& state) {
    if (state.sheet) each("sheet", *state.sheet);
  });
}

// A blade knows where the tissue was at its last step.
void EventRunner::roll_back(double time) {
  const Places places{built_.body().attributes().position().rows()};
  for (std::size_t i = 0; i < states_.size(); ++i) {
    State& state = states_[i];
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
  if (debris_.is_removed()) archive("debris", removed_debris_);
}

}  // namespace suture
