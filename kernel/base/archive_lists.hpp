// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "kernel/base/archive.hpp"
#include "kernel/base/types.hpp"

namespace suture {

/// Archives many short lists as two arrays in compressed rows; on loading, `lists` is resized to
/// the number saved.
inline void archive_lists(Archive& archive, const char* name,
                          std::vector<std::vector<Index>>& lists) {
  archive.group(name, [&] {
    std::vector<std::uint64_t> ends;
    std::vector<Index> values;
    for (std::size_t i = 0; i < lists.size() && !archive.loads(); ++i) {
      values.insert(values.end(), lists[i].begin(), lists[i].end());
      ends.push_back(values.size());
    }
    archive("ends", ends);
    archive("values", values);
    if (!archive.loads()) return;
    archive.require(values.size() == (ends.empty() ? 0 : ends.back()) &&
                        std::is_sorted(ends.begin(), ends.end()),
                    "the ends of the lists do not match their values");
    lists.assign(ends.size(), {});
    for (std::size_t i = 0, begin = 0; i < ends.size(); begin = ends[i++])
      lists[i].assign(values.begin() + static_cast<std::ptrdiff_t>(begin),
                      values.begin() + static_cast<std::ptrdiff_t>(ends[i]));
  });
}

}  // namespace suture
