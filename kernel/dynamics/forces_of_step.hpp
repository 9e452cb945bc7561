// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

#include "kernel/base/rows.hpp"
#include "kernel/dynamics/motion.hpp"
#include "kernel/forces/contact_law.hpp"

namespace suture {

/// During its life, the column `force` contains the forces of contact in the last step, unless they
/// are a term: what is held by an obstacle is in balance with them. It does not contain what the
/// scheme withheld (Motion::withheld()).
/// `for_sums`: only sums of Motion read it, so that each of several processes needs own rows.
class ForcesOfStep {
 public:
  explicit ForcesOfStep(Motion& motion, bool for_sums = false) {
    Body& body = motion.body();
    const PartialRows::OwnIsEnough own(body.attributes().partial_rows(),
                                       for_sums && motion.divides());
    const std::vector<double>& withheld = motion.withheld();
    const bool has_contact = body.contact() && !body.contact()->is_term();
    if (withheld.empty() && !has_contact) return;
    rows_ = body.attributes().force().rows();
    all_.assign(rows_, rows_ + withheld.size());
    for (std::size_t i = 0; i < withheld.size(); ++i) rows_[i] += withheld[i];
    if (!has_contact) return;
    for (const ContactLaw::Touch& touch : body.contact()->touches()) {
      saved_.push_back({touch.vertex, row(rows_, touch.vertex)});
      add_to_row(rows_, touch.vertex, touch.force);
    }
  }
  ~ForcesOfStep() {
    for (const Saved& saved : saved_)
      std::ranges::copy(saved.force, rows_ + 4 * std::size_t{saved.vertex});
    std::ranges::copy(all_, rows_);
  }
  ForcesOfStep(const ForcesOfStep&) = delete;
  ForcesOfStep& operator=(const ForcesOfStep&) = delete;

 private:
  struct Saved {
    Index vertex;
    Vec3 force;
  };
  double* rows_ = nullptr;
  std::vector<double> all_;  ///< before, if something is withheld
  std::vector<Saved> saved_;
};

}  // namespace suture
