// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/build/check_selections.hpp"

#include <algorithm>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

class SelectionCheck {
 public:
  explicit SelectionCheck(const Selector& selector) : selector_(selector) {}

  void check(const Scene& scene) {
    for (const NamedSelection& set : scene.sets) check_set(set);
    check_models(scene.models);
    for (const Constraint& constraint : scene.constraints) vertices(constraint.where);
    for (const InitialMotion& motion : scene.initial_motion) vertices(motion.where);
    for (const Foundation& foundation : scene.foundations) surface(foundation.where);
    for (const Load& load : scene.loads) {
      if (load.kind == Load::Kind::force)
        vertices(load.where);
      else
        surface(load.where);
    }
    for (const FieldCondition& condition : scene.fields)
      if (condition.kind != FieldCondition::Kind::flux &&
          condition.kind != FieldCondition::Kind::film)
        vertices(condition.where);
      else if (!selector_.has_parts())
        attempt([&] { selector_.boundary_faces(condition.where); });
    for (const Event& event : scene.events) check_event(event);
    for (const Probe& probe : scene.output.probes) check_probe(probe);
  }

  void throw_if_any() const {
    if (!mistakes_.empty()) throw InputError(mistakes_);
  }

 private:
  template <class Check>
  bool attempt(Check check) {
    try {
      check();
      return true;
    } catch (const InputError& error) {
      mistakes_ += (mistakes_.empty() ? "" : "\n") + std::string(error.what());
      return false;
    }
  }
  void vertices(const Selection& where) {
    attempt([&] { selector_.vertices(where); });
  }

  void surface(const Selection& where) {
    attempt([&] {
      if (selector_.has_parts())
        selector_.surface_triangles(where);
      else
        selector_.boundary_faces(where);
    });
  }
  /// A set has nodes or elements, and a name of its own.
  void check_set(const NamedSelection& set) {
    attempt([&] {
      if (selector_.mesh_has_set(set.name))
        throw InputError(set.where.path + ": the mesh has a set of this name, too; choose another");
      if (selector_.vertices_now(set.where).empty()) selector_.elements(set.where);
    });
  }
  void check_models(const std::vector<ModelUse>& models) {
    std::vector<char> covered(selector_.element_count());
    bool known = true;
    for (const ModelUse& use : models) {
      if (use.between)
        for (const Selection& side : *use.between) attempt([&] { selector_.elements(side); });
      else if (std::holds_alternative<Selection::All>(use.region.what))
        std::ranges::fill(covered, 1);
      else
        known &= attempt([&] {
          for (const Index e : selector_.elements(use.region)) covered[e] = 1;
        });
    }
    if (known) attempt([&] { require_models(covered); });
  }
  /// Every element needs a model, or its vertices would have no mass.
  void require_models(const std::vector<char>& covered) const {
    const auto uncovered = std::ranges::count(covered, 0);
    if (uncovered == 0) return;
    const auto first = std::ranges::find(covered, 0) - covered.begin();
    throw InputError("/models: " + std::to_string(uncovered) + " of " +
                     std::to_string(covered.size()) +
                     " elements have no model, the first is element " +
                     std::to_string(selector_.element_id(static_cast<Index>(first))) +
                     "; let the regions of the models cover the mesh");
  }

  // What geometry selects is known when the event comes.
  void names(const std::optional<Selection>& where) {
    if (where && where->is_listed()) attempt([&] { selector_.elements(*where); });
  }
  void pairs(const std::string& path, const std::vector<std::array<std::uint64_t, 2>>& pairs) {
    for (std::size_t i = 0; i < pairs.size(); ++i)
      for (const std::uint64_t id : pairs[i])
        if (selector_.element_with_id(id) == none)
          attempt([&] {
            throw InputError(path + "/faces/" + std::to_string(i) + ": the mesh has no element " +
                             std::to_string(id));
          });
  }
  void check_event(const Event& event) {
    if (event.when) vertices(event.when->where);
    if (const auto* faces = std::get_if<CutFaces>(&event.what)) {
      pairs(event.path + "/cut", faces->element_pairs);
    } else if (const auto* pierce = std::get_if<Pierce>(&event.what)) {
      names(pierce->where);
    } else if (const auto* tear = std::get_if<Tear>(&event.what)) {
      if (tear->where) attempt([&] { selector_.elements(*tear->where); });
    } else if (const auto* sew = std::get_if<SewFaces>(&event.what)) {
      names(sew->where);
      if (sew->between)
        for (const Selection& side : *sew->between) names(side);
      pairs(event.path + "/suture", sew->element_pairs);
    }
  }

  // Its fields decide whether nodes or elements are wanted; here it must have either.
  void check_probe(const Probe& probe) {
    attempt([&] {
      try {
        selector_.vertices(probe.where);
      } catch (const InputError&) {
        if (probe.at_point || probe.fields.empty()) throw;
        selector_.elements(probe.where);
      }
    });
  }

  const Selector& selector_;
  std::string mistakes_;
};

}  // namespace

void check_selections(const Scene& scene, const Selector& selector) {
  SelectionCheck check(selector);
  check.check(scene);
  check.throw_if_any();
}

}  // namespace suture
