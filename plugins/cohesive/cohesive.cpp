// SPDX-License-Identifier: MIT
#include "suture/lips.hpp"
#include "suture/tensor.hpp"

namespace cohesive {

enum { p_stiffness, p_strength, p_toughness, p_shear_strength, p_shear_toughness, p_mixing };
enum { p_slides = 1 };

/// What holds two opposite points together, per area: the energy is (all |jump|^2 + normal s^2) /
/// 2, where s is a part of the jump along the normal.
template <class T>
struct Hold {
  T all, normal, s;
};

/// A model whose energy is a sum over the four pairs of opposite nodes: nodal integration, as
/// stiff faces oscillate at Gauss points. Model::hold() says what holds a pair.
template <class Model>
struct between_lips : suture::model, suture::on_lips {
  static constexpr auto reads = SUTURE_READ_REST | SUTURE_READ_POSITION;

  /// Half of the area of the triangle at a corner of the first lip at rest: the weights add up to
  /// the area, if the lip is plane.
  template <class Cell>
  static SUTURE_INLINE auto weight(const Cell& c, int i) {
    const auto corner = c.rest(i);
    return 0.25 * norm(cross(c.rest((i + 1) % 4) - corner, c.rest((i + 3) % 4) - corner));
  }
  template <class Cell>
  static SUTURE_INLINE auto jump(const Cell& c, int i) {
    return c.position(4 + i) - c.position(i);
  }

  /// The middle surface: its diagonals p and q, and the unit normal n = p x q / |p x q|.
  template <class T>
  struct Middle {
    suture::vec3<T> p, q, n;
    T size;
  };
  template <class Cell>
  static SUTURE_INLINE auto middle(const Cell& c) {
    using T = typename Cell::scalar;
    const auto diagonal = [&](int to, int from) {
      return 0.5 * (c.position(to) + c.position(4 + to) - c.position(from) - c.position(4 + from));
    };
    Middle<T> m{diagonal(2, 0), diagonal(3, 1), {}, T(0.0)};
    m.n = cross(m.p, m.q);
    m.size = norm(m.n);
    m.n = m.n * (1.0 / m.size);
    return m;
  }

  /// f = -dU/dx at constant damage. The normal turns with the nodes: with r = sum_i A_i normal s
  /// jump_i = dU/dn, and t = (r - (r.n) n) / |p x q|, dU/dp = q x t and dU/dq = t x p.
  template <class Cell>
  static SUTURE_INLINE void force(const Cell& c) {
    using T = typename Cell::scalar;
    const auto m = middle(c);
    suture::vec3<T> f[4], r{T(0.0), T(0.0), T(0.0)};
    for (int i = 0; i < 4; ++i) {
      const auto u = jump(c, i);
      const auto [all, normal, s] = Model::hold(c, i, u, dot(u, m.n));
      const T ns = weight(c, i) * normal * s;
      f[i] = u * (weight(c, i) * all) + m.n * ns;
      r += u * ns;
    }
    const auto t = (r - m.n * dot(r, m.n)) * (1.0 / m.size);
    const auto along_p = 0.5 * cross(m.q, t), along_q = 0.5 * cross(t, m.p);
    const suture::vec3<T> turn[4] = {along_p, along_q, -along_p, -along_q};
    for (int i = 0; i < 4; ++i) {
      c.force(i, turn[i] + f[i]);
      c.force(4 + i, turn[i] - f[i]);
    }
  }
  template <class Cell>
  static SUTURE_INLINE auto energy(const Cell& c) {
    using T = typename Cell::scalar;
    const auto m = middle(c);
    T sum(0.0);
    for (int i = 0; i < 4; ++i) {
      const auto u = jump(c, i);
      const auto [all, normal, s] = Model::hold(c, i, u, dot(u, m.n));
      sum += 0.5 * weight(c, i) * (all * dot(u, u) + normal * s * s);
    }
    return sum;
  }

  static constexpr suture_field common_fields[] = {
      suture::field("opening", "m", "mean distance of the lips along their normal"),
      suture::field("sliding", "m", "mean distance of opposite points across it"),
      suture::field("lip_traction", "Pa", "mean pull on the first lip", 3)};
  template <class Cell, class Results>
  static void put(const Cell& c, const Results& out) {
    using T = typename Cell::scalar;
    const auto m = middle(c);
    T opening(0.0), sliding(0.0);
    suture::vec3<T> pull{T(0.0), T(0.0), T(0.0)};
    for (int i = 0; i < 4; ++i) {
      const auto u = jump(c, i);
      const T along = dot(u, m.n);
      const auto [all, normal, s] = Model::hold(c, i, u, along);
      opening += 0.25 * along;
      sliding += 0.25 * norm(u - m.n * along);
      pull += 0.25 * (u * all + m.n * (normal * s));
    }
    out.set(0, opening);
    out.set(1, sliding);
    for (int k = 0; k < 3; ++k) out.set(2, k, pull[k]);
  }
};

struct Tie : between_lips<Tie> {
  static constexpr const char
      *id = "tie",
      *doc = "Holds two regions together, or lets them slide along each other",
      *formula = "U = sum over pairs of nodes of A k/2 |u|^2, sliding: A k/2 (u.n)^2",
      *citation = "penalty method, textbook";
  static constexpr suture::parameter parameters[] = {
      suture::number("stiffness", "Pa/m", "Traction per distance of the two faces").above(0),
      suture::boolean("slides", "Only the distance along the normal is held", false)};

  template <class Cell, class T>
  static SUTURE_INLINE Hold<T> hold(const Cell& c, int, const suture::vec3<T>&, const T& along) {
    const T k(c.parameter(p_stiffness)), none(0.0);
    return c.parameter(p_slides) != 0 ? Hold<T>{none, k, along} : Hold<T>{k, none, along};
  }
  static constexpr auto& fields = common_fields;
  template <class Cell, class Results>
  static void output(const Cell& c, const Results& out) {
    put(c, out);
  }
};

/// A bilinear law of traction and separation; equations in README.md.
struct Cohesive : between_lips<Cohesive> {
  static constexpr const char
      *id = "cohesive",
      *doc = "Glues two regions; the glue softens beyond its strength and breaks",
      *formula =
          "t = (1 - d) k u, and k u.n in compression while d < 1; d from l0 = strength/k to "
          "lf = 2 toughness/strength: d = lf (l - l0) / (l (lf - l0)), l the separation",
      *citation =
          "A. Turon, P. P. Camanho, J. Costa, C. G. Davila, Mechanics of Materials 38, "
          "2006, 1072-1089";
  static constexpr suture::parameter parameters[] = {
      suture::number("stiffness", "Pa/m", "Traction per separation before damage").above(0),
      suture::number("strength", "Pa", "Largest traction in opening").above(0),
      suture::number("toughness", "J/m^2", "Energy that opening takes").above(0),
      suture::number("shear_strength", "Pa", "Largest traction in sliding; 0: that in opening")
          .at_least(0)
          .or_else(0),
      suture::number("shear_toughness", "J/m^2", "Energy that sliding takes; 0: that of opening")
          .at_least(0)
          .or_else(0),
      suture::number("mixing", "1", "Exponent of Benzeggagh and Kenane between both")
          .at_least(1)
          .or_else(1)};
  static constexpr suture::attribute attributes[] = {
      suture::face_attribute("corner_damage", "1", "Damage at the four corners", 4).copy().trial()};
  static constexpr suture::column<0> damage{};
  static constexpr auto cell_columns = suture::columns(damage);

  /// Squares of the separation at which damage begins, and its products with that at which the
  /// face breaks: in opening, and what sliding adds.
  struct Constants {
    double begin, begin_sliding, product, product_sliding;
  };
  static void prepare(const suture::setup& p, Constants& to) {
    const double k = p[p_stiffness];
    const auto shear = [&](int own, int other) { return p[own] > 0 ? p[own] : p[other]; };
    const auto begin = [&](double strength) { return strength / k * (strength / k); };
    to.begin = begin(p[p_strength]);
    to.begin_sliding = begin(shear(p_shear_strength, p_strength)) - to.begin;
    to.product = 2 * p[p_toughness] / k;
    to.product_sliding = 2 * shear(p_shear_toughness, p_toughness) / k - to.product;
    if (to.product > to.begin && to.product + to.product_sliding > to.begin + to.begin_sliding)
      return;
    p.refuse("brittle",
             "the face stores more than its toughness before it softens: raise 'stiffness' above "
             "strength^2 / (2 toughness) and shear_strength^2 / (2 shear_toughness)");
  }

  /// Turon et al.: the mode of the separation enters as B = (sliding / separation)^2.
  template <class Cell, class T>
  static SUTURE_INLINE T damage_at(const Cell& c, int i, const suture::vec3<T>& u, const T& along) {
    const Constants& k = c.constants();
    const T opening = max(along, T(0.0)), sliding = max(dot(u, u) - along * along, T(0.0));
    const T square = max(opening * opening + sliding, T(1e-12 * k.begin));
    const T B = pow(max(sliding / square, T(1e-12)), c.parameter(p_mixing));
    const T begin = sqrt(k.begin + k.begin_sliding * B), l = sqrt(square);
    const T end = (k.product + k.product_sliding * B) / begin;
    const T d = end * (l - begin) / (l * (end - begin));
    return min(max(d, T(c.column(damage, i))), T(1.0));
  }
  template <class Cell, class T>
  static SUTURE_INLINE Hold<T> hold(const Cell& c, int i, const suture::vec3<T>& u,
                                    const T& along) {
    const double k = c.parameter(p_stiffness);
    const T d = damage_at(c, i, u, along);
    c.trial(damage, i, d);
    // A broken face leaves compression to contact.
    return {k * (1.0 - d), select(d < T(1.0), k * d, T(0.0)), min(along, T(0.0))};
  }

  static constexpr suture_field fields[] = {
      common_fields[0], common_fields[1], common_fields[2],
      suture::field("damage", "1", "mean over the corners, from 0 to 1 (broken)")};
  template <class Cell, class Results>
  static void output(const Cell& c, const Results& out) {
    put(c, out);
    typename Cell::scalar mean(0.0);
    for (int i = 0; i < 4; ++i) mean += 0.25 * c.column(damage, i);
    out.set(3, mean);
  }
};

}  // namespace cohesive

SUTURE_PLUGIN("cohesive", "0.1.0", "MIT", "Ties, sliding faces and adhesives", cohesive::Cohesive,
              cohesive::Tie)
