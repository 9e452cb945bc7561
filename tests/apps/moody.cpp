// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>

#include "suture/model.hpp"

/// Edges without a force (but for noise) that fail for a while, next to a model that moves. A
/// repeated step succeeds only if it is shorter than "longest": the time of a failure depends on
/// the state alone, as in any sound model.
struct Moody : suture::model, suture::on_edges {
  static constexpr const char *id = "moody", *doc = "Fails \x1b[5mfor a while", *formula = "f = 0",
                              *citation = "none";
  enum { how, from, to, longest, factor };
  static constexpr const char* ways[] = {"never", "retry", "nan", "stop", "noise"};
  static constexpr suture::parameter parameters[] = {
      suture::choice("how", "what happens", ways),
      suture::number("from", "s", "when it begins").or_else(0),
      suture::number("to", "s", "when it is over").or_else(1e300),
      suture::number("longest", "s", "step that it bears").or_else(0),
      suture::number("factor", "1", "proposed with a retry").or_else(0.5)};

  static bool enabled(const suture::values& p, std::uint32_t&) { return p[how] != 0; }

  template <class Cell>
  static void force(const Cell& c) {
    const bool fails = c.dt() > c.parameter(longest) * (1 + 1e-9) &&
                       c.time() >= c.parameter(from) && c.time() < c.parameter(to);
    if (fails && c.parameter(how) == 1)
      suture::retry("the edges want a smaller step", c.parameter(factor));
    if (fails && c.parameter(how) == 3) suture::stop("the edges have had enough");
    double bad = fails ? std::numeric_limits<double>::quiet_NaN() : 0.0;
    // So large that its error is the same for a step of any length.
    if (fails && c.parameter(how) == 4) bad = std::sin(1e9 * c.time()) / (c.dt() * c.dt());
    const auto nothing = (c.position(1) - c.position(0)) * bad;
    c.force(0, nothing);
    c.force(1, nothing);
  }
};
SUTURE_PLUGIN("moody", "1.0", "GPL-3.0-or-later", "Fails for a while", Moody)
