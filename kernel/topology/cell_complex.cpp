// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/cell_complex.hpp"

#include <algorithm>
#include <unordered_set>

#include "kernel/base/error.hpp"
#include "kernel/topology/incidence.hpp"

namespace suture {

namespace {

constexpr Index most_elements = none / 24;

void check_size(std::size_t elements) {
  if (elements >= most_elements)
    throw TopologyError("the mesh has " + std::to_string(elements) +
                        " elements; the map numbers its darts with 32 bits, which allows " +
                        std::to_string(most_elements - 1) + " hexahedra");
}

/// Cuts append cells; room for them in advance keeps a small cut of a large map from
/// copying tables. Pages that nobody touches take no memory.
std::size_t room_for(std::size_t cells) { return cells + cells / 4 + 64; }

}  // namespace

// ---------------------------------------------------------------- building --

CellComplex::CellComplex(std::vector<Hexahedron> hexahedra, Index vertex_count,
                         std::vector<Split>* pinched, const Naming& naming) {
  check_size(hexahedra.size());
  std::vector<MapFault> faults;
  mates_ = match_faces(hexahedra, vertex_count, faults);
  if (!faults.empty()) throw TopologyError(describe(faults, naming));
  vertices_ = std::move(hexahedra);
  marks_.assign((vertices_.size() + 63) / 64, 0);
  split_pinched_vertices(vertex_count, pinched);
}

/// Floods the elements around each vertex from its smallest one. A corner that is
/// left over belongs to another component, which becomes a vertex of its own.
void CellComplex::split_pinched_vertices(Index vertex_count, std::vector<Split>* pinched) {
  using namespace incidence;
  std::vector<Dart>& some_dart = some_dart_[0];
  some_dart.reserve(room_for(vertex_count));
  some_dart.assign(vertex_count, none);
  std::vector<std::uint8_t> reached(vertices_.size(), 0);  // one bit per corner
  std::vector<Dart> queue;
  for (Index e = 0; e < vertices_.size(); ++e) {
    if (reached[e] == 0xFF) continue;
    for (int i = 0; i < 8; ++i) {
      if (reached[e] >> i & 1) continue;
      Index vertex = vertices_[e][i];
      const Dart start = 24 * e + hexahedron::vertex_darts[i][0];
      if (some_dart[vertex] != none) {
        const auto fresh = static_cast<Index>(some_dart.size());
        if (pinched) pinched->push_back({vertex, fresh});
        some_dart.push_back(none);
        vertex = fresh;
      }
      some_dart[vertex] = start;
      queue.assign(1, start);
      reached[e] |= static_cast<std::uint8_t>(1 << i);
      for (std::size_t next = 0; next < queue.size(); ++next) {
        const Dart base = queue[next] - queue[next] % 24;
        const int corner = hexahedron::dart_vertex[queue[next] % 24];
        vertices_[base / 24][corner] = vertex;
        for (const auto exit : hexahedron::vertex_darts[corner]) {
          const Dart mate = beta3(base + exit);
          if (mate == none) continue;
          const Dart there = landing<0>(mate);
          const auto bit = static_cast<std::uint8_t>(1 << hexahedron::dart_vertex[there % 24]);
          if (reached[there / 24] & bit) continue;
          reached[there / 24] |= bit;
          queue.push_back(there);
        }
      }
    }
  }
  for (Index v = 0; v < vertex_count; ++v)
    if (some_dart[v] == none)
      throw TopologyError("vertex " + std::to_string(v) + " belongs to no element");
}

/// An edge's elements form a path or a cycle: walks it from its smallest dart one
/// way, and if that ends at the boundary, the other way.
void CellComplex::require_edges() {
  if (has_edges()) return;
  std::array<Index, 12> unknown;
  unknown.fill(none);
  edges_.assign(vertices_.size(), unknown);
  std::vector<Dart>& some_dart = some_dart_[1];
  some_dart.reserve(room_for(3 * vertices_.size()));
  for (Index e = 0; e < vertices_.size(); ++e)
    for (int i = 0; i < 12; ++i) {
      if (edges_[e][i] != none) continue;
      const auto id = static_cast<Index>(some_dart.size());
      some_dart.push_back(24 * e + hexahedron::edge_darts[i][0]);
      edges_[e][i] = id;
      for (const auto way : hexahedron::edge_darts[i]) {
        Dart mate = beta3(24 * e + way);
        for (; mate != none && edge(mate) == none; mate = beta3(beta2(mate)))
          edges_[mate / 24][hexahedron::dart_edge[mate % 24]] = id;
        if (mate != none) break;  // back at the start: a cycle
      }
    }
}

void CellComplex::require_faces() {
  if (has_faces()) return;
  faces_.resize(vertices_.size());
  std::vector<Dart>& some_dart = some_dart_[2];
  some_dart.reserve(room_for(3 * vertices_.size()));
  for (Index e = 0; e < vertices_.size(); ++e)
    for (int f = 0; f < 6; ++f) {
      const Dart mate = mates_[6 * e + f];
      if (mate != none && mate / 4 < 6 * e + f) {
        faces_[e][f] = face(mate);
      } else {
        faces_[e][f] = static_cast<Index>(some_dart.size());
        some_dart.push_back(24 * e + 4 * f);
      }
    }
}

// -------------------------------------------------------------- questions --

std::array<std::array<Dart, 4>, 6> CellComplex::darts(Index e) {
  std::array<std::array<Dart, 4>, 6> result;
  for (Dart d = 0; d < 24; ++d) result[d / 4][d % 4] = 24 * e + d;
  return result;
}

Index CellComplex::cell(int dimension, Dart d) const {
  switch (dimension) {
    case 0:
      return origin(d);
    case 1:
      return edge(d);
    case 2:
      return face(d);
    default:
      return d / 24;
  }
}

template <int Dimension>
void CellComplex::collect_star(Dart start, std::vector<Dart>& out) const {
  using namespace incidence;
  constexpr std::size_t searched = 64;  // linear search is fastest below
  std::unordered_set<Dart> seen;
  const auto is_new = [&](Dart d) {
    if (out.size() < searched) return std::ranges::find(out, d) == out.end();
    if (seen.empty()) seen.insert(out.begin(), out.end());
    return seen.insert(d).second;
  };
  out.assign(1, canonical<Dimension>(start));
  for (std::size_t next = 0; next < out.size(); ++next) {
    const Dart local = out[next] % 24, base = out[next] - local;
    for (const auto exit : exits<Dimension>(local_cell<Dimension>(static_cast<int>(local)))) {
      const Dart mate = beta3(base + exit);
      if (mate == none) continue;
      const Dart there = canonical<Dimension>(landing<Dimension>(mate));
      if (is_new(there)) out.push_back(there);
    }
  }
  std::ranges::sort(out);
}

void CellComplex::star(int dimension, Index id, std::vector<Dart>& out) const {
  const Dart start = dart_of(dimension, id);
  switch (dimension) {
    case 0:
      return collect_star<0>(start, out);
    case 1:
      return collect_star<1>(start, out);
    case 2:
      return collect_star<2>(start, out);
    default:
      out.assign(1, start);
  }
}

std::vector<Index> CellComplex::islands(Index* count) const {
  std::vector<Index> island(element_count(), none);
  std::vector<Index> queue;
  Index found = 0;
  for (Index seed = 0; seed < element_count(); ++seed) {
    if (island[seed] != none) continue;
    queue.assign(1, seed);
    island[seed] = found;
    while (!queue.empty()) {
      const Index e = queue.back();
      queue.pop_back();
      for (int f = 0; f < 6; ++f) {
        const Index other = neighbour(e, f);
        if (other == none || island[other] != none) continue;
        island[other] = found;
        queue.push_back(other);
      }
    }
    ++found;
  }
  if (count) *count = found;
  return island;
}

}  // namespace suture
