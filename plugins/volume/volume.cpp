// SPDX-License-Identifier: MIT
#include "suture/hexahedron.hpp"
#include "suture/model.hpp"

namespace volume_model {

/// The nodes of a face, counter-clockwise seen from outside; `side`: of the axis a.
constexpr int face_node(int a, int side, int corner) {
  const int b = (a + 1) % 3, c = (a + 2) % 3, turned = side == 1 ? corner : 3 - corner;
  const int along_b = turned == 1 || turned == 2, along_c = turned >= 2;
  return side << a | along_b << b | along_c << c;
}

/// out[n] = dV/dx_n; returns V, exact for trilinear hexahedra. What a bilinear face adds is the
/// mean of its two triangulations: (p0 p1 p2) + (p0 p2 p3) + (p0 p1 p3) + (p1 p2 p3), over 12.
template <class T>
SUTURE_INLINE T volume_and_gradient(const suture::vec3<T> (&x)[8], suture::vec3<T> (&out)[8]) {
  suture::vec3<T> p[8];
  for (int n = 0; n < 8; ++n) {
    p[n] = x[n] - x[0];  // fewer digits are lost
    out[n] = {T(0.0), T(0.0), T(0.0)};
  }
  for (int a = 0; a < 3; ++a)
    for (int side = 0; side < 2; ++side)
      for (int corner = 0; corner < 4; ++corner) {
        const auto at = [&](int ahead) -> const suture::vec3<T>& {
          return p[face_node(a, side, (corner + ahead) % 4)];
        };
        out[face_node(a, side, corner)] += cross(at(1), at(2)) + cross(at(1) + at(2), at(3));
      }
  T V(0.0);
  for (int n = 0; n < 8; ++n) {
    out[n] = out[n] * (1.0 / 12.0);
    V += dot(p[n], out[n]) * (1.0 / 3.0);
  }
  return V;
}

enum { p_kappa, p_hourglass };
inline constexpr suture::column<0> rest_volume{};
inline constexpr suture::column<1> twist_stiffness{};
inline constexpr suture::column<2> rest_twist{};

template <class Cell>
SUTURE_INLINE void positions(const Cell& c, suture::vec3<typename Cell::scalar> (&x)[8]) {
  for (int n = 0; n < 8; ++n) x[n] = c.position(n);
}

template <class Cell>
SUTURE_INLINE void rest_positions(const Cell& c, suture::vec3<typename Cell::real> (&X)[8]) {
  for (int n = 0; n < 8; ++n) X[n] = c.rest(n);
}

// ------------------------------------------------------------------- volume --

struct RestVolume {
  static constexpr int components = 1;
  template <class Cell, class Out>
  static void compute(const Cell& c, const Out& out) {
    suture::vec3<typename Cell::real> X[8];
    rest_positions(c, X);
    out.set(0, 0, volume(X));
  }
};

struct KeepVolume : suture::on_volumes {
  static constexpr const char* name = "volume";
  static constexpr const char* doc = "A pressure in each element that keeps its volume.";
  static constexpr bool element_parameters = true;
  static constexpr auto cell_columns = suture::columns(rest_volume);

  template <class Cell>
  static SUTURE_INLINE auto change(const Cell& c,
                                   suture::vec3<typename Cell::scalar> (&gradient)[8]) {
    suture::vec3<typename Cell::scalar> x[8];
    positions(c, x);
    return volume_and_gradient(x, gradient) / c.column(rest_volume) - 1.0;
  }

  template <class Cell>
  static SUTURE_INLINE void force(const Cell& c) {
    suture::vec3<typename Cell::scalar> gradient[8];
    const auto pressure = c.parameter(p_kappa) * change(c, gradient);
    for (int n = 0; n < 8; ++n) c.force(n, gradient[n] * -pressure);
  }

  template <class Cell>
  static auto energy(const Cell& c) {
    suture::vec3<typename Cell::scalar> gradient[8];
    const auto relative = change(c, gradient);
    return 0.5 * c.parameter(p_kappa) * c.column(rest_volume) * (relative * relative);
  }

  static constexpr suture_field fields[] = {
      suture::field("volume_change", "1", "change of the volume relative to that at rest"),
      suture::field("volume_pressure", "Pa", "positive where the element is compressed")};
  template <class Cell, class Results>
  static void output(const Cell& c, Results& out) {
    suture::vec3<typename Cell::scalar> gradient[8];
    const auto relative = change(c, gradient);
    out.set(0, relative);
    out.set(1, -c.parameter(p_kappa) * relative);
  }
};

// ------------------------------------------------------------- checkerboard --

constexpr double side(int n, int axis) { return (n >> axis & 1) != 0 ? 1.0 : -1.0; }
/// The pattern of the motions along the axis a that alternate along both others.
constexpr double pattern(int n, int a) { return side(n, (a + 1) % 3) * side(n, (a + 2) % 3); }

/// q_a = sum_n pattern_a(n) x_n, and its component along the mean edges A_a: s_a = q_a . A_a.
template <class T>
SUTURE_INLINE T twist(const suture::vec3<T> (&x)[8], int a, suture::vec3<T>& q) {
  q = {T(0.0), T(0.0), T(0.0)};
  suture::vec3<T> edges = q;
  for (int n = 0; n < 8; ++n) {
    q += x[n] * pattern(n, a);
    edges += x[n] * (0.25 * side(n, a));
  }
  return dot(q, edges);
}

struct RestTwist {
  static constexpr int components = 3;
  template <class Cell, class Out>
  static void compute(const Cell& c, const Out& out) {
    suture::vec3<typename Cell::real> X[8], q;
    rest_positions(c, X);
    for (int a = 0; a < 3; ++a) out.set(0, a, twist(X, a, q));
  }
};

/// The shear energy of u_a = h y_b y_c, with y from -1 to 1 over the box, h = s_a / (8 l_a):
///   V mu/2 4/3 h^2 (1 / l_b^2 + 1 / l_c^2) = mu k_a s_a^2 / 2
struct TwistStiffness {
  static constexpr int components = 3;
  template <class Cell, class Out>
  static void compute(const Cell& c, const Out& out) {
    suture::vec3<typename Cell::real> X[8];
    rest_positions(c, X);
    const auto edges = mean_edges(X);
    const auto square = [&](int a) { return dot(edges.column[a % 3], edges.column[a % 3]); };
    const auto V = volume(X);
    for (int a = 0; a < 3; ++a)
      out.set(0, a, V / (48.0 * square(a)) * (1.0 / square(a + 1) + 1.0 / square(a + 2)));
  }
};

struct ResistCheckerboard : suture::on_volumes {
  static constexpr const char* name = "checkerboard";
  static constexpr const char* doc =
      "Stiffness of the motions that strain neither edges nor "
      "inner diagonals.";
  static constexpr auto cell_columns = suture::columns(twist_stiffness, rest_twist);
  static bool enabled(const suture::values& p, std::uint32_t&) { return p[p_hourglass] != 0; }

  template <class Cell>
  static SUTURE_INLINE void force(const Cell& c) {
    using T = typename Cell::scalar;
    suture::vec3<T> x[8], f[8], q;
    positions(c, x);
    for (int n = 0; n < 8; ++n) f[n] = {T(0.0), T(0.0), T(0.0)};
    for (int a = 0; a < 3; ++a) {
      const T s = twist(x, a, q) - c.column(rest_twist, a);
      const T pull = s * (c.parameter(p_hourglass) * c.column(twist_stiffness, a));
      const auto edges = mean_edges(x).column[a];
      for (int n = 0; n < 8; ++n) f[n] -= (edges * pattern(n, a) + q * (0.25 * side(n, a))) * pull;
    }
    for (int n = 0; n < 8; ++n) c.force(n, f[n]);
  }

  template <class Cell>
  static auto energy(const Cell& c) {
    using T = typename Cell::scalar;
    suture::vec3<T> x[8], q;
    positions(c, x);
    T twice(0.0);
    for (int a = 0; a < 3; ++a) {
      const T s = twist(x, a, q) - c.column(rest_twist, a);
      twice += c.column(twist_stiffness, a) * (s * s);
    }
    return 0.5 * c.parameter(p_hourglass) * twice;
  }
};

// -------------------------------------------------------------------- model --

/// An energy of the volume of each element, to be added to another model; equations in README.md.
struct Volume : suture::model {
  static constexpr const char* id = "volume";
  static constexpr const char* doc = "Keeps the volume of each element, beside another model";
  static constexpr const char* formula = "U = kappa V0/2 (V/V0 - 1)^2, V of the trilinear element";
  static constexpr const char* citation =
      "Y. Duan, W. Huang, H. Chang, et al., IEEE J. Biomed. Health Inform. 18, 2014";

  static constexpr suture::parameter parameters[] = {
      suture::number("kappa", "Pa", "Pressure per relative change of the volume")
          .above(0)
          .per_element(),
      suture::number("hourglass", "Pa",
                     "Shear modulus against the checkerboard motions that mss-baudet does not "
                     "resist; 0: none")
          .at_least(0)
          .or_else(0)};

  template <class C>
  static constexpr auto of = suture::contribution<Volume, C>;
  static constexpr suture::attribute attributes[] = {
      suture::volume_attribute("rest_volume", "m^3", "Volume at rest").from_volumes(of<RestVolume>),
      suture::volume_attribute("twist_stiffness", "1/m", "k_a, of the checkerboard motions", 3)
          .from_volumes(of<TwistStiffness>),
      suture::volume_attribute("rest_twist", "m^2", "s_a at rest", 3).from_volumes(of<RestTwist>)};

  using functors = suture::list<KeepVolume, ResistCheckerboard>;
};

}  // namespace volume_model

SUTURE_PLUGIN("volume", "0.1.0", "MIT", "Preservation of volume for any model",
              volume_model::Volume)
