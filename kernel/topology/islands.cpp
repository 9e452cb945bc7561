// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/islands.hpp"

#include <algorithm>
#include <functional>
#include <queue>
#include <tuple>

#include "kernel/base/archive.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/topology/disjoint_sets.hpp"

namespace suture {
namespace {

template <class Visit>
void for_neighbours(const CellComplex& complex, Index element, const Visit& visit) {
  for (int f = 0; f < 6; ++f)
    if (const Index other = complex.neighbour(element, f); other != none) visit(other);
}

}  // namespace

/// What is connected to some elements of an island, as far as it is known.
struct Islands::Part {
  Index island;
  std::vector<Index> members;
  std::vector<Index> front;  ///< from `next` on: members whose neighbours are to be seen
  std::size_t next = 0;

  bool whole() const { return next == front.size(); }
  void add(Index element) {
    members.push_back(element);
    front.push_back(element);
  }
  void absorb(Part& other) {
    if (other.members.size() > members.size()) std::swap(*this, other);
    members.insert(members.end(), other.members.begin(), other.members.end());
    front.insert(front.end(), other.front.begin() + std::ptrdiff_t(other.next), other.front.end());
    other = {};
  }
};

/// Searches from all sides of the cuts through one island at once. The smallest part
/// is the next to grow; parts that meet are one. It is over when all parts but one are
/// whole: the last one is what these leave of the island. Unless that is more than each
/// of them has, the last one is searched to its end as well.
class Islands::ComponentSearch {
 public:
  ComponentSearch(const CellComplex& complex, std::vector<Index>& reached, std::vector<Part>& parts)
      : complex_(complex), reached_(reached), parts_(parts), sets_(parts.size()) {
    for (std::size_t i = 0; i < parts.size(); ++i) running_.push({parts[i].members.size(), i});
  }

  /// Afterwards parts that were absorbed are empty. `size`: elements of the island.
  void run(std::size_t size) {
    std::size_t live = parts_.size(), largest_whole = 0, in_whole = 0;
    while (live > 1 || (live == 1 && in_whole > 0 && size - in_whole <= largest_whole)) {
      const std::size_t i = smallest();
      const std::size_t absorbed = grow(i);
      live -= absorbed;
      const std::size_t now = sets_.find(i);
      if (parts_[now].whole()) {
        --live;
        in_whole += parts_[now].members.size();
        largest_whole = std::max(largest_whole, parts_[now].members.size());
      } else {
        running_.push({parts_[now].members.size(), now});
      }
    }
  }

 private:
  struct Entry {
    std::size_t size, part;
    bool operator>(const Entry& other) const {
      return std::pair(size, part) > std::pair(other.size, other.part);
    }
  };

  bool is_stale(const Entry& entry) {
    return sets_.find(entry.part) != entry.part || parts_[entry.part].whole() ||
           parts_[entry.part].members.size() != entry.size;
  }

  std::size_t smallest() {
    while (is_stale(running_.top())) running_.pop();
    const std::size_t part = running_.top().part;
    running_.pop();
    return part;
  }

  /// One turn of a part. Returns the number of parts that were met and are now this one.
  std::size_t grow(std::size_t i) {
    std::size_t absorbed = 0;
    for (int step = 0; step < 32 && !parts_[i].whole(); ++step) {
      const Index here = parts_[i].front[parts_[i].next++];
      for_neighbours(complex_, here, [&](Index there) {
        if (reached_[there] == none) {
          reached_[there] = static_cast<Index>(i);
          parts_[i].add(there);
          return;
        }
        const std::size_t other = sets_.find(reached_[there]);
        if (other == i) return;
        const std::size_t into = std::min(i, other), from = std::max(i, other);
        parts_[into].absorb(parts_[from]);
        sets_.unite(into, from);
        i = into;
        ++absorbed;
      });
    }
    return absorbed;
  }

  const CellComplex& complex_;
  std::vector<Index>& reached_;
  std::vector<Part>& parts_;
  DisjointSets sets_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> running_;
};

Islands::Islands(const CellComplex& complex) {
  island_ = complex.islands(&existing_);
  reached_.assign(island_.size(), none);
  size_.assign(existing_, 0);
  representative_.assign(existing_, none);
  for (Index e = 0; e < island_.size(); ++e)
    if (island_[e] != none && size_[island_[e]]++ == 0) representative_[island_[e]] = e;
}

IslandChange Islands::update(const CellComplex& complex, const TopologyChange& change) {
  IslandChange result;
  add_copies(change.copies);
  forget(change.removed[3], result);
  if (change.faces_sewn > 0) join(complex, change, result);
  if (change.faces_cut > 0 || !change.copies.empty()) split(complex, change, result);
  for (const Index e : change.elements) result.touched.push_back(island_[e]);
  for (const Split& split : result.splits) result.touched.push_back(split.new_cell);
  sort_unique(result.touched);
  return result;
}

/// Copies are in the island of their origins until that falls apart.
void Islands::add_copies(std::span<const Split> copies) {
  for (const auto& [origin, copy] : copies) {
    island_.push_back(island_[origin]);
    reached_.push_back(none);
    ++size_[island_[origin]];
  }
}

void Islands::forget(std::span<const Index> removed, IslandChange& result) {
  for (const Index e : removed) {
    const Index island = std::exchange(island_[e], none);
    if (--size_[island] == 0) result.removed.push_back(island);
  }
  existing_ -= static_cast<Index>(result.removed.size());
  std::ranges::sort(result.removed);
}

/// Sewn faces lie between elements of the change.
void Islands::join(const CellComplex& complex, const TopologyChange& change, IslandChange& result) {
  std::vector<std::pair<Index, Index>> equal;
  for (const Index e : change.elements)
    for_neighbours(complex, e, [&](Index other) {
      if (island_[other] != island_[e]) equal.emplace_back(island_[e], island_[other]);
    });
  for (const std::vector<Index>& group : groups_of_equal(equal)) {
    const Index kept = *std::ranges::max_element(group, {}, [&](Index i) {
      return std::pair(size_[i], none - i);  // among equals the smallest number
    });
    for (const Index gone : group) {
      if (gone == kept) continue;
      rename(complex, gone, kept);
      size_[kept] += std::exchange(size_[gone], 0);
      result.merges.push_back({kept, gone});
    }
  }
  existing_ -= static_cast<Index>(result.merges.size());
  std::ranges::sort(result.merges, {}, [](const Merge& m) { return std::pair(m.kept, m.gone); });
}

void Islands::rename(const CellComplex& complex, Index from, Index to) {
  std::vector<Index> found{representative_[from]};
  island_[representative_[from]] = to;
  for (std::size_t next = 0; next < found.size(); ++next)
    for_neighbours(complex, found[next], [&](Index other) {
      if (island_[other] != from) return;
      island_[other] = to;
      found.push_back(other);
    });
}

/// Wherever an island fell apart, each part holds elements of the change. Islands with
/// a single part are whole.
void Islands::split(const CellComplex& complex, const TopologyChange& change,
                    IslandChange& result) {
  std::vector<Part> parts = first_parts(complex, change.elements), leaving;
  for (auto first = parts.begin(); first != parts.end();) {
    const auto last = std::find_if(
        first, parts.end(), [island = first->island](const Part& p) { return p.island != island; });
    std::vector<Part> together{std::make_move_iterator(first), std::make_move_iterator(last)};
    if (together.size() > 1) separate(complex, together, leaving);
    first = last;
  }
  std::ranges::sort(leaving, {}, [](const Part& p) { return p.members[0]; });
  for (const Part& part : leaving) {
    const Index fresh = count();
    for (const Index e : part.members) island_[e] = fresh;
    size_[part.island] -= static_cast<Index>(part.members.size());
    size_.push_back(static_cast<Index>(part.members.size()));
    representative_.push_back(part.members[0]);
    result.splits.push_back({part.island, fresh});
  }
  existing_ += static_cast<Index>(leaving.size());
}

/// Those elements of a change that are linked directly or through each other start as
/// one part. By island.
std::vector<Islands::Part> Islands::first_parts(const CellComplex& complex,
                                                std::span<const Index> seeds) {
  DisjointSets sets(seeds.size());
  for (std::size_t i = 0; i < seeds.size(); ++i) reached_[seeds[i]] = static_cast<Index>(i);
  for (std::size_t i = 0; i < seeds.size(); ++i)
    for_neighbours(complex, seeds[i], [&](Index other) {
      if (reached_[other] != none) sets.unite(i, reached_[other]);
    });
  std::vector<Part> parts;
  std::vector<std::size_t> part_of(seeds.size());
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    reached_[seeds[i]] = none;
    const std::size_t first = sets.find(i);  // the smallest, so it has its part already
    if (first == i) {
      part_of[i] = parts.size();
      parts.push_back({island_[seeds[i]], {}, {}});
      representative_[island_[seeds[i]]] = seeds[i];
    }
    part_of[i] = part_of[first];
    parts[part_of[i]].add(seeds[i]);
  }
  std::ranges::stable_sort(parts, {}, &Part::island);
  return parts;
}

/// Finds what the parts of one island grow to; all but the one that keeps its number
/// are added to `leaving`, with their smallest element in front.
void Islands::separate(const CellComplex& complex, std::vector<Part>& parts,
                       std::vector<Part>& leaving) {
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (const Index e : parts[i].members) reached_[e] = static_cast<Index>(i);
  ComponentSearch(complex, reached_, parts).run(size_[parts[0].island]);
  std::erase_if(parts, [](const Part& p) { return p.members.empty(); });
  for (Part& part : parts) {
    for (const Index e : part.members) reached_[e] = none;
    std::iter_swap(part.members.begin(), std::ranges::min_element(part.members));
  }
  const auto kept = std::ranges::max_element(parts, {}, [](const Part& p) {
    return std::tuple(!p.whole(), p.members.size(), none - p.members[0]);
  });
  representative_[kept->island] = kept->members[0];
  for (auto it = parts.begin(); it != parts.end(); ++it)
    if (it != kept) leaving.push_back(std::move(*it));
}

std::vector<Index> Islands::elements(const CellComplex& complex, Index island) {
  std::vector<Index> found;
  if (size_[island] == 0) return found;
  found.reserve(size_[island]);
  const auto add = [&](Index e) {
    if (std::exchange(reached_[e], island) == none) found.push_back(e);
  };
  add(representative_[island]);
  for (std::size_t next = 0; next < found.size(); ++next) for_neighbours(complex, found[next], add);
  for (const Index e : found) reached_[e] = none;
  std::ranges::sort(found);
  return found;
}

std::vector<Index> Islands::smaller_than(Index elements) const {
  std::vector<Index> result;
  for (Index i = 0; i < count(); ++i)
    if (size_[i] > 0 && size_[i] < elements) result.push_back(i);
  return result;
}

void Islands::validate(const CellComplex& complex) const {
  const auto broken = [](const std::string& what) {
    throw TopologyError("the islands do not match the map: " + what);
  };
  Index components = 0;
  const std::vector<Index> component = complex.islands(&components);
  if (components != existing_)
    broken(std::to_string(existing_) + " are counted, but there are " + std::to_string(components));
  std::vector<Index> island_of(components, none), component_of(size_.size(), none),
      size(size_.size(), 0);
  const auto is_first_or = [](Index& known, Index value) {
    if (known == none) known = value;
    return known == value;
  };
  for (Index e = 0; e < component.size(); ++e) {
    const Index island = island_[e];
    if ((island == none) != (component[e] == none))
      broken("element " + std::to_string(e) + " was removed but has an island, or has none");
    if (island == none) continue;
    ++size[island];
    if (!is_first_or(island_of[component[e]], island) ||
        !is_first_or(component_of[island], component[e]))
      broken("element " + std::to_string(e) + " is wrongly assigned to island " +
             std::to_string(island));
    if (reached_[e] != none) broken("element " + std::to_string(e) + " is still marked");
  }
  for (Index i = 0; i < count(); ++i) {
    if (size[i] != size_[i])
      broken("island " + std::to_string(i) + " has " + std::to_string(size[i]) + " elements, not " +
             std::to_string(size_[i]));
    if (size_[i] > 0 && island_[representative_[i]] != i)
      broken("element " + std::to_string(representative_[i]) + " is not in island " +
             std::to_string(i));
  }
}

void Islands::state(Archive& archive) {
  if (!archive.has_cells()) return;
  archive("of_elements", island_);
  archive("sizes", size_);
  archive("some_element", representative_);
  archive("existing", existing_);
  archive.require(island_.size() == reached_.size() && representative_.size() == size_.size(),
                  "the islands belong to a different mesh");
  const auto are_below = [](const std::vector<Index>& values, std::size_t end) {
    return std::ranges::all_of(values, [&](Index value) { return value == none || value < end; });
  };
  archive.require(are_below(island_, size_.size()) && are_below(representative_, island_.size()),
                  "the islands name one that does not exist");
}

}  // namespace suture
