// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/paper_body.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "apps/suture-bench/isosurface.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/base/vec3.hpp"

namespace suture::bench {
namespace {

Vec3 along(const Vec3& a, double t, const Vec3& d) {
  return {a[0] + t * d[0], a[1] + t * d[1], a[2] + t * d[2]};
}
/// A ball whose centre runs from a to b and whose radius goes over from `at_a` to `at_b`.
struct Limb {
  Vec3 a, b;
  double at_a, at_b;
};
struct Ellipsoid {
  Vec3 centre, half;
};
/// The upper part of an ellipsoid, above its centre.
struct Dome {
  Ellipsoid whole;
};

double distance(const Limb& limb, const Vec3& p) {
  const Vec3 d = minus(limb.b, limb.a);
  const double t = std::clamp(dot(minus(p, limb.a), d) / dot(d, d), 0.0, 1.0);
  const Vec3 r = minus(p, along(limb.a, t, d));
  return std::sqrt(dot(r, r)) - (limb.at_a + t * (limb.at_b - limb.at_a));
}

/// To first order k (k - 1) / |grad k^2 / 2|, k = |(p - c) / half|: exact on the surface.
double distance(const Ellipsoid& e, const Vec3& p) {
  double k0 = 0, k1 = 0;
  for (int a = 0; a < 3; ++a) {
    const double x = (p[a] - e.centre[a]) / e.half[a];
    k0 += x * x;
    k1 += x * x / (e.half[a] * e.half[a]);
  }
  k0 = std::sqrt(k0);
  if (k1 == 0) return -*std::ranges::min_element(e.half);
  return k0 * (k0 - 1) / std::sqrt(k1);
}

/// min(a, b), rounded off where they differ by less than k (Quilez' polynomial).
double blended(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - h * h * k / 4;
}

double distance(const Dome& dome, const Vec3& p) {
  const double below = dome.whole.centre[2] - p[2];
  return -blended(-distance(dome.whole, p), -below, dome.whole.half[2] / 2);
}

/// The parts of a body, and their union.
class Shape {
 public:
  explicit Shape(const BodyParameters& b) : blend_(b.blend) {
    ellipsoids_.push_back({{0, 0, 0}, b.torso});
    add_legs(b);
    add_front(b);
    if (b.tail_length > 0)
      limb({-0.9 * b.torso[0], 0, 0}, {-1, 0, -1}, b.tail_length, b.tail_radius, b.tail_radius);
    if (b.cap_radius > 0)
      domes_.push_back({{{0, 0, 0.8 * b.torso[2]}, {b.cap_radius, b.cap_radius, b.cap_height}}});
  }

  double value(const Vec3& p) const {
    double d = distance(ellipsoids_[0], p);
    for (std::size_t i = 1; i < ellipsoids_.size(); ++i) add(d, distance(ellipsoids_[i], p));
    for (const Limb& l : limbs_) add(d, distance(l, p));
    for (const Dome& dome : domes_) add(d, distance(dome, p));
    return d;
  }

  /// The radius of a ball around the origin that holds everything.
  double radius() const {
    const auto norm = [](const Vec3& v) { return std::sqrt(dot(v, v)); };
    double r = 0;
    for (const Ellipsoid& e : ellipsoids_)
      r = std::max(r, norm(e.centre) + *std::ranges::max_element(e.half));
    for (const Limb& l : limbs_) r = std::max({r, norm(l.a) + l.at_a, norm(l.b) + l.at_b});
    for (const Dome& d : domes_)
      r = std::max(r, norm(d.whole.centre) + *std::ranges::max_element(d.whole.half));
    return r + blend_;
  }

  /// The smallest thickness of a part.
  double thickness() const {
    double t = 2 * *std::ranges::min_element(ellipsoids_[0].half);
    for (const Ellipsoid& e : ellipsoids_) t = std::min(t, 2 * *std::ranges::min_element(e.half));
    for (const Limb& l : limbs_) t = std::min(t, 2 * std::min(l.at_a, l.at_b));
    for (const Dome& d : domes_) t = std::min(t, d.whole.half[2]);
    return t;
  }

 private:
  void add(double& d, double part) const {
    d = blend_ > 0 ? blended(d, part, blend_) : std::min(d, part);
  }

  void limb(const Vec3& from, const Vec3& direction, double length, double at_a, double at_b) {
    const double size = std::sqrt(dot(direction, direction));
    limbs_.push_back({from, along(from, length / size, direction), at_a, at_b});
  }

  void add_legs(const BodyParameters& b) {
    if (b.leg_length == 0) return;
    for (const double x : {-1.0, 1.0})
      for (const double y : {-1.0, 1.0})
        limbs_.push_back({{x * b.leg_x, y * b.leg_y, 0},
                          {x * (b.leg_x + b.leg_splay), y * (b.leg_y + b.leg_splay), -b.leg_length},
                          1.3 * b.leg_radius,
                          b.leg_radius});
  }

  // Neck, head, nose and ears, each from where the one before ends.
  void add_front(const BodyParameters& b) {
    Vec3 end{0.85 * b.torso[0], 0, 0.2 * b.torso[2]};
    if (b.neck_length > 0) {
      limb(end, {std::cos(b.neck_slope), 0, std::sin(b.neck_slope)}, b.neck_length,
           1.4 * b.neck_radius, b.neck_radius);
      end = limbs_.back().b;
    }
    if (b.head_length > 0) {
      limb(end, {1, 0, -0.25}, b.head_length, b.head_radius, 0.7 * b.head_radius);
      if (b.ear_radius > 0)
        for (const double y : {-1.0, 1.0})
          ellipsoids_.push_back({{end[0], y * (0.7 * b.head_radius + 0.7 * b.ear_radius), end[2]},
                                 {b.ear_thickness / 2, b.ear_radius, b.ear_radius}});
      end = limbs_[limbs_.size() - 1].b;
    }
    if (b.nose_length > 0)
      limb(end, {0.35, 0, -1}, b.nose_length, b.nose_radius, 0.6 * b.nose_radius);
  }

  double blend_;
  std::vector<Ellipsoid> ellipsoids_;
  std::vector<Limb> limbs_;
  std::vector<Dome> domes_;
};

void check(const BodyParameters& b) {
  const double lengths[] = {
      b.leg_length,    b.leg_radius,  b.leg_x,       b.leg_y,       b.leg_splay,   b.neck_length,
      b.neck_radius,   b.head_length, b.head_radius, b.nose_length, b.nose_radius, b.ear_radius,
      b.ear_thickness, b.tail_length, b.tail_radius, b.cap_radius,  b.cap_height,  b.blend};
  for (const double x : lengths)
    if (!(x >= 0) || !std::isfinite(x))
      throw InputError("body: lengths must be finite and not negative");
  for (const double x : b.torso)
    if (!(x > 0) || !std::isfinite(x))
      throw InputError("body: the torso's half axes must be positive and finite");
  if (!std::isfinite(b.neck_slope)) throw InputError("body: the neck's slope must be finite");
}

// Triangles of a body grow with 1 / size^2; counted where they are few.
void require_few(const BodyParameters& parameters, double size, double coarse) {
  constexpr double most = 50e6;
  if (size >= coarse / 20) return;  // 400 times those of a coarse surface: some millions
  const double ratio = coarse / size;
  const double estimate =
      double(generate_body(parameters, coarse).triangles.size()) * ratio * ratio;
  if (estimate <= most) return;
  char text[200];
  std::snprintf(text, sizeof text,
                "body: triangles of %.4g m would be about %.2g, more than 50 million; use a size "
                "of at least %.2g m",
                size, estimate, size * std::sqrt(estimate / most));
  throw InputError(text);
}

}  // namespace

TriangleSurface generate_body(const BodyParameters& parameters, double size) {
  check(parameters);
  const Shape body(parameters);
  const double radius = body.radius();
  if (!(size >= 0) || !std::isfinite(size))
    throw InputError("body: the size of triangles must be positive and finite");
  const double coarse = std::min(radius / 30, body.thickness());
  if (size == 0) size = coarse;
  if (size > body.thickness())
    throw InputError("body: triangles of " + std::to_string(size) +
                     " m would lose parts that are " + std::to_string(body.thickness()) +
                     " m thick; use a smaller size");
  require_few(parameters, size, coarse);
  TriangleSurface surface =
      isosurface([&](const Vec3& p) { return body.value(p); }, {0, 0, 0}, 1.1 * radius, size);
  surface.source = "body";
  return surface;
}

const BodyPreset& body_preset(std::string_view name) {
  std::vector<std::string> names;
  std::string list;
  for (const BodyPreset& preset : body_presets()) {
    if (preset.name == name) return preset;
    names.push_back(preset.name);
    list += (list.empty() ? "" : ", ") + preset.name;
  }
  throw UsageError("no body is called '" + std::string(name) + "'" + did_you_mean(name, names) +
                   "; expected one of " + list);
}

}  // namespace suture::bench
