// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "kernel/base/archive.hpp"
#include "kernel/base/box.hpp"

namespace suture {

/// The samples at which a moving polyline is traced: along each of its segments, at equal distances
/// of at most `spacing` in its first position. Where these would be more than 100,000, there are
/// samples near the body only.
class EdgeSamples {
 public:
  EdgeSamples(const std::vector<Vec3>& edge, double spacing);

  /// Where the samples are when the polyline has these points.
  std::vector<Vec3> places(const std::vector<Vec3>& edge) const;
  std::size_t count() const;
  /// Whether there are samples near the body only.
  bool is_long() const { return is_long_; }

  /// Where each new sample lies between two old ones, or beyond them.
  struct Between {
    std::size_t low, high;
    double share;
  };
  /// Of a long polyline with these points: adds samples until all of it in the box has some.
  /// Returns how the new ones lie among the old ones; none if nothing has changed.
  std::optional<std::vector<Between>> cover(const std::vector<Vec3>& edge, const Box& box);

  /// Only samples change.
  void state(Archive& archive) { archive.rows<double>("samples", samples_); }

 private:
  struct Sample {
    double segment, number;  ///< along the segment, from 0 to its divisions
  };
  double position(const Sample& sample) const;
  bool has_samples(std::size_t segment, double first, double last) const;

  std::vector<double> divisions_;  ///< of each segment
  std::vector<double> before_;     ///< divisions of the segments before each
  bool is_long_ = false;
  std::vector<Sample> samples_;  ///< of a long polyline, ascending, with the ends of all segments
};

/// Part of a motion: from the first share to the last one.
using Shares = std::pair<double, double>;
/// When a polyline that moves straight from `from` to `to` may be in the box; none: never.
std::optional<Shares> shares_in(const std::vector<Vec3>& from, const std::vector<Vec3>& to,
                                const Box& box);

}  // namespace suture
