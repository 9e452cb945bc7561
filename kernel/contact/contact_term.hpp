// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/contact/contact.hpp"
#include "kernel/forces/term_capabilities.hpp"

namespace suture {

/// A law of contact whose forces are a term of the body, with a stiffness in proportion to that of
/// the body at each vertex.
class ContactTerm : public ForceTerm, public TangentTerm, public WorkTerm {
 public:
  const char* name() const override { return "contact"; }
  void add_forces(double time, const LiveMask& live, double* rows) override;
  void add_forces_at(const VertexSelection& selection, std::span<const Index> vertices, double time,
                     std::vector<Vec3>& forces) override;
  void forget_models() override { stiffness_.clear(); }

 protected:
  /// `models`: the term whose bounds give the stiffness; `stiffening`: in multiples of these.
  /// `contact` outlives the term.
  ContactTerm(Contact& contact, Attributes& attributes, BoundedTerm& models, double stiffening);

  /// At the current positions.
  virtual std::vector<Contact::Force> forces_at(double time) = 0;

  /// If it is empty: at the start, and after operations.
  void find_stiffness(double time);
  double stiffness_of(const ContactPoint& point) const {
    return point.in_series(stiffness_.data(), attributes_.fixed().rows());
  }

  Contact& contact_;
  Attributes& attributes_;
  std::vector<double> stiffness_;  ///< by vertex, N/m

 private:
  BoundedTerm& models_;
  double stiffening_;
};

}  // namespace suture
