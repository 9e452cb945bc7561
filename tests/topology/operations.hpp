// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <random>
#include <span>
#include <vector>

#include "kernel/base/error.hpp"
#include "kernel/topology/journal.hpp"

namespace suture {

/// Cuts, removals and sutures at random, each of them possible on the map as it is.
class Operations {
 public:
  explicit Operations(std::mt19937& random) : random_(random) {}

  Request next(const CellComplex& map) {
    const auto kind = random_() % 8;
    if (kind < 4) return cut(map);
    return kind < 6 ? pierce(map) : sew(map);
  }
  /// A few faces, at times a third of all.
  Request cut(const CellComplex& map) {
    Request result{Operation::Kind::cut, {}, {}, {}};
    for (Dart d = 0; d < 24 * map.element_count(); d += 4)
      if (map.exists(3, d / 24) && map.can_cut(d) && d < map.beta3(d)) result.faces.push_back(d);
    std::shuffle(result.faces.begin(), result.faces.end(), random_);
    const std::size_t all = result.faces.size(), most = random_() % 4 == 0 ? all / 3 : all / 20;
    result.faces.resize(std::min(all, 1 + random_() % (most + 1)));
    for (const Dart d : result.faces) open_.push_back({d, map.beta3(d)});
    return result;
  }

 private:
  Request pierce(const CellComplex& map) {
    Request result{Operation::Kind::pierce, {}, {}, {}};
    for (auto n = 1 + random_() % (1 + map.element_count() / 20); n > 0; --n)
      if (const auto e = static_cast<Index>(random_() % map.element_count());
          map.exists(3, e) && result.elements.size() + 1 < map.existing(3))
        result.elements.push_back(e);
    return result;
  }
  /// Half of what was cut and can be sewn; at times two faces that never met.
  Request sew(const CellComplex& map) {
    if (random_() % 3 == 0) return sew_strangers(map);
    std::erase_if(open_, [&](const Seam& s) { return !map.can_sew(s.one, s.other); });
    std::shuffle(open_.begin(), open_.end(), random_);
    const auto first = open_.begin() + static_cast<std::ptrdiff_t>(open_.size() / 2);
    Request result{Operation::Kind::sew, {}, {}, {first, open_.end()}};
    open_.erase(first, open_.end());
    while (!are_possible(map, result.seams)) result.seams.resize(result.seams.size() / 2);
    return result;
  }

  Request sew_strangers(const CellComplex& map) {
    Request result{Operation::Kind::sew, {}, {}, {}};
    for (int tries = 0; tries < 100 && result.seams.empty(); ++tries) {
      const Seam seam{some_face(map), some_face(map)};
      if (map.can_sew(seam.one, seam.other)) result.seams.push_back(seam);
    }
    return result;
  }
  /// Together, after strangers were sewn in between.
  static bool are_possible(CellComplex map, std::span<const Seam> seams) {
    try {
      map.sew(seams);
      return true;
    } catch (const TopologyError&) {
      return false;
    }
  }
  Dart some_face(const CellComplex& map) {
    return static_cast<Dart>(random_() % (24 * std::size_t{map.element_count()}));
  }

  std::mt19937& random_;
  std::vector<Seam> open_;
};

}  // namespace suture
