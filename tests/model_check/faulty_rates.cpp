// SPDX-License-Identifier: GPL-3.0-or-later
//
// Models of fields, each with one fault in its rates or its capacity.
#include "suture/continuum.hpp"

namespace {

struct Share {
  static constexpr int components = 1;
  template <class Cell, class Out>
  static void compute(const Cell&, const Out& out) {
    for (int n = 0; n < 8; ++n) out.set(n, 0, typename Cell::real(n == 7 ? 0.0 : 1e-3));
  }
};

template <class M>
struct Field : suture::model, suture::on_volumes {
  static constexpr const char *name = "rates", *doc = "A planted fault", *formula = "none",
                              *citation = "none";
  static constexpr suture::column<0> u{};
  static double capacity(const suture::values&) { return 2; }
  static constexpr auto reads = SUTURE_READ_REST;
  static constexpr auto rate_of = u;
  static constexpr auto vertex_columns = suture::columns(u);
  static constexpr suture::attribute attributes[] = {
      suture::vertex_field("u", "1", "An unknown"),
      suture::lumped_capacity<M>("capacity", "1", "Of the nodes")};
};

// What the first node gives goes to the second, whatever that has.
struct Upwind : Field<Upwind> {
  static constexpr const char* id = "rate-upwind";
  template <class Cell>
  static void rate(const Cell& c) {
    const auto flow = 0.5 * c.field(0);
    for (int n = 0; n < 8; ++n) c.rate(n, (n == 0 ? -1.0 : n == 1 ? 1.0 : 0.0) * flow);
  }
};

struct Source : Field<Source> {
  static constexpr const char* id = "rate-source";
  template <class Cell>
  static void rate(const Cell& c) {
    for (int n = 0; n < 8; ++n) c.rate(n, 1.0 - c.field(n));
  }
};

// The same with the `reads` of a functor that says nothing, though it reads no position.
struct ReadingSource : Field<ReadingSource> {
  static constexpr const char* id = "rate-reading-source";
  static constexpr auto reads = SUTURE_READ_POSITION;
  template <class Cell>
  static void rate(const Cell& c) {
    Source::rate(c);
  }
};

// Its nodes take up nothing, and it does not follow the motion.
struct Empty : Field<Empty> {
  static constexpr const char* id = "rate-empty";
  static double capacity(const suture::values&) { return 0; }
  template <class Cell>
  static void rate(const Cell& c) {
    suture::diffuse(c, 1.0);
  }
};

// The derivative of a value that is taken out of the dual number is lost.
struct Blind : Field<Blind> {
  static constexpr const char* id = "rate-blind";
  template <class T>
  static auto without_derivative(const T& x) {
    if constexpr (suture::is_dual<T>)
      return x.value;
    else
      return x;
  }
  template <class Cell>
  static void rate(const Cell& c) {
    const auto flow = c.field(1) - without_derivative(c.field(0));
    for (int n = 0; n < 8; ++n) c.rate(n, (n == 0 ? 1.0 : n == 1 ? -1.0 : 0.0) * flow);
  }
};

// One of its nodes takes up nothing.
struct NoCapacity : suture::model, suture::on_volumes {
  static constexpr const char *id = "rate-no-capacity", *name = "rates", *doc = "A planted fault",
                              *formula = "none", *citation = "none";
  static constexpr suture::column<0> u{};
  static constexpr auto reads = SUTURE_READ_REST;
  static constexpr auto rate_of = u;
  static constexpr auto vertex_columns = suture::columns(u);
  static constexpr suture::attribute attributes[] = {
      suture::vertex_field("u", "1", "An unknown"),
      suture::vertex_attribute("capacity", "1", "Of seven nodes")
          .from_volumes(suture::contribution<NoCapacity, Share>)
          .flag(SUTURE_CAPACITY)};
  template <class Cell>
  static void rate(const Cell& c) {
    suture::diffuse(c, 1.0);
  }
};

// The stress falls with the field, and the field does not feel by how much.
struct OneWay : suture::continuum<OneWay> {
  static constexpr const char *id = "rate-one-way", *doc = "A planted fault", *formula = "none",
                              *citation = "none";
  static double density(const suture::values&) { return 1000; }
  static double capacity(const suture::values&) { return 2; }
  static constexpr suture::attribute vertex_fields[] = {
      suture::vertex_field("u", "1", "An unknown"),
      suture::lumped_capacity<OneWay>("capacity", "1", "Of the nodes")};
  template <class T, class P, class At>
  static SUTURE_INLINE T energy(const suture::mat3<T>& F, const P&, const At& at) {
    return (1e4 - 1e3 * at.field[0]) * (excess_I1(F) - 2.0 * log1p(excess_J(F)));
  }
  template <class F, class P, class At>
  static auto release(const F& f, const P&, const At& at) {
    return suture::released{900.0 * (excess_I1(f) - 2.0 * log1p(excess_J(f))) - at.field,
                            at.gradient * -1.0};
  }
};

// The second component follows the first, which does not follow it.
struct Followed : Field<Followed> {
  static constexpr const char* id = "rate-followed";
  static constexpr suture::attribute attributes[] = {
      suture::vertex_field("u", "1", "Two unknowns", 2),
      suture::lumped_capacity<Followed>("capacity", "1", "Of the nodes")};
  template <class Cell>
  static void rate(const Cell& c) {
    const auto flow = c.field(0, 0) - c.field(1, 0);
    for (int n = 0; n < 8; ++n) {
      c.rate(n, 0, 0.0 * flow);
      c.rate(n, 1, (n == 0 ? -1.0 : n == 1 ? 1.0 : 0.0) * flow);
    }
  }
};

// The law says half of what its flow dissipates.
struct HalfLoss : suture::continuum<HalfLoss> {
  static constexpr const char *id = "rate-half-loss", *doc = "A planted fault", *formula = "none",
                              *citation = "none";
  static double density(const suture::values&) { return 1000; }
  static double capacity(const suture::values&) { return 2; }
  static constexpr suture::attribute vertex_fields[] = {
      suture::vertex_field("u", "1", "An unknown"),
      suture::lumped_capacity<HalfLoss>("capacity", "1", "Of the nodes")};
  template <class T, class P, class At>
  static SUTURE_INLINE T energy(const suture::mat3<T>& F, const P&, const At&) {
    return 1e4 * (excess_I1(F) - 2.0 * log1p(excess_J(F)));
  }
  template <class P, class At>
  static auto dissipation(const P&, const At& at) {
    return 0.5 * dot(at.gradient, at.gradient);
  }
  template <class F, class P, class At>
  static auto release(const F&, const P&, const At& at) {
    return suture::released{0.0 * at.field, at.gradient * -1.0};
  }
};

}  // namespace

SUTURE_PLUGIN("faulty-rates", "1.0", "MIT", "Fields with planted faults", Upwind, Source,
              ReadingSource, Blind, NoCapacity, Empty, OneWay, Followed, HalfLoss)
