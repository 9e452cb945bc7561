// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/live/plots.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "kernel/forces/contact_law.hpp"

namespace suture {

using Json = nlohmann::json;

Plots::Plots(Simulation& simulation) : simulation_(simulation) {
  const OutputOptions& output = simulation.built().scene().output;
  if (!output.probes.empty()) probes_.emplace(output, simulation.built());
}

Json Plots::names() const {
  Json names{{{"name", "energy"}, {"unit", "J"}, {"curves", {"kinetic", "elastic", "external"}}}};
  if (const ContactLaw* contact = simulation_.contact())
    for (const Obstacle& obstacle : contact->obstacles())
      names.push_back(
          {{"name", "force on " + obstacle.name}, {"unit", "N"}, {"curves", {"x", "y", "z"}}});
  if (!probes_) return names;
  for (const ProbeTable::Quantity& quantity : probes_->quantities()) {
    const auto field =
        std::ranges::find(probes_->fields(), quantity.field, &FieldChoice::name);  // it is there
    names.push_back({{"name", quantity.probe + ' ' + quantity.field},
                     {"unit", field->unit},
                     {"curves", component_names(*field)}});
  }
  return names;
}

std::vector<double> Plots::values() {
  const Energies energies = simulation_.energies();
  std::vector<double> values{energies.kinetic, energies.elastic, energies.external};
  if (const ContactLaw* contact = simulation_.contact())
    for (const ContactLaw::Load& load : contact->loads())
      values.insert(values.end(), load.force.begin(), load.force.end());
  if (!probes_) return values;
  Dynamics& dynamics = simulation_.built().dynamics();
  dynamics.synchronise(probes_->needs(&FieldChoice::needs_force));
  const double time = simulation_.time();
  const std::vector<double>& row =
      probes_->row(time, simulation_.built().body().acceleration(time));
  values.insert(values.end(), row.begin() + 1, row.end());  // without the time
  return values;
}

}  // namespace suture
