// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/batch_list.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>

#include "kernel/base/archive_lists.hpp"
#include "kernel/base/bulk.hpp"
#include "kernel/base/lanes.hpp"

namespace suture {
namespace {

constexpr Index least_tail = 512;  // rows; a small tail is never worth colouring
constexpr Index max_colours = 64;  // threads wait for each other between colours

/// Cuts ranges into chunks of about `size` rows, at borders of blocks.
std::vector<std::vector<loops::Rows>> make_chunks(std::span<const loops::Rows> rows, Index size) {
  std::vector<std::vector<loops::Rows>> chunks;
  Index open = 0;  // rows in the last chunk
  for (loops::Rows range : rows) {
    while (range.begin < range.end) {
      if (chunks.empty() || open >= size) {
        chunks.emplace_back();
        open = 0;
      }
      const Index room = size - open;
      Index end = range.end;
      if (range.end - range.begin > room) {
        end = std::min(range.end, (range.begin + room + lanes - 1) / lanes * lanes);
      }
      chunks.back().push_back({range.begin, end});
      open += end - range.begin;
      range.begin = end;
    }
  }
  return chunks;
}

/// Appends the blocks of a range for which !drop(block), joined; returns the rows that were
/// dropped. What begins where another range ends stays apart: the rows there differ
/// (element_rows()).
template <class Drop>
Index keep(loops::Rows range, Drop drop, std::vector<loops::Rows>& kept) {
  Index dropped = 0;
  const std::size_t first = kept.size();
  while (range.begin < range.end) {
    const loops::Rows block{range.begin, std::min(range.end, (range.begin / lanes + 1) * lanes)};
    range.begin = block.end;
    if (drop(block))
      dropped += block.end - block.begin;
    else if (kept.size() > first && kept.back().end == block.begin)
      kept.back().end = block.end;
    else
      kept.push_back(block);
  }
  return dropped;
}

void add_once(Index chunk, std::vector<Index>& chunks) {
  if (std::ranges::find(chunks, chunk) == chunks.end()) chunks.push_back(chunk);
}

template <class Visit>
void for_each_vertex(const Connectivity& cells, std::span<const loops::Rows> ranges, Visit visit) {
  for (const loops::Rows& range : ranges) {
    if (!cells.cells && !cells.live) {
      const Index* const first = cells.of(range.begin).data();
      const std::size_t count = std::size_t{range.end - range.begin} * cells.node_count;
      for (const Index vertex : std::span(first, count)) visit(vertex);
      continue;
    }
    for (Index row = range.begin; row < range.end; ++row)
      for (const Index vertex : cells.of(row)) visit(vertex);
  }
}

/// That some rows touch: of rows that a cut adds it is a high one.
Index lowest_vertex(const Connectivity& cells, const loops::Rows& rows, Index vertex_count) {
  Index lowest = vertex_count;
  for_each_vertex(cells, {&rows, 1}, [&](Index v) { lowest = std::min(lowest, v); });
  return lowest;
}

}  // namespace

Index chunk_rows(Index rows) { return std::clamp<Index>(rows / 64 / lanes * lanes, 64, 2048); }

std::vector<Index> colour_chunks(const Connectivity& cells,
                                 std::span<const std::vector<loops::Rows>> chunks,
                                 loops::Rows vertices) {
  // Colours met at each vertex, 64 at a time. Meshes in a sensible order need
  // about ten; only chunks left over by one round of 64 see another.
  std::vector<Index> colour(chunks.size(), none);
  const Index low = vertices.begin;
  BulkVector<std::uint64_t> met(vertices.end - low);
  Index first = 0;
  for (std::size_t left = chunks.size(); left != 0; first += 64) {
    std::fill(met.begin(), met.end(), 0);
    for (std::size_t c = 0; c < chunks.size(); ++c) {
      if (colour[c] != none) continue;
      std::uint64_t taken = 0;
      for_each_vertex(cells, chunks[c], [&](Index v) { taken |= met[v - low]; });
      if (taken == ~std::uint64_t{0}) continue;
      const int bit = std::countr_one(taken);
      colour[c] = first + static_cast<Index>(bit);
      --left;
      for_each_vertex(cells, chunks[c], [&](Index v) { met[v - low] |= std::uint64_t{1} << bit; });
    }
  }
  return colour;
}

BatchList::BatchList(const Connectivity& cells, std::vector<loops::Rows> rows, Index vertex_count) {
  add_coloured(cells, rows, {0, vertex_count});
  find_order(cells, 0, {0, vertex_count});
}

void BatchList::add_coloured(const Connectivity& cells, std::span<const loops::Rows> rows,
                             loops::Rows vertices) {
  Index added = 0;
  for (const loops::Rows& range : rows) added += range.end - range.begin;
  cells_ += added;
  const auto chunks = make_chunks(rows, chunk_rows(added));
  const std::vector<Index> colour = colour_chunks(cells, chunks, vertices);
  const Index colours = chunks.empty() ? 0 : *std::max_element(colour.begin(), colour.end()) + 1;
  std::vector<std::vector<Index>> of_colour(colours);
  for (std::size_t c = 0; c < chunks.size(); ++c)
    of_colour[colour[c]].push_back(static_cast<Index>(c));
  for (const auto& members : of_colour) {
    for (const Index c : members) add_chunk(chunks[c]);
    colour_begin_.push_back(chunk_count());
  }
}

void BatchList::add_chunk(std::span<const loops::Rows> ranges) {
  ranges_.insert(ranges_.end(), ranges.begin(), ranges.end());
  chunk_begin_.push_back(static_cast<Index>(ranges_.size()));
}

/// Orders the chunks from `first` on. Waiting for the last chunk before at each vertex is
/// enough: it waits for those before.
void BatchList::find_order(const Connectivity& cells, Index first, loops::Rows vertices) {
  auto& before = order_.before;
  before.resize(first);
  before.resize(chunk_count());
  std::vector<Index> last(vertices.end - vertices.begin, none);
  for (Index c = first; c < chunk_count(); ++c)
    for_each_vertex(cells, ranges(c), [&](Index v) {
      Index& earlier = last[v - vertices.begin];
      if (earlier != none && earlier != c) add_once(earlier, before[c]);
      earlier = c;
    });
  if (first != 0) {
    before[first].resize(first);
    std::iota(before[first].begin(), before[first].end(), 0);
    for (Index c = first + 1; c < chunk_count(); ++c) add_once(first, before[c]);
  }
  std::vector<Index> by_row(chunk_count());
  std::iota(by_row.begin(), by_row.end(), 0);
  std::ranges::sort(by_row, {}, [&](Index c) { return ranges(c).front().begin; });
  order_.place.resize(chunk_count());
  for (Index place = 0; place < chunk_count(); ++place) order_.place[by_row[place]] = place;
}

void BatchList::meet(std::span<const Index> chunks) {
  for (std::size_t i = 1; i < chunks.size(); ++i) add_once(chunks[i - 1], order_.before[chunks[i]]);
}

void BatchList::leave_out(const Connectivity& cells, const std::vector<bool>& fixed) {
  const auto all_still = [&](loops::Rows block) {
    bool all = true;
    for_each_vertex(cells, {&block, 1}, [&](Index v) { all = all && (v == none || fixed[v]); });
    return all;
  };
  BatchList kept;
  kept.cells_ = cells_;
  kept.tail_ = tail_;
  kept.left_out_ = left_out_;
  std::vector<loops::Rows> chunk;
  for (Index colour = 0; colour < colour_count(); ++colour) {
    for (Index c = chunk_begin(colour); c < chunk_end(colour); ++c) {
      chunk.clear();
      for (const loops::Rows& range : ranges(c)) kept.left_out_ += keep(range, all_still, chunk);
      if (!chunk.empty()) kept.add_chunk(chunk);
    }
    kept.colour_begin_.push_back(kept.chunk_count());
  }
  kept.find_order(cells, 0, {0, static_cast<Index>(fixed.size())});
  *this = std::move(kept);
}

bool BatchList::append(const Connectivity& cells, Index first, Index last, Index vertex_count) {
  if (first == last) return true;
  // The tail grows: a thousand cuts of one face each shall not leave a thousand chunks.
  if (tail_ > 0 && !ranges_.empty() && ranges_.back().end == first) {
    ranges_.back().end = last;
  } else {
    const loops::Rows added{first, last};
    add_chunk({&added, 1});
    colour_begin_.push_back(chunk_count());
    order_.place.push_back(chunk_count() - 1);
    auto& all = order_.before.emplace_back(chunk_count() - 1);
    std::iota(all.begin(), all.end(), 0);
  }
  tail_ += last - first;
  if (tail_ <= least_tail || tail_ <= cells_ / 8) return true;
  const loops::Rows tail = ranges_.back();
  if (tail.end - tail.begin != tail_ || colour_count() > max_colours) return false;
  ranges_.pop_back();
  chunk_begin_.pop_back();
  colour_begin_.pop_back();
  tail_ = 0;
  const Index first_of_tail = chunk_count();
  const loops::Rows vertices{lowest_vertex(cells, tail, vertex_count), vertex_count};
  add_coloured(cells, {&tail, 1}, vertices);
  find_order(cells, first_of_tail, vertices);
  return true;
}

void BatchList::state(Archive& archive) {
  archive("cells", cells_);
  archive("tail", tail_);
  archive("left_out", left_out_);
  archive.rows<Index>("ranges", ranges_);
  archive("chunk_begin", chunk_begin_);
  archive("colour_begin", colour_begin_);
  archive_lists(archive, "before", order_.before);
  archive("place", order_.place);
  archive.require(!chunk_begin_.empty() && chunk_begin_.back() == ranges_.size() &&
                      !colour_begin_.empty() && colour_begin_.back() == chunk_count() &&
                      order_.before.size() == chunk_count() && order_.place.size() == chunk_count(),
                  "the chunks do not match their order");
}

ChunkFinder::ChunkFinder(const BatchList& list) : colour_of_(list.chunk_count()) {
  for (Index colour = 0; colour < list.colour_count(); ++colour)
    for (Index c = list.chunk_begin(colour); c < list.chunk_end(colour); ++c) {
      colour_of_[c] = colour;
      for (const loops::Rows& range : list.ranges(c)) chunk_rows_.push_back({range, c});
    }
  std::ranges::sort(chunk_rows_, {}, [](const ChunkRows& c) { return c.rows.begin; });
}

Index ChunkFinder::chunk(Index row) const {
  const auto after = std::ranges::upper_bound(chunk_rows_, row, {},
                                              [](const ChunkRows& c) { return c.rows.begin; });
  if (after == chunk_rows_.begin()) return none;
  const ChunkRows& found = *std::prev(after);
  return row < found.rows.end ? found.chunk : none;
}

Index BatchList::batch_count() const {
  Index batches = 0;
  for (const loops::Rows& range : ranges_)
    batches += (range.end + lanes - 1) / lanes - range.begin / lanes;
  return batches;
}

}  // namespace suture
