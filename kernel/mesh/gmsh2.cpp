// SPDX-License-Identifier: GPL-3.0-or-later
//
// Nodes and elements of Gmsh's format 2 (2.0 to 2.2): manual 4.11, section 10.2.
#include <vector>

#include "kernel/mesh/gmsh_scanner.hpp"

namespace suture {
namespace {

struct Block {
  const GmshType* type;
  int count;
  int tags;
};

// The first tag of an element is its physical group, 0 for none.
void read_element(GmshScanner& in, GmshMesh& mesh, const Block& block, int number,
                  std::vector<std::uint64_t>& nodes) {
  int physical = 0;
  for (int t = 0; t < block.tags; ++t) {
    const int tag = in.int32("tag of an element");
    if (t == 0) physical = tag;
  }
  const std::span<const int> groups(&physical, physical != 0 ? 1 : 0);
  nodes.resize(block.type->nodes);
  for (std::uint64_t& node : nodes) {
    const int tag = in.int32("node of an element");
    if (tag < 0) in.fail("an element has node " + std::to_string(tag));
    node = static_cast<std::uint64_t>(tag);
  }
  if (block.type->number == gmsh_hexahedron) {
    Hexahedron hexahedron;
    for (int i = 0; i < 8; ++i) hexahedron[i] = mesh.point(nodes[i]);
    mesh.add_hexahedron(static_cast<std::uint64_t>(number), hexahedron, groups);
    return;
  }
  if (mesh.wants_solid(*block.type))
    return mesh.add_solid(static_cast<std::uint64_t>(number), *block.type, nodes, groups);
  mesh.count_skipped(*block.type, 1);
  if (groups.empty() || block.type->dimension == 3) return;
  for (const std::uint64_t node : nodes) {
    mesh.add_group_point(block.type->dimension, mesh.point(node), groups);
  }
}

// A text file gives type and tags with each element, a binary one for a block.
Block read_block_header(GmshScanner& in) {
  const int type = in.int32("type of an element");
  Block block{find_gmsh_type(type), in.binary ? in.int32("number of elements") : 1,
              in.int32("number of tags")};
  if (!block.type) in.fail("element type " + std::to_string(type) + " is unknown");
  if (block.type->dimension == 3 && std::string_view(block.type->name) == "hexahedra" &&
      type != gmsh_hexahedron) {
    in.fail(too_many_nodes(block.type->nodes));
  }
  if (block.tags < 0 || block.count < 1) in.fail("a count of elements or tags is negative");
  const std::uint64_t words = block.type->nodes + std::uint64_t(block.tags);
  in.require_room(std::uint64_t(block.count), words, 4 * (words + 1), "elements");
  return block;
}

}  // namespace

// A parametric node ends with the dimension and the tag of its entity, and with its coordinates on
// a curve or a surface.
void read_gmsh2_nodes(GmshScanner& in, bool are_parametric, GmshMesh& mesh) {
  const auto count = in.text.integer<std::uint64_t>("number of nodes");
  if (in.binary) in.end_of_line();
  in.require_room(count, 4, 4 + 24, "nodes");
  mesh.reserve_points(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    const int tag = in.int32("number of a node");
    if (tag < 0) in.fail("node number " + std::to_string(tag) + " is negative");
    Vec3 x;
    for (double& c : x) c = in.real("coordinate");
    mesh.add_point(static_cast<std::uint64_t>(tag), x);
    if (!are_parametric) continue;
    const int dimension = in.int32("dimension of the entity of a node");
    if (dimension < 0 || dimension > 3)
      in.fail("a node lies on an entity of dimension " + std::to_string(dimension));
    in.int32("entity of a node");
    const int parameters = dimension == 1 || dimension == 2 ? dimension : 0;
    for (int p = 0; p < parameters; ++p) in.real("parametric coordinate of a node");
  }
  mesh.end_points();
}

void read_gmsh2_elements(GmshScanner& in, const FileText& file, GmshMesh& mesh) {
  const auto count = in.text.integer<std::uint64_t>("number of elements");
  if (in.binary) in.end_of_line();
  in.require_room(count, 3, 8, "elements");
  check_count(file, count, "elements");
  std::vector<std::uint64_t> nodes;
  for (std::uint64_t done = 0; done < count;) {
    int number = in.binary ? 0 : in.int32("number of an element");
    const Block block = read_block_header(in);
    for (int i = 0; i < block.count; ++i) {
      if (in.binary) number = in.int32("number of an element");
      read_element(in, mesh, block, number, nodes);
    }
    done += std::uint64_t(block.count);
    if (done > count) in.fail("a block of elements exceeds the " + grouped(count) + " declared");
  }
}

}  // namespace suture
