// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/mesh/gmsh_scanner.hpp"

#include <algorithm>
#include <utility>

#include "kernel/base/sort_unique.hpp"
#include "kernel/mesh/solid_cells.hpp"
#include "kernel/mesh/vtk_order.hpp"

namespace suture {
namespace {

// Gmsh reference manual 4.11, "Node ordering" and GmshDefines.h.
constexpr GmshType gmsh_types[] = {
    {1, 2, 1, "lines"},
    {2, 3, 2, "triangles"},
    {3, 4, 2, "quadrilaterals"},
    {4, 4, 3, "tetrahedra", 4},
    {gmsh_hexahedron, 8, 3, "hexahedra"},
    {6, 6, 3, "prisms", 6},
    {7, 5, 3, "pyramids", 5},
    {8, 3, 1, "lines of 3 nodes"},
    {9, 6, 2, "triangles of 6 nodes"},
    {10, 9, 2, "quadrilaterals of 9 nodes"},
    {11, 10, 3, "tetrahedra of 10 nodes", 4},
    {12, 27, 3, "hexahedra"},
    {13, 18, 3, "prisms of 18 nodes", 6},
    {14, 14, 3, "pyramids of 14 nodes", 5},
    {15, 1, 0, "points as cells"},
    {16, 8, 2, "quadrilaterals of 8 nodes"},
    {17, 20, 3, "hexahedra"},
    {18, 15, 3, "prisms of 15 nodes", 6},
    {19, 13, 3, "pyramids of 13 nodes", 5},
    {20, 9, 2, "triangles of 9 nodes"},
    {21, 10, 2, "triangles of 10 nodes"},
    {22, 12, 2, "triangles of 12 nodes"},
    {23, 15, 2, "triangles of 15 nodes"},
    {26, 4, 1, "lines of 4 nodes"},
    {27, 5, 1, "lines of 5 nodes"},
    {28, 6, 1, "lines of 6 nodes"},
    {29, 20, 3, "tetrahedra of 20 nodes", 4},
    {30, 35, 3, "tetrahedra of 35 nodes", 4},
    {36, 16, 2, "quadrilaterals of 16 nodes"},
    {37, 25, 2, "quadrilaterals of 25 nodes"},
    {92, 64, 3, "hexahedra"},
    {93, 125, 3, "hexahedra"},
};

constexpr const char* dimension_name[] = {"point", "curve", "surface", "volume"};

struct HashNodes {
  std::size_t operator()(const Hexahedron& nodes) const {
    std::uint64_t hash = 0;
    for (const Index node : nodes) hash = (hash ^ node) * 0x9E3779B97F4A7C15u;
    return hash ^ hash >> 32;
  }
};

}  // namespace

void GmshScanner::require_room(std::uint64_t count, std::uint64_t values, std::uint64_t bytes,
                               const char* what) const {
  if (!binary) return text.require_room(count, values, what);
  if (count > text.bytes_left() / bytes) {
    fail(grouped(count) + " " + what + " are declared, but only " + grouped(text.bytes_left()) +
         " bytes remain: the file is truncated or the count is wrong");
  }
}

void GmshScanner::skip_bytes(std::uint64_t n, const char* what) {
  if (n > text.bytes_left()) fail_end(what);
  text.seek(text.position() + n);
}

void GmshScanner::end_of_line() {
  if (!text.skip_line().empty()) fail("expected the end of a line before binary data");
}

void GmshScanner::fail(const std::string& what) const {
  if (binary) file_.fail_at_byte(text.position(), what);
  file_.fail_at_line(text.position(), what);
}

void GmshScanner::fail_end(const char* what) const {
  fail(std::string("the file ends where ") + what + " is expected: it is truncated");
}

const GmshType* find_gmsh_type(int number) {
  const auto* found = std::find_if(std::begin(gmsh_types), std::end(gmsh_types),
                                   [&](const GmshType& type) { return type.number == number; });
  return found == std::end(gmsh_types) ? nullptr : found;
}

void GmshMesh::name_group(int dimension, int number, std::string name) {
  names_[{dimension, number}] = std::move(name);
}

void GmshMesh::reserve_points(std::uint64_t count) {
  check_count(file_, count, "nodes");
  mesh_.points.reserve(count);
  mesh_.point_ids.reserve(count);
}

void GmshMesh::add_point(std::uint64_t tag, const Vec3& x) {
  mesh_.points.push_back(x);
  mesh_.point_ids.push_back(tag);
}

void GmshMesh::end_points() {
  check_count(file_, mesh_.points.size(), "nodes");
  std::uint64_t last = 0;
  for (const std::uint64_t tag : mesh_.point_ids) last = std::max(last, tag);
  const bool dense = last <= 16 * mesh_.points.size() + 1024;
  if (dense) dense_.assign(last + 1, none);
  for (Index i = 0; i < mesh_.points.size(); ++i) {
    const std::uint64_t tag = mesh_.point_ids[i];
    const bool repeated =
        dense ? std::exchange(dense_[tag], i) != none : !sparse_.emplace(tag, i).second;
    if (repeated)
      in_.fail("node " + std::to_string(tag) + " is defined twice in the previous section");
  }
}

Index GmshMesh::sparse_point(std::uint64_t tag) const {
  const auto found = sparse_.find(tag);
  return found == sparse_.end() ? none : found->second;
}

void GmshMesh::fail_tag(std::uint64_t tag) const {
  in_.fail("an element has node " + std::to_string(tag) + ", which is not among the " +
           grouped(mesh_.points.size()) + " nodes of the file");
}

void GmshMesh::add_hexahedron(std::uint64_t tag, const Hexahedron& vtk_order,
                              std::span<const int> groups) {
  add_cell(tag, swap_vtk_order(vtk_order), groups);
}

void GmshMesh::add_solid(std::uint64_t tag, const GmshType& type,
                         std::span<const std::uint64_t> nodes, std::span<const int> groups) {
  std::array<Index, 6> corners;
  for (std::size_t i = 0; i < type.corners; ++i) corners[i] = point(nodes[i]);
  has_curved_ = has_curved_ || type.nodes > type.corners;
  add_cell(tag, collapsed(std::span<const Index>(corners.data(), type.corners)), groups);
}

void GmshMesh::add_cell(std::uint64_t tag, const Hexahedron& nodes, std::span<const int> groups) {
  const auto element = static_cast<Index>(mesh_.hexahedra.size());
  mesh_.hexahedra.push_back(nodes);
  mesh_.element_ids.push_back(tag);
  for (const int group : groups) members_[{3, group}].push_back(element);
}

void GmshMesh::add_group_point(int dimension, Index point, std::span<const int> groups) {
  for (const int group : groups) members_[{dimension, group}].push_back(point);
}

void GmshMesh::count_skipped(const GmshType& type, std::uint64_t count) {
  mesh_.skipped_cells[type.name] += count;
}

std::string GmshMesh::name_of(const Group& group) const {
  const auto found = names_.find(group);
  if (found != names_.end()) return found->second;
  return std::string("physical ") + dimension_name[group.first] + " " +
         std::to_string(group.second);
}

// Format 2 repeats an element for each of its physical groups (manual, 10.2);
// left as they are, the copies would be two elements in one place.
void GmshMesh::join_repeated_hexahedra() {
  std::unordered_map<Hexahedron, Index, HashNodes> first;
  first.reserve(mesh_.hexahedra.size());
  std::vector<Index> kept(mesh_.hexahedra.size());
  Index count = 0;
  for (Index e = 0; e < mesh_.hexahedra.size(); ++e) {
    const auto [found, is_new] = first.emplace(mesh_.hexahedra[e], count);
    kept[e] = found->second;
    if (!is_new) continue;
    mesh_.hexahedra[count] = mesh_.hexahedra[e];
    mesh_.element_ids[count++] = mesh_.element_ids[e];
  }
  mesh_.hexahedra.resize(count);
  mesh_.element_ids.resize(count);
  for (auto& [group, members] : members_) {
    if (group.first != 3) continue;
    for (Index& e : members) e = kept[e];
  }
}

void GmshMesh::add_data(GmshData data) {
  const auto earlier = std::find_if(data_.begin(), data_.end(), [&](const GmshData& other) {
    return other.array.name == data.array.name && other.array.of_elements == data.array.of_elements;
  });
  if (earlier == data_.end()) return data_.push_back(std::move(data));
  earlier->array.values.clear();
  earlier->array.unreadable = "the file has it several times, such as for several time steps";
}

/// Values in the order of the mesh. The file may leave out some, and give others of cells that are
/// not read.
void GmshMesh::place_data(GmshData& data) {
  const std::size_t n = data.array.components;
  const bool of_elements = data.array.of_elements;
  std::unordered_map<std::uint64_t, Index> element_of;
  for (Index e = 0; of_elements && e < mesh_.element_ids.size(); ++e)
    element_of.emplace(mesh_.element_ids[e], e);
  const auto place = [&](std::uint64_t tag) {
    if (!of_elements) return tag < dense_.size() ? dense_[tag] : sparse_point(tag);
    const auto found = element_of.find(tag);
    return found == element_of.end() ? none : found->second;
  };
  std::vector<double> values(n * (of_elements ? mesh_.hexahedra.size() : mesh_.points.size()),
                             std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < data.tags.size(); ++i)
    if (const Index to = place(data.tags[i]); to != none)
      std::copy_n(&data.array.values[n * i], n, &values[n * to]);
  data.array.values = std::move(values);
}

Mesh GmshMesh::finish(bool repeats, Diagnostics& diagnostics) {
  const auto volumes = std::count_if(members_.begin(), members_.end(),
                                     [](const auto& group) { return group.first.first == 3; });
  if (has_curved_) warn_of_curved_cells(file_, diagnostics);
  if (repeats && volumes > 1) join_repeated_hexahedra();
  for (auto& [group, members] : members_) {
    auto& set = (group.first == 3 ? mesh_.element_sets : mesh_.point_sets)[name_of(group)];
    set.insert(set.end(), members.begin(), members.end());
    sort_unique(set);
  }
  for (const auto& [group, name] : names_) {
    if (members_.contains(group)) continue;
    diagnostics.warn(file_.name() + ": the physical " + dimension_name[group.first] + " " +
                     in_quotes(name) + " contains no supported element; it is not kept as a set");
  }
  for (GmshData& data : data_) {
    if (!data.array.values.empty()) place_data(data);
    mesh_.arrays.push_back(std::move(data.array));
  }
  return std::move(mesh_);
}

}  // namespace suture
