// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

namespace suture {

/// A value over time: linear between stations, constant before the first and after the last.
struct ValuePath {
  struct Station {
    double at = 0;  ///< s
    double value = 0;
    bool operator==(const Station&) const = default;
  };
  std::vector<Station> stations;  ///< by time, at least one

  double value(double time) const {
    const auto after = std::ranges::upper_bound(stations, time, {}, &Station::at);
    if (after == stations.begin()) return stations.front().value;
    const Station& last = after[-1];
    if (after == stations.end()) return last.value;
    return last.value + (after->value - last.value) * ((time - last.at) / (after->at - last.at));
  }
};

}  // namespace suture
