// SPDX-License-Identifier: MIT
#include "suture/model.hpp"

/// Elementary functions of packs as a plugin calls them: of doubles by the field "value", of floats
/// by the tangent in single precision, whose factor they are.
struct Elementary : suture::model, suture::on_vertices {
  static constexpr const char *id = "elementary", *doc = "Functions of the rest position",
                              *formula = "f = g(X) x", *citation = "none";
  enum { function, exponent };
  static constexpr const char* functions[] = {"exp",  "log", "sin",   "cos",  "tanh",
                                              "cbrt", "pow", "log1p", "expm1"};
  static constexpr suture::parameter parameters[] = {
      suture::choice("function", "The function g", functions),
      suture::number("exponent", "1", "That of pow").or_else(1)};
  static constexpr auto reads = SUTURE_READ_REST | SUTURE_READ_POSITION;
  static constexpr bool single_tangent = true;
  static constexpr suture_field fields[] = {suture::field("value", "1", "Its value", 3)};

  template <class R, class Cell>
  static R value(const Cell& c, const R& x) {
    switch (int(c.parameter(function))) {
      case 0:
        return exp(x);
      case 1:
        return log(x);
      case 2:
        return sin(x);
      case 3:
        return cos(x);
      case 4:
        return tanh(x);
      case 5:
        return cbrt(x);
      case 7:
        return log1p(x);
      case 8:
        return expm1(x);
      default:
        return pow(x, c.parameter(exponent));
    }
  }
  template <class Cell>
  static void force(Cell& c) {
    auto f = c.position(0);
    for (int i = 0; i < 3; ++i) f[i] = value(c, c.rest(0)[i]) * f[i];
    c.force(0, f);
  }
  template <class Cell, class Results>
  static void output(const Cell& c, const Results& out) {
    for (int i = 0; i < 3; ++i) out.set(0, i, value(c, c.rest(0)[i]));
  }
};
SUTURE_PLUGIN("elementary", "1.0", "MIT", "Test of elementary functions", Elementary)
