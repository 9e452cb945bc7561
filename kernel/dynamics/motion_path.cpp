// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/motion_path.hpp"

#include <math.h>  // pchip.hpp of Boost 1.74 calls ::isnan

#include <algorithm>
#include <boost/math/interpolators/pchip.hpp>
#include <cmath>

#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

Placed placed(const std::array<double, 4>& place, const std::array<double, 4>& rate = {}) {
  return {{place[0], place[1], place[2]}, place[3], {rate[0], rate[1], rate[2]}, rate[3]};
}

/// Largest |u'| of a segment: of a cubic, at its ends or where u'' = 0, which is where s is
/// (3 D - 2 u0' - u1') / (3 (2 D - u0' - u1')), D = (u1 - u0) / h.
double largest_rate(const MotionPath::Station& from, const MotionPath::Station& to, std::size_t c,
                    bool is_linear) {
  const double mean = (to.place[c] - from.place[c]) / (to.at - from.at);
  if (is_linear) return std::abs(mean);
  const double a = from.slope[c], b = to.slope[c];
  double largest = std::max(std::abs(a), std::abs(b));
  const double s = (3 * mean - 2 * a - b) / (3 * (2 * mean - a - b));
  if (s > 0 && s < 1)
    largest = std::max(largest, std::abs(6 * s * (1 - s) * mean + (1 - s) * (1 - 3 * s) * a +
                                         s * (3 * s - 2) * b));
  return largest;
}

}  // namespace

bool MotionPath::turns() const {
  return std::ranges::any_of(stations, [](const Station& s) { return s.place[3] != 0; });
}

bool MotionPath::has_slopes() const {
  return std::ranges::any_of(stations,
                             [](const Station& s) { return s.slope != std::array<double, 4>{}; });
}

Placed MotionPath::at(double time) const {
  const auto next = std::ranges::upper_bound(stations, time, {}, &Station::at);
  if (next == stations.begin()) return placed(stations.front().place);
  if (next == stations.end()) return placed(stations.back().place);
  const Station &a = *(next - 1), &b = *next;
  const double h = b.at - a.at, s = (time - a.at) / h, r = 1 - s;
  std::array<double, 4> place, rate;
  for (std::size_t c = 0; c < 4; ++c) {
    const double change = b.place[c] - a.place[c];
    place[c] = a.place[c] + (is_linear ? s * change
                                       : s * s * (3 - 2 * s) * change +
                                             h * (s * r * r * a.slope[c] - s * s * r * b.slope[c]));
    rate[c] = is_linear ? change / h
                        : 6 * s * r * change / h + r * (1 - 3 * s) * a.slope[c] +
                              s * (3 * s - 2) * b.slope[c];
  }
  return placed(place, rate);
}

std::vector<double> MotionPath::corners() const {
  std::vector<double> times;
  for (std::size_t i = 0; i < stations.size(); ++i)
    if (is_linear || i == 0 || i + 1 == stations.size()) times.push_back(stations[i].at);
  return times;
}

double MotionPath::top_speed(double radius) const {
  double top = 0;
  for (std::size_t i = 0; i + 1 < stations.size(); ++i) {
    std::array<double, 4> rate;
    for (std::size_t c = 0; c < 4; ++c)
      rate[c] = largest_rate(stations[i], stations[i + 1], c, is_linear);
    top = std::max(top, norm({rate[0], rate[1], rate[2]}) + radius * rate[3]);
  }
  return top;
}

void MotionPath::make_monotone() {
  is_linear = false;
  for (std::size_t c = 0; c < 4; ++c) {
    std::vector<double> times, places;
    for (const Station& station : stations) {
      times.push_back(station.at);
      places.push_back(station.place[c]);
    }
    // At rest before and after.
    const boost::math::interpolators::pchip<std::vector<double>> curve(std::move(times),
                                                                       std::move(places), 0.0, 0.0);
    for (Station& station : stations) station.slope[c] = curve.prime(station.at);
  }
}

void MotionPath::state(Archive& archive) {
  archive("linear", is_linear);
  archive.member("times", stations, &Station::at);
  archive.member("places", stations, &Station::place);
  archive.member("slopes", stations, &Station::slope);
}

}  // namespace suture
