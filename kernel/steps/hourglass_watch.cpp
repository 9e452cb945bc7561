// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/steps/hourglass_watch.hpp"

#include <algorithm>
#include <sstream>

#include "kernel/dynamics/hourglass.hpp"
#include "kernel/forces/body_share.hpp"
#include "kernel/geometry/centroid.hpp"

namespace suture {
namespace {

constexpr double significant = 0.5;

Index least_elements(Index elements) { return std::clamp<Index>(elements / 10, 8, 64); }

/// The use of a model that acts on the element: of several a continuum, else the first.
const ModelUse& model_of(const Scene& scene, const BuiltScene& built, Index element) {
  std::size_t found = 0;
  for (std::size_t i = scene.models.size(); i-- > 0;) {
    if (!built.body().attributes().instances()[i]->table(3).cells.contains(element)) continue;
    found = i;
    if ((scene.models[i].model->flags & SUTURE_CONTINUUM) != 0) break;
  }
  return scene.models[found];
}

Vec3 centre_of(BuiltScene& built, Index element) {
  Body& body = built.body();
  return centroid(body.complex().vertices_of(element), body.attributes().position().rows(), 4);
}

}  // namespace

/// Process 0 reports it.
std::string hourglass_warning(const Scene& scene, BuiltScene& built, bool at_rest) {
  const auto resists = [](const ModelUse& use) {
    return (use.model->flags & SUTURE_CONTINUUM) != 0;
  };
  if (!at_rest && std::ranges::all_of(scene.models, resists)) return "";
  PartialRows& partial = built.body().attributes().partial_rows();
  const BodyShare* const share = built.body().share();
  built.body().attributes().gather_motion();
  if (share && share->number() != 0) return "";
  const PartialRows::OwnIsEnough as_they_are(partial, share != nullptr);
  const Hourglass found = measure_hourglass(built.body().complex(), built.body().attributes());
  Index count = 0, worst = none;
  for (Index e = 0; e < built.body().complex().element_count(); ++e) {
    if (!(found.content(e) > significant)) continue;
    // A continuum that vibrates has such motions too, and resists them.
    if (!at_rest && (model_of(scene, built, e).model->flags & SUTURE_CONTINUUM) != 0) continue;
    ++count;
    if (worst == none || found.content(e) > found.content(worst)) worst = e;
  }
  const Index elements = built.body().complex().existing(3);
  if (count < least_elements(elements)) return "";
  const ModelUse& use = model_of(scene, built, worst);
  const Vec3 centre = centre_of(built, worst);
  std::ostringstream text;
  text << count << " of " << elements
       << " elements have hourglassed: they move in a checkerboard pattern without strain. The "
          "worst is element "
       << built.element_name(worst) << " at " << built.place_text(centre) << " of model '"
       << use.name << "', by " << found.content(worst) << " times its strain. ";
  if ((use.model->flags & SUTURE_CONTINUUM) == 0)
    text << "Springs do not resist such motions, and neither \"correction\" nor a finer mesh "
            "helps: use a continuum model (tm-faure), or reduce the load";
  else
    text << "Reduce the load, or refine the mesh there";
  return text.str();
}

}  // namespace suture
