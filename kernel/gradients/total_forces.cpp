// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/gradients/total_forces.hpp"

#include "kernel/base/aligned.hpp"

namespace suture {
namespace {

/// `skew`: what the part that is not symmetric counts.
std::vector<double> product(Body& body, const TangentTime& at, const std::vector<double>& d,
                            double skew) {
  std::vector<double> out(d.size());
  for_each_with<TangentTerm>(body.terms(), [&](TangentTerm& term) {
    if (!term.is_stiff()) return;
    term.add_tangent(d.data(), 1, 0, at, out.data());
    term.add_skew_tangent(d.data(), skew, at, out.data());
  });
  return out;
}

/// Forces in rows of 4 with those of all terms but the models, gravity included.
std::vector<double> with_loads(Body& body, double time, AlignedVector<double>& rows) {
  Attributes& attributes = body.attributes();
  for (const auto& term : body.loads())
    term->add_forces(time, attributes.kernel(0).cells.live(), rows.data());
  return with_weight(rows.data(), attributes, body.acceleration(time));
}

}  // namespace

std::string why_fields_have_none(const Body& body) {
  if (body.fields().empty()) return {};
  return "fields such as '" + body.fields().front().field().name +
         "' have no derivatives; choose models without them";
}

std::vector<double> with_weight(const double* rows, Attributes& attributes, const Vec3& gravity) {
  std::vector<double> forces;
  for (Index v = 0; v < attributes.vertex_count(); ++v)
    for (std::size_t c = 0; c < 3; ++c)
      forces.push_back(rows[std::size_t{v} * 4 + c] + attributes.mass().get(v, 0) * gravity[c]);
  return forces;
}

std::vector<double> total_forces(Body& body, const TangentTime& at) {
  AlignedVector<double> rows(std::size_t{body.attributes().vertex_count()} * 4);
  body.models().add_forces(at.time, at.dt, ForceLoop::Part::all, rows.data());
  return with_loads(body, at.time, rows);
}

std::vector<double> load_forces(Body& body, double time) {
  AlignedVector<double> rows(std::size_t{body.attributes().vertex_count()} * 4);
  return with_loads(body, time, rows);
}

std::vector<double> balanced_forces(Body& body, const Moment& moment) {
  std::vector<double> forces = total_forces(body, moment.at);
  const Column& mass = body.attributes().mass();
  for (std::size_t i = 0; i < moment.inertia.size(); ++i)
    forces[i] -= mass.get(static_cast<Index>(i / 3), 0) * moment.inertia[i];
  return forces;
}

std::vector<double> elastic_forces(Body& body, double time) {
  const std::size_t vertices = body.attributes().vertex_count();
  AlignedVector<double> rows(vertices * 4);
  body.models().add_forces(time, 0, ForceLoop::Part::with_energy, rows.data());
  std::vector<double> forces(vertices * 3);
  for (std::size_t i = 0; i < forces.size(); ++i) forces[i] = rows[i / 3 * 4 + i % 3];
  return forces;
}

std::vector<double> transposed_tangent(Body& body, const TangentTime& at,
                                       const std::vector<double>& d) {
  return product(body, at, d, -1);
}

std::vector<double> tangent(Body& body, const TangentTime& at, const std::vector<double>& d) {
  return product(body, at, d, 1);
}

std::vector<double> damping_tangent(Body& body, const TangentTime& at,
                                    const std::vector<double>& d) {
  std::vector<double> out(d.size());
  if (body.models().reads_velocity()) body.add_tangent(d.data(), 0, 1, at, out.data());
  return out;
}

}  // namespace suture
