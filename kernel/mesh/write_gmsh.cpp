// SPDX-License-Identifier: GPL-3.0-or-later
//
// Gmsh 4.1 in text: manual 4.11, section 10.1.
//
// A cell belongs to one entity of the geometry, an entity to any number of physical
// groups: so there is a volume for each combination of element sets that occurs,
// and a geometric point with "point" elements for each combination of point sets.
#include <algorithm>
#include <limits>

#include "kernel/base/escape.hpp"
#include "kernel/mesh/vtk_order.hpp"
#include "kernel/mesh/writers.hpp"

namespace suture {
namespace {

using Groups = std::vector<int>;

using Entities = std::map<Groups, std::vector<Index>>;

// The members of each combination of sets, which are numbered from 1.
Entities entities_of(const std::map<std::string, std::vector<Index>>& sets, std::size_t count) {
  std::vector<Groups> groups(count);
  int number = 0;
  for (const auto& [name, members] : sets) {
    ++number;
    for (const Index i : members) groups[i].push_back(number);
  }
  Entities entities;
  for (Index i = 0; i < count; ++i) entities[groups[i]].push_back(i);
  return entities;
}

void write_groups(TextWriter& out, const Groups& groups) {
  out << ' ' << groups.size();
  for (const int group : groups) out << ' ' << group;
}

/// Fits between quotes on one line.
std::string printable_name(std::string name) {
  std::replace(name.begin(), name.end(), '"', '\'');
  std::replace(name.begin(), name.end(), '\n', ' ');
  return name;
}

void physical_names(TextWriter& out, const Mesh& mesh) {
  if (mesh.point_sets.empty() && mesh.element_sets.empty()) return;
  out << "$PhysicalNames\n" << mesh.point_sets.size() + mesh.element_sets.size() << '\n';
  const auto write = [&](int dimension, const auto& sets) {
    int number = 0;
    for (const auto& [name, members] : sets) {
      out << dimension << ' ' << ++number << " \"" << printable_name(name) << "\"\n";
    }
  };
  write(0, mesh.point_sets);
  write(3, mesh.element_sets);
  out << "$EndPhysicalNames\n";
}

void write_entities(TextWriter& out, const Mesh& mesh, const Entities& points,
                    const Entities& volumes) {
  Vec3 low, high;
  low.fill(std::numeric_limits<double>::max());
  high.fill(std::numeric_limits<double>::lowest());
  for (const Vec3& x : mesh.points) {
    for (int c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], x[c]);
      high[c] = std::max(high[c], x[c]);
    }
  }
  out << "$Entities\n" << points.size() << " 0 0 " << volumes.size() << '\n';
  int tag = 0;
  for (const auto& [groups, members] : points) {
    const Vec3& x = mesh.points[members.front()];
    out << ++tag << ' ' << x[0] << ' ' << x[1] << ' ' << x[2];
    write_groups(out, groups);
    out << '\n';
  }
  tag = 0;
  for (const auto& [groups, members] : volumes) {
    out << ++tag;
    for (const Vec3& corner : {low, high}) {
      for (const double x : corner) out << ' ' << x;
    }
    write_groups(out, groups);
    out << " 0\n";
  }
  out << "$EndEntities\n";
}

void nodes(TextWriter& out, const Mesh& mesh, const std::vector<std::uint64_t>& tags) {
  const auto [least, most] = std::minmax_element(tags.begin(), tags.end());
  out << "$Nodes\n1 " << tags.size() << ' ' << *least << ' ' << *most << "\n3 1 0 " << tags.size()
      << '\n';
  for (const std::uint64_t tag : tags) out << tag << '\n';
  for (const Vec3& x : mesh.points) out << x[0] << ' ' << x[1] << ' ' << x[2] << '\n';
  out << "$EndNodes\n";
}

void elements(TextWriter& out, const Mesh& mesh, const Entities& points, const Entities& volumes,
              const std::vector<std::uint64_t>& node_tags) {
  const std::vector<std::uint64_t> tags = tags_of(mesh.element_ids, mesh.hexahedra.size());
  const auto [least, most] = std::minmax_element(tags.begin(), tags.end());
  std::size_t point_cells = 0;
  for (const auto& [groups, members] : points) point_cells += members.size();
  out << "$Elements\n"
      << points.size() + volumes.size() << ' ' << tags.size() + point_cells << ' ' << *least << ' '
      << *most + point_cells << '\n';
  std::uint64_t next = *most + 1;
  int entity = 0;
  for (const auto& [groups, members] : points) {
    out << "0 " << ++entity << " 15 " << members.size() << '\n';
    for (const Index point : members) out << next++ << ' ' << node_tags[point] << '\n';
  }
  entity = 0;
  for (const auto& [groups, members] : volumes) {
    out << "3 " << ++entity << " 5 " << members.size() << '\n';
    for (const Index e : members) {
      out << tags[e];
      for (const Index node : swap_vtk_order(mesh.hexahedra[e])) out << ' ' << node_tags[node];
      out << '\n';
    }
  }
  out << "$EndElements\n";
}

// Gmsh has scalars, vectors and tensors; arrays between them are filled with zeros.
constexpr std::size_t most_components = 9;

void data(TextWriter& out, const MeshArray& array, const std::vector<std::uint64_t>& tags) {
  const std::string section = array.of_elements ? "ElementData" : "NodeData";
  const std::size_t n = array.components;
  const std::size_t width = n == 1 ? 1 : (n <= 3 ? 3 : most_components);
  out << '$' << section << "\n1\n\"" << printable_name(array.name) << "\"\n1\n0\n3\n0\n"
      << width << '\n'
      << tags.size() << '\n';
  for (std::size_t i = 0; i < tags.size(); ++i) {
    out << tags[i];
    for (std::size_t c = 0; c < width; ++c) out << ' ' << (c < n ? array.values[n * i + c] : 0.0);
    out << '\n';
  }
  out << "$End" << section << '\n';
}

}  // namespace

std::string gmsh_text(const Mesh& mesh, Diagnostics& diagnostics) {
  const Entities volumes = entities_of(mesh.element_sets, mesh.hexahedra.size());
  Entities points = entities_of(mesh.point_sets, mesh.points.size());
  points.erase(Groups{});  // points of no set need no cell
  const std::vector<std::uint64_t> node_tags = tags_of(mesh.point_ids, mesh.points.size());
  TextWriter out;
  out << "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
  physical_names(out, mesh);
  write_entities(out, mesh, points, volumes);
  nodes(out, mesh, node_tags);
  elements(out, mesh, points, volumes, node_tags);
  const std::vector<std::uint64_t> element_tags = tags_of(mesh.element_ids, mesh.hexahedra.size());
  for (const MeshArray& array : mesh.arrays) {
    if (array.values.empty()) continue;
    if (array.components <= most_components)
      data(out, array, array.of_elements ? element_tags : node_tags);
    else
      diagnostics.warn("array " + quote(array.name) + " is lost: it has " +
                       std::to_string(array.components) + " components, and Gmsh stores at most " +
                       std::to_string(most_components) + "; write .vtu or .vtk to keep it");
  }
  return out.take();
}

}  // namespace suture
