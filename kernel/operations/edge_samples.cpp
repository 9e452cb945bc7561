// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/edge_samples.hpp"

#include <algorithm>
#include <cmath>

namespace suture {
namespace {

constexpr double most_samples = 1e5;
// Numbers of samples are exact up to here.
constexpr double most_exact = 1e12;

Vec3 between(const Vec3& a, const Vec3& b, double share) {
  return plus(scaled(1 - share, a), scaled(share, b));
}

/// The shares of the way from `a` to `b` for which a coordinate is at most `high`; first > last if
/// there are none.
Shares below(double a, double b, double high) {
  if (a <= high && b <= high) return {0, 1};
  if (a > high && b > high) return {1, 0};
  const double at = (high - a) / (b - a);
  return a <= high ? Shares{0, at} : Shares{at, 1};
}
Shares hull(const Shares& a, const Shares& b) {
  if (a.first > a.second) return b;
  if (b.first > b.second) return a;
  return {std::min(a.first, b.first), std::max(a.second, b.second)};
}
Shares both(const Shares& a, const Shares& b) {
  return {std::max(a.first, b.first), std::min(a.second, b.second)};
}

}  // namespace

EdgeSamples::EdgeSamples(const std::vector<Vec3>& edge, double spacing) {
  double total = 1;
  for (std::size_t i = 0; i + 1 < edge.size(); ++i) {
    const double length = norm(minus(edge[i + 1], edge[i]));
    before_.push_back(total - 1);
    divisions_.push_back(std::min(std::ceil(length / spacing) + 1, most_exact));
    total += divisions_.back();
  }
  is_long_ = total > most_samples;
  if (!is_long_) return;
  for (std::size_t i = 0; i < divisions_.size(); ++i)
    samples_.push_back({static_cast<double>(i), 0});
  samples_.push_back({static_cast<double>(divisions_.size() - 1), divisions_.back()});
}

std::size_t EdgeSamples::count() const {
  return is_long_ ? samples_.size()
                  : static_cast<std::size_t>(before_.back() + divisions_.back()) + 1;
}

std::vector<Vec3> EdgeSamples::places(const std::vector<Vec3>& edge) const {
  std::vector<Vec3> places;
  places.reserve(count());
  if (is_long_) {
    for (const auto& [segment, number] : samples_) {
      const auto i = static_cast<std::size_t>(segment);
      places.push_back(between(edge[i], edge[i + 1], number / divisions_[i]));
    }
    return places;
  }
  places.push_back(edge[0]);
  for (std::size_t i = 0; i + 1 < edge.size(); ++i)
    for (double k = 1; k <= divisions_[i]; ++k)
      places.push_back(between(edge[i], edge[i + 1], k / divisions_[i]));
  return places;
}

double EdgeSamples::position(const Sample& sample) const {
  return before_[static_cast<std::size_t>(sample.segment)] + sample.number;
}

/// Whether all of these samples of a segment are there.
bool EdgeSamples::has_samples(std::size_t segment, double first, double last) const {
  const auto at = [&](double number) {
    return std::ranges::lower_bound(samples_, before_[segment] + number, {},
                                    [&](const Sample& s) { return position(s); });
  };
  const auto low = at(first), high = at(last);
  return low != samples_.end() && high != samples_.end() &&
         position(*low) == before_[segment] + first && position(*high) == before_[segment] + last &&
         static_cast<double>(high - low) == last - first;
}

std::optional<std::vector<EdgeSamples::Between>> EdgeSamples::cover(const std::vector<Vec3>& edge,
                                                                    const Box& box) {
  std::vector<Sample> wanted;
  for (std::size_t i = 0; i < divisions_.size(); ++i) {
    const std::vector<Vec3> from{edge[i]}, to{edge[i + 1]};
    const auto in_box = shares_in(from, to, box);
    if (!in_box) continue;
    const double first = std::floor(in_box->first * divisions_[i]),
                 last = std::ceil(in_box->second * divisions_[i]);
    if (has_samples(i, first, last)) continue;
    const double more = std::max(last - first, 1.0);  // the edge may slide along itself
    for (double k = std::max(first - more, 0.0); k <= std::min(last + more, divisions_[i]); ++k)
      wanted.push_back({static_cast<double>(i), k});
  }
  if (wanted.empty()) return {};
  const std::vector<Sample> old = samples_;
  samples_.insert(samples_.end(), wanted.begin(), wanted.end());
  const auto place = [&](const Sample& s) { return position(s); };
  std::ranges::sort(samples_, {}, place);
  const auto same = [&](const Sample& a, const Sample& b) { return place(a) == place(b); };
  samples_.erase(std::unique(samples_.begin(), samples_.end(), same), samples_.end());
  std::vector<Between> lie;
  for (const Sample& sample : samples_) {
    const auto next = std::ranges::upper_bound(old, position(sample), {}, place);
    const std::size_t high =
        std::clamp<std::size_t>(static_cast<std::size_t>(next - old.begin()), 1, old.size() - 1);
    const double low_at = position(old[high - 1]), high_at = position(old[high]);
    lie.push_back({high - 1, high, (position(sample) - low_at) / (high_at - low_at)});
  }
  return lie;
}

std::optional<Shares> shares_in(const std::vector<Vec3>& from, const std::vector<Vec3>& to,
                                const Box& box) {
  Shares all{1, 0};
  for (std::size_t i = 0; i + 1 < std::max<std::size_t>(from.size(), 2); ++i) {
    const std::size_t j = std::min(i + 1, from.size() - 1);
    Shares in{0, 1};
    for (std::size_t c = 0; c < 3; ++c) {
      in = both(in, hull(below(from[i][c], to[i][c], box.high[c]),
                         below(from[j][c], to[j][c], box.high[c])));
      in = both(in, hull(below(-from[i][c], -to[i][c], -box.low[c]),
                         below(-from[j][c], -to[j][c], -box.low[c])));
    }
    all = hull(all, in);
  }
  if (all.first > all.second) return {};
  return all;
}

}  // namespace suture
