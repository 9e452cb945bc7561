// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/contact/contact_in_progress.hpp"
#include "kernel/contact/kept_contact.hpp"
#include "kernel/contact/surface_points.hpp"
#include "kernel/forces/contact_law.hpp"

namespace suture {

/// Books the forces and the work of a step once all pushes are known.
///
/// An impulse J does the work J . (v- + v+)/2 (with damping, times work_gain), exactly what it
/// changes in the kinetic energy, and friction as much relative to the obstacle.
class ContactBooks {
 public:
  ContactBooks(Attributes& attributes, ContactInProgress& in_progress, const ContactStep& step,
               ContactLaw::Results& results, KeptContact& kept)
      : attributes_(attributes),
        in_progress_(in_progress),
        step_(step),
        results_(results),
        kept_(kept) {}

  /// All that changes the velocity of a vertex. `pushes`: those of obstacles on it alone.
  void vertex(ContactInProgress::Near& near, std::span<const ContactInProgress::PushBy> pushes,
              std::vector<ContactLaw::Correction>& corrections);
  // After all vertices, in the work booked for them: the parts of friction and cutting.
  /// `mass`: by component, kg.
  void point(const ContactPoint& point, const Vec3& mass,
             std::span<const ContactInProgress::PushBy> pushes);
  /// Of an impulse that slides by a mean velocity.
  void friction(const Vec3& impulse, const Vec3& sliding);
  void cutting(const ContactPoint& point, Index obstacle, const Vec3& impulse,
               const Vec3& velocity);
  /// After all that: on obstacles.
  void sum_loads();

  /// Of the velocities before and after the step, m/s.
  Vec3 mean_velocity(const ContactInProgress::Near& near) const;
  /// Interpolates from its vertices, which are all near.
  Vec3 mean_velocity(const ContactPoint& point) const;

 private:
  Vec3 free_force(const ContactInProgress::Near& near) const;
  Vec3 mean_velocity(const ContactInProgress::Near& near, const Vec3& force) const;
  void add_force(const ContactPoint& point, Index obstacle, const Vec3& force);

  Attributes& attributes_;
  ContactInProgress& in_progress_;
  const ContactStep& step_;
  ContactLaw::Results& results_;
  KeptContact& kept_;
};

}  // namespace suture
