// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/cell_complex.hpp"

#include <algorithm>
#include <unordered_set>

#include "kernel/base/archive.hpp"
#include "kernel/base/error.hpp"
#include "kernel/topology/incidence.hpp"

namespace suture {

using namespace incidence;

namespace {

void check_size(std::size_t elements) {
  if (elements > max_elements)
    throw TopologyError("the mesh has " + std::to_string(elements) +
                        " elements; the map can address at most " + std::to_string(max_elements));
}

/// Cuts append cells; room for them in advance keeps a small cut of a large map from
/// copying tables. Pages that nobody touches take no memory.
std::size_t room_for(std::size_t cells) { return cells + cells / 2 + 64; }
void prepare_room(std::vector<Dart>& cells) {
  prefer_large_pages(cells.data() + cells.size(), (cells.capacity() - cells.size()) * sizeof(Dart));
}

/// The faces at each corner, one bit each.
constexpr auto corner_faces = [] {
  std::array<std::uint8_t, 8> result{};
  for (int d = 0; d < 24; ++d) result[hexahedron::dart_vertex[d]] |= 1 << d / 4;
  return result;
}();

}  // namespace

// ---------------------------------------------------------------- building --

CellComplex::CellComplex(std::vector<Hexahedron> hexahedra, Index vertex_count,
                         std::vector<Split>* splits, const Naming& naming) {
  check_size(hexahedra.size());
  std::vector<MapFault> faults;
  links_ = match_faces(hexahedra, vertex_count, faults);
  if (!faults.empty()) throw TopologyError(describe(faults, naming));
  vertices_ = std::move(hexahedra);
  element_marks_.assign(vertices_.size() / 64 + 1, 0);
  cell_marks_[0].assign(vertex_count / 64 + 1, 0);
  split_non_manifold_vertices(vertex_count, splits);
}

template <int Dimension>
void CellComplex::collect_star(Dart start, std::vector<Dart>& out) const {
  constexpr std::size_t searched = 64;  // below, linear search is fastest
  std::unordered_set<LocalCell> seen;
  std::vector<LocalCell>& places = out;
  const auto is_new = [&](LocalCell place) {
    if (places.size() < searched) return std::ranges::find(places, place) == places.end();
    if (seen.empty()) seen.insert(places.begin(), places.end());
    return seen.insert(place).second;
  };
  places.assign(1, local_cell_of<Dimension>(start));
  for (std::size_t next = 0; next < places.size(); ++next) {
    const LocalCell here = places[next];
    for (const Exit exit : exits<Dimension>[here & 15]) {
      const Link link = links_[6 * (here >> 4) + exit.face];
      if (link == none) continue;
      const LocalCell there = link >> 5 << 4 | across<Dimension>[link & 31][exit.position];
      if (is_new(there)) places.push_back(there);
    }
  }
  std::ranges::sort(places);
  std::ranges::transform(places, out.begin(), dart_at<Dimension>);
}

/// A corner none of whose neighbours around the vertex belongs to an earlier element
/// is the first of its component, or at least a local one. A vertex with a single
/// such corner is whole; only the others are flooded.
void CellComplex::split_non_manifold_vertices(Index vertex_count, std::vector<Split>* splits) {
  first_dart_[0].reserve(room_for(vertex_count));
  first_dart_[0].assign(vertex_count, none);
  std::vector<Dart> further;
  for (Index e = 0; e < vertices_.size(); ++e) {
    unsigned earlier = 0;  // bit f: the neighbour across face f
    for (unsigned f = 0; f < 6; ++f) earlier |= unsigned{links_[6 * e + f] < link_of(e, 0)} << f;
    for (int i = 0; i < 8; ++i) {
      if (earlier & corner_faces[i]) continue;
      Dart& first = first_dart_[0][vertices_[e][i]];
      const Dart here = 24 * e + hexahedron::vertex_darts[i][0];
      if (first == none)
        first = here;
      else
        further.push_back(here);
    }
  }
  for (Index v = 0; v < vertex_count; ++v)
    if (first_dart_[0][v] == none)
      throw TopologyError("vertex " + std::to_string(v) + " belongs to no element");
  std::ranges::sort(further, {}, [&](Dart d) { return std::pair(origin(d), d); });
  std::vector<Dart> star;
  Index flooded = none;  // the vertex whose first component is in star
  for (const Dart d : further) {
    const Index vertex = origin(d);
    if (vertex >= vertex_count) continue;  // split off already
    if (vertex != flooded) collect_star<0>(first_dart_[0][vertex], star);
    flooded = vertex;
    if (std::ranges::binary_search(star, d)) continue;
    std::vector<Dart> component;
    collect_star<0>(d, component);
    const Index fresh = count(0);
    first_dart_[0].push_back(component[0]);
    for (const Dart c : component) vertices_[c / 24][hexahedron::dart_vertex[c % 24]] = fresh;
    if (splits) splits->push_back({vertex, fresh});
  }
  prepare_room(first_dart_[0]);
}

/// An edge's elements form a path or a cycle: walks it from its smallest dart one
/// way, and if that ends at the boundary, the other way.
void CellComplex::require_edges() {
  if (has_edges()) return;
  std::array<Index, 12> unknown;
  unknown.fill(none);
  edges_.assign(vertices_.size(), unknown);
  first_dart_[1].reserve(room_for(4 * vertices_.size()));  // as many as a sheet has
  for (Index e = 0; e < vertices_.size(); ++e)
    for (unsigned i = 0; i < 12 && exists(3, e); ++i) {
      if (edges_[e][i] != none) continue;
      const Index id = count(1);
      first_dart_[1].push_back(dart_at<1>(e << 4 | i));
      edges_[e][i] = id;
      for (const Exit way : exits<1>[i])
        if (number_edge(e, way, id)) break;
    }
  prepare_room(first_dart_[1]);
  cell_marks_[1].resize(first_dart_[1].size() / 64 + 1);
}

/// Numbers an edge in the elements behind an exit of e; true if that leads round to e.
bool CellComplex::number_edge(Index e, Exit way, Index id) {
  for (;;) {
    const Link link = links_[6 * e + way.face];
    if (link == none) return false;
    e = link >> 5;
    const int edge = across<1>[link & 31][way.position];
    if (edges_[e][edge] == id) return true;
    edges_[e][edge] = id;
    const auto [one, other] = exits<1>[edge];
    way = one.face == (link & 31) / 4 ? other : one;  // in through one face, out through the other
  }
}

void CellComplex::require_faces() {
  if (has_faces()) return;
  std::array<Index, 6> unknown;
  unknown.fill(none);
  faces_.assign(vertices_.size(), unknown);
  first_dart_[2].reserve(room_for(3 * vertices_.size()));
  for (Index e = 0; e < vertices_.size(); ++e)
    for (int f = 0; f < 6 && exists(3, e); ++f) {
      const Link link = links_[6 * e + f];
      if (link < link_of(e, 4 * f)) {
        faces_[e][f] = faces_[link >> 5][(link & 31) / 4];
      } else {
        faces_[e][f] = count(2);
        first_dart_[2].push_back(24 * e + 4 * f);
      }
    }
  prepare_room(first_dart_[2]);
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

std::size_t CellComplex::memory() const {
  const auto bytes = [](const auto& v) { return v.size() * sizeof(v[0]); };
  std::size_t sum = bytes(vertices_) + bytes(edges_) + bytes(faces_) + bytes(links_) +
                    bytes(element_marks_) + bytes(removed_marks_);
  for (const auto& marks : cell_marks_) sum += bytes(marks);
  for (const std::vector<Dart>& darts : first_dart_) sum += bytes(darts);
  return sum;
}

std::vector<Index> CellComplex::islands(Index* count) const {
  std::vector<Index> island(element_count(), none);
  std::vector<Index> queue;
  Index found = 0;
  for (Index seed = 0; seed < element_count(); ++seed) {
    if (island[seed] != none || !exists(3, seed)) continue;
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

// ------------------------------------------------------------------ state --

void CellComplex::state(Archive& archive) {
  if (!archive.has_cells()) return;
  Index elements = element_count(), vertices = count(0);
  // 2: elements were copied
  auto operated = static_cast<std::uint8_t>(copies_ != 0 ? 2 : has_operated_);
  bool edges = has_edges(), faces = has_faces();
  archive("elements", elements);
  archive("vertices", vertices);
  archive("operated", operated);
  archive("has_edges", edges);
  archive("has_faces", faces);
  const Index mesh_elements = element_count() - copies_;
  if (operated == 2) archive("copies", copies_);
  const bool fits = operated != 0 ? vertices >= count(0) : vertices == count(0);
  if (elements != mesh_elements + copies_ || !fits)
    archive.refuse("a map of " + std::to_string(elements) + " elements and " +
                   std::to_string(vertices) +
                   " vertices belongs to a different mesh: this one has " +
                   std::to_string(element_count()) + " and " + std::to_string(count(0)));
  if (operated != 0) return arrays(archive, elements);
  if (!archive.loads()) return;
  archive.require(!has_operated_, "operations have already been applied to this map");
  load_built(edges, faces);
}

/// Everything is derived from the mesh.
void CellComplex::load_built(bool edges, bool faces) {
  if (edges) require_edges();
  if (faces) require_faces();
  if (!edges) {
    edges_ = {};
    first_dart_[1] = {};
  }
  if (!faces) {
    faces_ = {};
    first_dart_[2] = {};
  }
}

/// But for the marks, which are zero now and grow when they are needed.
void CellComplex::arrays(Archive& archive, std::size_t elements) {
  archive("corners", vertices_);
  archive("edges", edges_);
  archive("faces", faces_);
  archive("links", links_);
  archive.each("darts", first_dart_,
               [](Archive& a, std::vector<Dart>& darts) { a("of_cells", darts); });
  archive("removed", removed_marks_);
  archive("holes", holes_);
  if (!archive.loads()) return;
  has_operated_ = true;
  const auto fits = [](std::size_t size, std::size_t full) { return size == 0 || size == full; };
  archive.require(vertices_.size() == elements && links_.size() == 6 * elements &&
                      fits(edges_.size(), elements) && fits(faces_.size(), elements) &&
                      fits(removed_marks_.size(), elements / 64 + 1),
                  "an array of the map has a different size");
  const auto are_cells = [&](const auto& rows, int dimension) {
    for (Index e = 0; e < rows.size(); ++e)
      for (const Index cell : rows[e])
        if (exists(3, e) && !(cell < count(dimension))) return false;
    return true;
  };
  const auto are_darts = [&](const auto& darts) {
    return std::ranges::all_of(darts, [&](Dart d) { return d == none || d < 24 * elements; });
  };
  archive.require(are_cells(vertices_, 0) && are_cells(edges_, 1) && are_cells(faces_, 2) &&
                      std::ranges::all_of(first_dart_, are_darts) &&
                      std::ranges::all_of(links_,
                                          [&](Link link) {
                                            return link == none ||
                                                   (link >> 5 < elements && (link & 31) < 24);
                                          }),
                  "the map names a cell that it does not have");
  element_marks_.resize(elements / 64 + 1);
  for (std::vector<Dart>& darts : first_dart_) {
    if (darts.empty()) continue;
    darts.reserve(room_for(darts.size()));
    prepare_room(darts);
  }
}

}  // namespace suture
