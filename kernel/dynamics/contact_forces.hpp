// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

#include "kernel/base/rows.hpp"
#include "kernel/dynamics/body.hpp"
#include "kernel/forces/contact_law.hpp"

namespace suture {

/// During its life, the column `force` contains the forces of contact in the last step, unless they
/// are a term: what is held by an obstacle is in balance with them.
class WithContactForces {
 public:
  explicit WithContactForces(Body& body) : rows_(body.attributes().force().rows()) {
    if (!body.contact() || body.contact()->is_term()) return;
    for (const ContactLaw::Touch& touch : body.contact()->touches()) {
      saved_.push_back({touch.vertex, row(rows_, touch.vertex)});
      add_to_row(rows_, touch.vertex, touch.force);
    }
  }
  ~WithContactForces() {
    for (const Saved& saved : saved_)
      std::ranges::copy(saved.force, rows_ + 4 * std::size_t{saved.vertex});
  }
  WithContactForces(const WithContactForces&) = delete;
  WithContactForces& operator=(const WithContactForces&) = delete;

 private:
  struct Saved {
    Index vertex;
    Vec3 force;
  };
  double* rows_;
  std::vector<Saved> saved_;
};

}  // namespace suture
