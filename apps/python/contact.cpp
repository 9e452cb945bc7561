// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/python/contact.hpp"

#include <algorithm>

#include "kernel/forces/contact_law.hpp"

namespace suture::python {
namespace {

const ContactLaw& contact_of(Simulation& simulation) {
  if (const ContactLaw* contact = simulation.contact()) return *contact;
  throw py::attribute_error("the scene has no contact; give it \"contact\"");
}

py::array_t<double> array_of(const Vec3& a) { return py::array_t<double>(3, a.data()); }

}  // namespace

py::array contact_force(Simulation& simulation) {
  const ContactLaw& contact = contact_of(simulation);
  py::array_t<double> forces({py::ssize_t{simulation.attributes().vertex_count()}, py::ssize_t{3}});
  std::fill_n(forces.mutable_data(), forces.size(), 0.0);
  for (const ContactLaw::Touch& touch : contact.touches())
    std::ranges::copy(touch.force, forces.mutable_data(touch.vertex, 0));
  return forces;
}

py::array gap(Simulation& simulation) {
  const std::vector<double> gaps = contact_of(simulation).gaps(simulation.time());
  return py::array_t<double>(static_cast<py::ssize_t>(gaps.size()), gaps.data());
}

py::list tool_names(Simulation& simulation) {
  py::list names;
  if (const ContactLaw* contact = simulation.contact())
    for (const Obstacle& obstacle : contact->obstacles()) names.append(obstacle.name);
  return names;
}

py::tuple tool_state(Simulation& simulation, std::size_t obstacle) {
  const ContactLaw& contact = contact_of(simulation);
  const ContactLaw::Load& load = contact.loads()[obstacle];
  const Pose pose = contact.pose(obstacle, simulation.time());
  py::object hand_force = py::none(), hand_torque = py::none();
  if (const auto tool = contact.tool_state(obstacle)) {
    hand_force = array_of(tool->hand_force);
    hand_torque = array_of(tool->hand_torque);
  }
  return py::make_tuple(array_of(load.force), array_of(load.torque), array_of(pose.translation),
                        array_of(rotation_vector(pose)), hand_force, hand_torque);
}

}  // namespace suture::python
