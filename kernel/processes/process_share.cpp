// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/processes/process_share.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <sstream>
#include <utility>

#include "kernel/base/bulk.hpp"

namespace suture {

ProcessShare::ProcessShare(Communicator& processes, unsigned threads, const CellComplex& complex)
    : processes_(processes),
      machines_(processes.gather(std::to_string(threads) + ' ' + name_of_machine())),
      mesh_blocks_(complex.count(0) / aligned),
      own_(processes.size()),
      common_(processes.size()),
      counts_(processes.size()) {
  divide(complex);
}

// -------------------------------------------------------------------- shares --

unsigned ProcessShare::process_at(const CellComplex& complex, Index vertex) const {
  const auto after = std::upper_bound(element_begins_.begin() + 1, element_begins_.end() - 1,
                                      element_of(complex.dart_of(0, vertex)));
  return static_cast<unsigned>(after - element_begins_.begin()) - 1;
}

namespace {

std::uint64_t changes_of_elements(const CellComplex& complex) {
  return 2 * std::uint64_t{complex.count(3)} - complex.existing(3);
}

}  // namespace

void ProcessShare::divide(const CellComplex& complex) {
  divide_elements(complex);
  divide_blocks(complex);
  changed_elements_ = changes_of_elements(complex);
}

/// Where a block is complete that all have stepped, or a sixteenth of a share has changed.
void ProcessShare::follow(const CellComplex& complex) {
  const bool has_block = complex.count(0) / aligned > process_of_block_.size();
  const std::uint64_t changed = changes_of_elements(complex) - changed_elements_;
  if (has_block || 16 * processes_.size() * changed > complex.existing(3)) divide(complex);
}

/// Into ranges with as many that exist.
void ProcessShare::divide_elements(const CellComplex& complex) {
  const std::uint64_t all = complex.existing(3), size = processes_.size();
  element_begins_.clear();
  Index existing = 0;
  for (Index e = 0; e < complex.count(3); ++e) {
    while (element_begins_.size() < size && existing >= element_begins_.size() * all / size)
      element_begins_.push_back(e);
    if (complex.exists(3, e)) ++existing;
  }
  element_begins_.resize(size + 1, complex.count(3));
}

/// A block goes where most of its vertices have their first elements. Those of cuts may have them
/// in many places: then to the process with the fewest blocks of those with half as many vertices.
void ProcessShare::divide_blocks(const CellComplex& complex) {
  process_of_block_.clear();
  for (auto& ranges : own_) ranges.clear();
  std::vector<Index> blocks(processes_.size()), vertices;
  for (Index first = 0; first + aligned <= complex.count(0); first += aligned) {
    vertices.assign(processes_.size(), 0);
    for (Index v = first; v < first + aligned; ++v)
      if (complex.exists(0, v)) ++vertices[process_at(complex, v)];
    const Index most = *std::ranges::max_element(vertices);
    unsigned chosen = processes_.size();
    for (unsigned p = 0; p < processes_.size(); ++p)
      if (2 * vertices[p] >= most && (chosen == processes_.size() || blocks[p] < blocks[chosen]))
        chosen = p;
    ++blocks[chosen];
    process_of_block_.push_back(chosen);
    auto& ranges = own_[chosen];
    if (!ranges.empty() && ranges.back().end == first)
      ranges.back().end += aligned;
    else
      ranges.push_back({first, first + aligned});
  }
}

std::vector<bool> ProcessShare::others(const CellComplex& complex) {
  const unsigned rank = processes_.rank();
  const Index common = common_begin(), made = mesh_blocks_ * aligned;
  std::vector<bool> others(complex.count(0), true);
  for (const auto& [begin, end] : own_[rank])
    if (begin < made)
      std::fill(others.begin() + begin, others.begin() + std::min(end, made), false);
  for (auto& list : common_) list.clear();
  moved_.clear(processes_.size());
  for (Index v = made; v < others.size(); ++v) {
    if (!complex.exists(0, v)) continue;
    const unsigned sums = process_at(complex, v);
    others[v] = sums != rank;
    if (v >= common) {
      common_[sums].push_back(v);
      continue;
    }
    const unsigned steps = process_of_block_[v / aligned];
    if (steps == sums) continue;
    if (sums == rank) moved_.given[steps].push_back(v);
    if (steps == rank) moved_.taken[sums].push_back(v);
  }
  moved_.prepare();
  return others;
}

/// The vertices among these that others step alone.
void ProcessShare::find(Exchange& exchange, const std::vector<bool>& vertices) {
  exchange.clear(processes_.size());
  for (unsigned p = 0; p < processes_.size(); ++p) {
    if (p == processes_.rank()) continue;
    for (const auto& [begin, end] : own_[p])
      for (Index v = begin; v < end; ++v)
        if (vertices[v]) exchange.taken[p].push_back(v);
  }
  exchange.given = processes_.swap(exchange.taken);
  exchange.prepare();
}

void ProcessShare::read(const std::vector<bool>& vertices) {
  find(at_borders_, vertices);
  borders_.clear();
  std::vector<bool> is_known(vertices.size());
  for (const auto& taken : at_borders_.taken)
    for (const Index v : taken) {
      borders_.push_back(v);
      is_known[v] = true;
    }
  for (const auto& [begin, end] : own())
    std::fill(is_known.begin() + begin, is_known.begin() + end, true);
  std::fill(is_known.begin() + common_begin(), is_known.end(), true);
  known_.clear();
  const auto next = [&](auto from, bool known) { return std::find(from, is_known.end(), known); };
  for (auto first = next(is_known.begin(), true); first != is_known.end();) {
    const auto end = next(first, false);
    known_.emplace_back(static_cast<Index>(first - is_known.begin()),
                        static_cast<Index>(end - is_known.begin()));
    first = next(end, true);
  }
}

void ProcessShare::release(VertexRows rows) const {
  Index first = 0;
  const auto release_until = [&](Index end) {
    if (first < end) clear_pages(rows.data + first * rows.bytes, (end - first) * rows.bytes);
  };
  for (const auto& [begin, end] : known_) {
    release_until(begin);
    first = end;
  }
  release_until(common_begin());
}

std::vector<Index> ProcessShare::join_at(const std::vector<bool>& vertices,
                                         std::span<double* const> columns) {
  Exchange once;
  find(once, vertices);
  join(once, columns);
  std::vector<Index> taken;
  for (const auto& list : once.taken) taken.insert(taken.end(), list.begin(), list.end());
  return taken;
}

void ProcessShare::read_at_cells(const std::vector<bool>& vertices) { find(at_cells_, vertices); }

loops::Rows ProcessShare::elements() const {
  const unsigned rank = processes_.rank();
  const bool is_last = rank + 1 == processes_.size();  // it has those made since, too
  return {element_begins_[rank], is_last ? none : element_begins_[rank + 1]};
}

/// The number of vertices that a process steps alone.
Index ProcessShare::steps(unsigned process) const {
  Index number = 0;
  for (const auto& [begin, end] : own_[process]) number += end - begin;
  return number;
}

std::vector<BodyShare::Part> ProcessShare::parts() const {
  std::vector<Part> parts;
  for (unsigned p = 0; p < processes_.size(); ++p) {
    Part& part = parts.emplace_back();
    std::istringstream(machines_[p]) >> part.threads >> part.machine;
    part.elements = {element_begins_[p], element_begins_[p + 1]};
    part.vertices = steps(p);
  }
  return parts;
}

// ---------------------------------------------------------------- exchanges --

void ProcessShare::Exchange::clear(unsigned processes) {
  taken.assign(processes, {});
  given.assign(processes, {});
}

void ProcessShare::Exchange::prepare() {
  in.clear();
  out.clear();
  for (unsigned p = 0; p < taken.size(); ++p) {
    if (!taken[p].empty()) in.push_back({p, {}});
    if (!given[p].empty()) out.push_back({p, {}});
  }
}

/// `numbers` at each vertex: give(v, to) writes those that another process gets, and take(v, from)
/// reads those that it has sent.
template <class Give, class Take>
void ProcessShare::join(Exchange& exchange, std::size_t numbers, Give give, Take take) {
  for (auto& [process, sent] : exchange.out) {
    const std::vector<Index>& vertices = exchange.given[process];
    sent.resize(numbers * vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) give(vertices[i], sent.data() + i * numbers);
  }
  for (auto& [process, received] : exchange.in)
    received.resize(numbers * exchange.taken[process].size());
  processes_.swap(exchange.out, exchange.in);
  for (const auto& [process, received] : exchange.in) {
    const std::vector<Index>& vertices = exchange.taken[process];
    for (std::size_t i = 0; i < vertices.size(); ++i)
      take(vertices[i], received.data() + i * numbers);
  }
}

/// Gathers mine_ of all. Whether any process has met a fault.
bool ProcessShare::exchange(bool fault) {
  mine_.push_back(fault ? 1 : 0);
  all_.resize(std::reduce(counts_.begin(), counts_.end(), std::size_t{0}));
  processes_.gather(mine_, counts_, all_.data());
  mine_.clear();
  bool any = false;
  std::size_t end = 0;
  for (const int count : counts_) any |= all_[(end += static_cast<std::size_t>(count)) - 1] != 0;
  return any;
}

/// Failures are rare: their texts follow only where there is one.
void ProcessShare::exchange(Failure& failure) {
  if (!exchange(failure.any())) return;
  for (const std::string& text : processes_.gather(failure.packed()))
    failure.merge(Failure::unpacked(text));
}

/// Whether the own vertices of all processes, one process after the other, are all.
bool ProcessShare::is_in_order() const {
  Index next = 0;
  for (const auto& ranges : own_)
    for (const auto& [begin, end] : ranges)
      if (begin != std::exchange(next, end)) return false;
  return true;
}

namespace {

/// Own vertices are whole blocks, so that their rows are whole numbers of 8 bytes.
std::size_t numbers_in(const VertexRows& rows, std::size_t vertices) {
  return vertices * rows.bytes / sizeof(double);
}

double* numbers_of(const VertexRows& rows) { return reinterpret_cast<double*>(rows.data); }

}  // namespace

/// Sets counts_.
std::vector<double> ProcessShare::own_rows(VertexRows rows) {
  for (unsigned p = 0; p < processes_.size(); ++p)
    counts_[p] = static_cast<int>(numbers_in(rows, steps(p)));
  std::vector<double> mine;
  if (is_in_order()) return mine;
  for (const auto& [begin, end] : own())
    mine.insert(mine.end(), numbers_of(rows) + numbers_in(rows, begin),
                numbers_of(rows) + numbers_in(rows, end));
  return mine;
}

/// Those of all processes, one process after the other.
void ProcessShare::take(const double* packed, VertexRows rows) const {
  for (const auto& ranges : own_)
    for (const auto& [begin, end] : ranges) {
      const std::size_t size = numbers_in(rows, end - begin);
      std::copy_n(packed, size, numbers_of(rows) + numbers_in(rows, begin));
      packed += size;
    }
}

void ProcessShare::complete(VertexRows rows) {
  const std::vector<double> mine = own_rows(rows);
  if (is_in_order()) return processes_.complete(numbers_of(rows), counts_);
  std::vector<double> packed(numbers_in(rows, common_begin()));
  processes_.gather(mine, counts_, packed.data());
  take(packed.data(), rows);
}

void ProcessShare::gather(VertexRows rows) {
  const std::vector<double> mine = own_rows(rows);
  if (is_in_order()) {
    const std::size_t begin = own().empty() ? 0 : numbers_in(rows, own().front().begin);
    const auto count = static_cast<std::size_t>(counts_[processes_.rank()]);
    return processes_.collect({numbers_of(rows) + begin, count}, counts_, numbers_of(rows));
  }
  std::vector<double> packed(processes_.rank() == 0 ? numbers_in(rows, common_begin()) : 0);
  processes_.collect(mine, counts_, packed.data());
  if (processes_.rank() == 0) take(packed.data(), rows);
}

void ProcessShare::join_forces(VertexRows rows, Failure& failure) {
  join_rows(moved_, rows);
  join_common(rows, failure);
}

void ProcessShare::join_rows(Exchange& exchange, VertexRows rows) {
  const auto at = [&](Index v) { return rows.data + v * rows.bytes; };
  join(
      exchange, rows.bytes / sizeof(double),
      [&](Index v, double* to) { std::memcpy(to, at(v), rows.bytes); },
      [&](Index v, const double* from) { std::memcpy(at(v), from, rows.bytes); });
}

void ProcessShare::join_common(VertexRows rows, Failure& failure) {
  const std::size_t width = rows.bytes / sizeof(double);
  const auto& own = common_[processes_.rank()];
  mine_.resize(width * own.size());
  for (std::size_t i = 0; i < own.size(); ++i)
    std::memcpy(mine_.data() + i * width, rows.data + own[i] * rows.bytes, rows.bytes);
  for (unsigned p = 0; p < processes_.size(); ++p)
    counts_[p] = static_cast<int>(width * common_[p].size() + 1);
  exchange(failure);
  const double* next = all_.data();
  for (const auto& list : common_) {
    for (const Index v : list) {
      std::memcpy(rows.data + v * rows.bytes, next, rows.bytes);
      next += width;
    }
    ++next;  // whether it has failed
  }
}

void ProcessShare::join(Exchange& exchange, std::span<double* const> columns) {
  join(
      exchange, 3 * columns.size(),
      [&](Index v, double* to) {
        for (const double* column : columns) to = std::copy_n(column + std::size_t{v} * 4, 3, to);
      },
      [&](Index v, const double* from) {
        for (double* column : columns) {
          std::copy_n(from, 3, column + std::size_t{v} * 4);
          from += 3;
        }
      });
}

bool ProcessShare::join_blocks(std::span<double> rows, std::size_t width, bool good) {
  const auto of = [&](const loops::Rows& range) {
    return rows.subspan(range.begin / block * width, (range.end - range.begin) / block * width);
  };
  mine_.clear();
  for (const loops::Rows& range : own())
    mine_.insert(mine_.end(), of(range).begin(), of(range).end());
  for (unsigned p = 0; p < processes_.size(); ++p)
    counts_[p] = static_cast<int>(steps(p) / block * width + 1);
  const bool any_is_bad = exchange(!good);
  const double* next = all_.data();
  for (const auto& ranges : own_) {
    for (const loops::Rows& range : ranges) {
      std::copy_n(next, of(range).size(), of(range).begin());
      next += of(range).size();
    }
    ++next;  // whether it is good
  }
  return !any_is_bad;
}

void ProcessShare::join_sums(std::span<double> sums, std::span<const unsigned> processes,
                             Failure& failure) {
  std::ranges::fill(counts_, 1);  // whether it has failed
  for (std::size_t i = 0; i < sums.size(); ++i) {
    ++counts_[processes[i]];
    if (processes[i] == processes_.rank()) mine_.push_back(sums[i]);
  }
  exchange(failure);
  std::vector<const double*> next{all_.data()};
  for (const int count : counts_) next.push_back(next.back() + count);
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = *next[processes[i]]++;
}

std::vector<Index> ProcessShare::join_lists(const std::vector<Index>& mine) {
  std::vector<Index> all;
  for (const auto& list : processes_.swap(std::vector(processes_.size(), mine)))
    all.insert(all.end(), list.begin(), list.end());
  return all;
}

/// One process after the other, so that process 0 needs memory for one of them.
void ProcessShare::collect(const Bytes& mine, const std::function<void(const Bytes&)>& take) {
  const std::vector<std::string> sizes = processes_.gather(std::to_string(mine.size()));
  if (processes_.rank() == 0) take(mine);
  for (unsigned process = 1; process < processes_.size(); ++process) {
    if (processes_.rank() != process && processes_.rank() != 0) continue;
    const std::size_t size = std::stoull(sizes[process]);
    std::vector<double> numbers((size + sizeof(double) - 1) / sizeof(double));
    if (processes_.rank() == process) {
      std::memcpy(numbers.data(), mine.data(), size);
      const Communicator::Parcel sent{0, std::move(numbers)};
      processes_.swap({&sent, 1}, {});
    } else {
      Communicator::Parcel received{process, std::move(numbers)};
      processes_.swap({}, {&received, 1});
      Bytes bytes(size);
      std::memcpy(bytes.data(), received.numbers.data(), size);
      take(bytes);
    }
  }
}

}  // namespace suture
