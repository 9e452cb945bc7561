// SPDX-License-Identifier: GPL-3.0-or-later
//
// What passes over the vertices do where several processes share them (forces/body_share.hpp).
#include <algorithm>
#include <utility>

#include "kernel/dynamics/motion.hpp"
#include "kernel/forces/contact_law.hpp"

namespace suture {

bool Motion::divides() const {
  return body_.models().may_divide() && !frozen_ && body_.fields().empty() &&
         body_.marks_vertices();
}

/// Every process keeps the state of all driven vertices.
void Motion::drift_driven_of_others(double dt, double end) {
  for_each_range_of_others(*body_.share(), [&](Index first, Index last) {
    body_.constraints().drift(body_.attributes(), dt, end, first, last);
  });
}

void Motion::release_rows_of_others() {
  if (!divides()) return;
  Attributes& attributes = body_.attributes();
  PartialRows& partial = attributes.partial_rows();
  const PartialRows::OwnIsEnough as_they_are(partial);
  partial.set(PartialRows::position, true);
  partial.set(PartialRows::velocity, true);
  if (evaluated_) partial.set(PartialRows::force, true);
  for (Column* column : {&attributes.position(), &attributes.velocity(), &attributes.force()})
    body_.share()->release({column->rows(), 4});
}

/// After a pass of this process: it gets the sums of all, and what is at its borders. The forces of
/// vertices that others step are zero again. Returns whether all passes were good.
bool Motion::join_pass(bool good) {
  Attributes& attributes = body_.attributes();
  BodyShare& share = *body_.share();
  std::vector<double*> read{attributes.position().rows()};
  ContactLaw* const contact = body_.contact();
  if (body_.models().reads_velocity() || contact) read.push_back(attributes.velocity().rows());
  if (contact) read.push_back(contact->kept_forces());
  share.join_borders(read);
  PartialRows& partial = attributes.partial_rows();
  double* const force = attributes.force().rows();
  const auto clear = [&](Index first, Index last) {
    std::fill(force + std::size_t{first} * 4, force + std::size_t{last} * 4, 0.0);
  };
  if (partial.is_partial(PartialRows::force)) {
    for (const Index v : share.borders()) clear(v, v + 1);
  } else {
    for_each_range_of_others(share, clear);
  }
  partial.set(PartialRows::position, true);
  partial.set(PartialRows::velocity, true);
  partial.set(PartialRows::force, false);
  // Where they are asked for again and again, fresh pages would take longer than a step.
  constexpr unsigned passes_before_release = 8;
  const bool were_asked_for = std::exchange(requests_, partial.requests()) != partial.requests();
  passes_alone_ = were_asked_for ? 0 : passes_alone_ + 1;
  if (passes_alone_ == passes_before_release) release_rows_of_others();
  return share.join_blocks(sums_.numbers(), MotionSums::width, good);
}

/// Passes find what is not finite in the velocities of free components; these they overwrite.
void Motion::require_finite_reactions(bool divides) const {
  const Constraints& constraints = body_.constraints();
  if (constraints.empty()) return;
  require_finite_forces(divides, [&](const Column& force, Index begin, Index end) {
    return constraints.first_not_finite(force, begin, end);
  });
}

/// Where the passes are divided, each process looks at the rows that it steps. All get the others
/// only if one has found something.
void Motion::require_finite_forces(bool divides, const FirstNotFinite& first) const {
  Attributes& attributes = body_.attributes();
  if (divides) {
    const PartialRows::OwnIsEnough own(attributes.partial_rows());
    const Column& force = attributes.force();
    BodyShare& share = *body_.share();
    bool is_good = first(force, share.common_begin(), force.size()) == none;
    for (const auto& [begin, end] : share.own())
      is_good = is_good && first(force, begin, end) == none;
    if (share.all(is_good)) return;
  }
  const Column& force = attributes.force();
  const Index vertex = first(force, 0, force.size());
  if (vertex != none) refuse_vertex("the force on node ", vertex);
}

}  // namespace suture
