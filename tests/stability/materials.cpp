// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/materials.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace suture::test {
namespace {

constexpr double fibre_stiffness = 0.2, fibre_exponent = 1;                 // k1 / mu, k2
constexpr double solids_begin = 2, springs_begin = 0.5, damage_scale = 10;  // e0, e0, e1
constexpr double relaxation = 0.1138, fastest = 1e-5;  // n; tau over the period

std::string model_of(const std::string& name) { return name.substr(0, name.find('+')); }
double mu_of(const Material& m) { return m.young / (2 * (1 + m.poisson)); }
double lambda_of(const Material& m) {
  return m.young * m.poisson / ((1 + m.poisson) * (1 - 2 * m.poisson));
}
double damage_begins(const Material& m) {
  return is_lattice(m.name) ? springs_begin : solids_begin;
}
double product(const Vec3& v) { return v[0] * v[1] * v[2]; }
double square(double x) { return x * x; }

/// K of `visco` whose relaxed shear modulus is mu: G0 = c K sum_k (10^k tau)^-n, k > 4, with
/// c = ln 10 / (Gamma(1-n) Gamma(n)).
double relaxing_modulus(const Material& m) {
  const double n = relaxation, tau = fastest * m.period;
  const double c = std::log(10) / (std::tgamma(1 - n) * std::tgamma(n));
  return mu_of(m) * (1 - std::pow(10, -n)) / (c * std::pow(1e5 * tau, -n));
}

// ------------------------------------------------------------------- solids --

double solid_energy(const Material& m, const Vec3& s) {
  const std::string model = model_of(m.name);
  const double mu = mu_of(m), lambda = lambda_of(m), volume = product(s);
  double sum = 0, squares = 0, e = 0, ee = 0, inverse_squares = 0;
  for (const double x : s) {
    sum += x - 1;
    squares += x * x;
    inverse_squares += 1 / (x * x);
    e += (x * x - 1) / 2;
    ee += square((x * x - 1) / 2);
  }
  if (model == "tm-faure") return lambda / 2 * e * e + mu * ee;
  if (model == "hooke" || model == "corotational") {
    double deviation = 0;
    for (const double x : s) deviation += square(x - 1);
    return lambda / 2 * sum * sum + mu * deviation;
  }
  if (model == "mooney-rivlin") {
    const double first = std::pow(volume, -2.0 / 3) * squares;
    const double second = std::pow(volume, 2.0 / 3) * inverse_squares;
    return mu / 3 * (first - 3) + mu / 6 * (second - 3) +
           (lambda + 2 * mu / 3) / 2 * square(volume - 1);
  }
  const double isotropic = mu / 2 * (squares - 3) - mu * std::log(volume);
  if (model == "fibres") {
    const double pulled = std::max(0.0, s[0] * s[0] - 1);
    return isotropic + lambda / 2 * square(volume - 1) +
           fibre_stiffness * mu / (2 * fibre_exponent) *
               std::expm1(fibre_exponent * square(pulled));
  }
  return isotropic + lambda / 2 * square(std::log(volume));  // neo-hookean, visco, damage
}

// ------------------------------------------------------------------ springs --

/// An element's springs that are separated along the axes of m, a bit per axis: twelve edges are
/// 4 of each kind 1, 2, 4, twelve face diagonals 4 of 3, 5, 6, four inner diagonals of 7.
struct Springs {
  double constant[8] = {}, rest[8] = {};
};

double length_of(int m, const Vec3& edges) {
  double sum = 0;
  for (int a = 0; a < 3; ++a)
    if (m >> a & 1) sum += square(edges[static_cast<std::size_t>(a)]);
  return std::sqrt(sum);
}

Springs golec(double mu, const Vec3& l) {
  Springs s;
  const double volume = product(l), d2 = square(length_of(7, l));
  double largest = 0;
  for (std::size_t a = 0; a < 3; ++a) largest = std::max(largest, square(l[a] * l[(a + 1) % 3]));
  const double kd = 4.0 / 7 * mu * d2 * volume / (4 * largest);
  s.constant[7] = kd;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = a + 1; b < 3; ++b) {
      const double area = square(l[a] * l[b]);
      s.constant[1 << a | 1 << b] = (mu - 4 * kd * area / (d2 * volume)) *
                                    (square(l[a]) + square(l[b])) * volume / (4 * area);
    }
  for (std::size_t a = 0; a < 3; ++a) {
    const double fourth = square(square(l[a]));
    double left = 3 * mu - 4 * kd * fourth / (d2 * volume);
    for (std::size_t b = 0; b < 3; ++b)
      if (b != a)
        left -= 4 * s.constant[1 << a | 1 << b] * fourth / ((square(l[a]) + square(l[b])) * volume);
    s.constant[1 << a] = volume * left / (4 * square(l[a]));
  }
  return s;
}

Springs baudet(const Material& m, const Vec3& l) {
  Springs s;
  const double d2 = square(length_of(7, l)), kd = mu_of(m) * d2 / (4 * std::cbrt(product(l)));
  s.constant[7] = kd;
  for (std::size_t a = 0; a < 3; ++a) {
    const double b = l[(a + 1) % 3], c = l[(a + 2) % 3];
    const double shears = 4 * kd * l[a] / d2 * (b / c + c / b);  // G_ab + G_ac
    s.constant[1 << a] =
        std::max(0.0, b * c / (4 * l[a]) * (m.young + m.poisson * shears) - kd * square(l[a]) / d2);
  }
  return s;
}

double lattice_energy(const Material& m, const Vec3& l, const Vec3& stretch) {
  const std::string model = model_of(m.name);
  const Springs springs =
      model == "mss-baudet" ? baudet(m, l) : golec(m.young / (2 * (1 + m.poisson)), l);
  const Vec3 deformed{l[0] * stretch[0], l[1] * stretch[1], l[2] * stretch[2]};
  double sum = 0;
  for (int kind = 1; kind < 8; ++kind)
    sum += 4 * springs.constant[kind] / 2 * square(length_of(kind, deformed) - length_of(kind, l));
  sum /= product(l);
  if (model == "mss-golec") sum += (lambda_of(m) - mu_of(m)) / 2 * square(product(stretch) - 1);
  return sum;
}

double sound_energy(const Material& m, const Vec3& edges, const Vec3& stretch) {
  return is_lattice(m.name) ? lattice_energy(m, edges, stretch) : solid_energy(m, stretch);
}

/// 1 - d
double left_by_damage(const Material& m, const Vec3& edges, const Vec3& stretch) {
  const std::string model = model_of(m.name);
  if (model != "damage" && model != "damage-springs") return 1;
  const double modulus = model == "damage" ? mu_of(m) : m.young;
  const double strain = std::sqrt(std::max(0.0, 2 * sound_energy(m, edges, stretch) / modulus));
  const double begins = damage_begins(m), largest = std::max(strain, begins);
  return begins / largest * std::exp((begins - largest) / damage_scale);
}

}  // namespace

const std::vector<std::string>& material_names() {
  static const std::vector<std::string> names{"tm-faure",      "tm-faure+mean-gradient",
                                              "hooke",         "corotational",
                                              "neo-hookean",   "neo-hookean+trilinear",
                                              "mooney-rivlin", "fibres",
                                              "visco",         "damage",
                                              "mss-baudet",    "mss-golec",
                                              "damage-springs"};
  return names;
}

bool is_lattice(const std::string& name) {
  return name == "mss-baudet" || name == "mss-golec" || name == "damage-springs";
}
bool has_poisson(const std::string& name) { return name != "damage-springs"; }
bool keeps_state(const std::string& name) {
  return name == "visco" || name == "damage" || name == "damage-springs";
}

Json model_entry(const Material& m) {
  const std::string model = model_of(m.name);
  Json p{{"rho", m.density}};
  if (model == "mooney-rivlin") {
    p["C10"] = mu_of(m) / 3;
    p["C01"] = mu_of(m) / 6;
    p["K"] = lambda_of(m) + 2 * mu_of(m) / 3;
  } else if (model == "fibres" || model == "damage" || model == "visco") {
    p["lambda"] = lambda_of(m);
    if (model != "visco") p["mu"] = mu_of(m);
  } else {
    p["E"] = m.young;
    if (has_poisson(m.name)) p["nu"] = m.poisson;
  }
  if (model == "fibres") {
    p["k1"] = fibre_stiffness * mu_of(m);
    p["k2"] = fibre_exponent;
    p["fibre"] = {1, 0, 0};
  }
  if (model == "visco") {
    p["K"] = relaxing_modulus(m);
    p["n"] = relaxation;
    p["tau"] = fastest * m.period;
  }
  if (model == "damage" || model == "damage-springs") {
    p["e0"] = damage_begins(m);
    p["e1"] = damage_scale;
  }
  if (model != m.name) p["element"] = m.name.substr(model.size() + 1);
  return {{"model", model}, {"parameters", p}};
}

double energy_density(const Material& m, const Vec3& edges, const Vec3& stretch) {
  return sound_energy(m, edges, stretch) * left_by_damage(m, edges, stretch);
}

Vec3 nominal_stress(const Material& m, const Vec3& edges, const Vec3& stretch) {
  const double left = left_by_damage(m, edges, stretch), h = 1e-4;
  Vec3 stress{};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto at = [&](double steps) {
      Vec3 near = stretch;
      near[a] *= 1 + steps * h;
      return sound_energy(m, edges, near);
    };
    // Central differences of sixth order.
    stress[a] = left * (45 * (at(1) - at(-1)) - 9 * (at(2) - at(-2)) + (at(3) - at(-3))) /
                (60 * h * stretch[a]);
  }
  return stress;
}

Vec3 stretch_under(const Material& m, const Vec3& edges, double traction) {
  const double part = traction / m.young;
  Vec3 s{1 + part, 1 - m.poisson * part, 1 - m.poisson * part};
  for (int iteration = 0; iteration < 100; ++iteration) {
    const Vec3 stress = nominal_stress(m, edges, s);
    const Eigen::Vector3d residual(stress[0] - traction, stress[1], stress[2]);
    Eigen::Matrix3d tangent;
    for (std::size_t a = 0; a < 3; ++a) {
      constexpr double h = 1e-5;
      Vec3 up = s, down = s;
      up[a] += h;
      down[a] -= h;
      const Vec3 above = nominal_stress(m, edges, up), below = nominal_stress(m, edges, down);
      for (std::size_t i = 0; i < 3; ++i)
        tangent(static_cast<int>(i), static_cast<int>(a)) = (above[i] - below[i]) / (2 * h);
    }
    const Eigen::Vector3d step = tangent.partialPivLu().solve(residual);
    for (std::size_t a = 0; a < 3; ++a) s[a] -= step[static_cast<int>(a)];
  }
  return s;
}

}  // namespace suture::test
