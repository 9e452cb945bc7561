// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>
#include <stdexcept>

#include "suture/continuum.hpp"

/// A solid that fails in the requested way as soon as it is deformed.
struct failing : suture::continuum<failing> {
  static constexpr const char *id = "failing", *doc = "Fails on demand",
                              *formula = "S = 2000 E + tr(E) I", *citation = "none";
  static constexpr auto default_element = suture::element_type::trilinear;  // fails in force() only
  enum { rho, how };
  static constexpr const char* ways[] = {"never", "nan", "throw", "stop", "throw-int"};
  static constexpr suture::parameter parameters[] = {
      suture::number("rho", "kg/m^3", "density").above(0),
      suture::choice("how", "what happens", ways)};
  static double density(const suture::values& p) { return p[rho]; }

  template <class T, class Parameters>
  static suture::mat3<T> stress(const suture::mat3<T>& F, const Parameters& p) {
    if (p[how] == 2) throw std::runtime_error("the law has lost its way");
    if (p[how] == 3) suture::stop("the law asks to stop");
    if (p[how] == 4) throw 42;
    const double factor = p[how] == 1 ? std::numeric_limits<double>::quiet_NaN() : 2000.0;
    const auto strain = green_strain(F);
    return F * add_diagonal(factor * strain, trace(strain));
  }
};
SUTURE_PLUGIN("failing", "1.0", "GPL-3.0-or-later", "Fails on demand", failing)
