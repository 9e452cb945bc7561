// SPDX-License-Identifier: GPL-3.0-or-later
//
// Entities, nodes and elements of Gmsh's format 4.1: manual 4.11, section 10.1.
#include <cstdlib>
#include <limits>
#include <vector>

#include "kernel/mesh/gmsh_scanner.hpp"

namespace suture {
namespace {

// A signed list of tags behind its length.
std::vector<int> read_tags(GmshScanner& in, const char* what) {
  const std::uint64_t n = in.size(what);
  in.require_room(n, 1, 4, what);
  std::vector<int> tags(n);
  for (int& tag : tags) tag = in.int32(what);
  return tags;
}

struct EntityBlock {
  int dimension, tag;
  std::uint64_t count;
};

// EntityBlocks that hold more or less than their section announces are damaged.
void check_total(GmshScanner& in, std::uint64_t announced, std::uint64_t found, const char* what) {
  if (found != announced)
    in.fail(grouped(announced) + " " + what + " are declared, but the blocks contain " +
            grouped(found) + ": the file is damaged");
}

std::uint64_t read_node_block(GmshScanner& in, GmshMesh& mesh, std::vector<std::uint64_t>& tags) {
  const int dimension = in.int32("dimension of a block of nodes");
  in.int32("entity of a block of nodes");
  const int parametric = in.int32("'parametric' of a block of nodes");
  if (dimension < 0 || dimension > 3) in.fail("nodes of dimension " + std::to_string(dimension));
  const int parameters = parametric ? dimension : 0;
  const std::uint64_t count = in.size("number of nodes in a block");
  in.require_room(count, 4, 8 + 24, "nodes of a block");
  tags.resize(count);
  for (std::uint64_t& tag : tags) tag = in.size("tag of a node");
  for (const std::uint64_t tag : tags) {
    Vec3 x;
    for (double& c : x) c = in.real("coordinate");
    for (int i = 0; i < parameters; ++i) in.real("parametric coordinate");
    mesh.add_point(tag, x);
  }
  return count;
}

void read_hexahedra(GmshScanner& in, GmshMesh& mesh, const EntityBlock& block,
                    std::span<const int> groups) {
  for (std::uint64_t i = 0; i < block.count; ++i) {
    const std::uint64_t tag = in.size("tag of an element");
    Hexahedron nodes;
    for (Index& node : nodes) node = mesh.point(in.size("node of an element"));
    mesh.add_hexahedron(tag, nodes, groups);
  }
}

void read_solids(GmshScanner& in, GmshMesh& mesh, const EntityBlock& block, const GmshType& type,
                 std::span<const int> groups) {
  std::vector<std::uint64_t> nodes(type.nodes);
  for (std::uint64_t i = 0; i < block.count; ++i) {
    const std::uint64_t tag = in.size("tag of an element");
    for (std::uint64_t& node : nodes) node = in.size("node of an element");
    mesh.add_solid(tag, type, nodes, groups);
  }
}

void read_others(GmshScanner& in, GmshMesh& mesh, const EntityBlock& block, const GmshType& type,
                 std::span<const int> groups) {
  mesh.count_skipped(type, block.count);
  const bool keep = !groups.empty() && type.dimension < 3;
  for (std::uint64_t i = 0; i < block.count; ++i) {
    in.size("tag of an element");
    for (unsigned n = 0; n < type.nodes; ++n) {
      const std::uint64_t node = in.size("node of an element");
      if (keep) mesh.add_group_point(type.dimension, mesh.point(node), groups);
    }
  }
}

std::uint64_t read_element_block(GmshScanner& in, const FileText& file,
                                 const GmshEntities& entities, GmshMesh& mesh) {
  EntityBlock block{};
  block.dimension = in.int32("dimension of a block of elements");
  block.tag = in.int32("entity of a block of elements");
  const int number = in.int32("type of a block of elements");
  block.count = in.size("number of elements in a block");
  const GmshType* type = find_gmsh_type(number);
  if (!type) in.fail("element type " + std::to_string(number) + " is unknown");
  if (type->nodes > 8 && std::string_view(type->name) == "hexahedra") {
    in.fail(too_many_nodes(type->nodes));
  }
  in.require_room(block.count, type->nodes + 1, 8 * (type->nodes + 1), "elements of a block");
  check_count(file, block.count, "elements");
  const auto found = entities.find({block.dimension, block.tag});
  const std::span<const int> groups =
      found == entities.end() ? std::span<const int>{} : std::span<const int>(found->second);
  if (number == gmsh_hexahedron) {
    read_hexahedra(in, mesh, block, groups);
  } else if (mesh.wants_solid(*type)) {
    read_solids(in, mesh, block, *type, groups);
  } else {
    read_others(in, mesh, block, *type, groups);
  }
  return block.count;
}

}  // namespace

void read_gmsh4_entities(GmshScanner& in, GmshEntities& entities) {
  std::uint64_t counts[4];
  for (std::uint64_t& n : counts) n = in.size("number of entities");
  for (int dimension = 0; dimension < 4; ++dimension) {
    for (std::uint64_t i = 0; i < counts[dimension]; ++i) {
      const int tag = in.int32("tag of an entity");
      const int corners = dimension == 0 ? 3 : 6;
      for (int c = 0; c < corners; ++c) in.real("bound of an entity");
      std::vector<int> groups = read_tags(in, "physical groups of an entity");
      // Gmsh writes -3 for group 3 with reversed orientation.
      for (int& group : groups) {
        if (group == std::numeric_limits<int>::min()) in.fail("a physical group is out of range");
        group = std::abs(group);
      }
      if (dimension > 0) read_tags(in, "bounding entities");
      entities[{dimension, tag}] = std::move(groups);
    }
  }
}

void read_gmsh4_nodes(GmshScanner& in, const FileText&, GmshMesh& mesh) {
  const std::uint64_t blocks = in.size("number of blocks");
  const std::uint64_t count = in.size("number of nodes");
  in.size("smallest tag");
  in.size("largest tag");
  in.require_room(count, 4, 8 + 24, "nodes");
  mesh.reserve_points(count);
  std::vector<std::uint64_t> tags;
  std::uint64_t found = 0;
  for (std::uint64_t b = 0; b < blocks; ++b) found += read_node_block(in, mesh, tags);
  check_total(in, count, found, "nodes");
  mesh.end_points();
}

void read_gmsh4_elements(GmshScanner& in, const FileText& file, const GmshEntities& entities,
                         GmshMesh& mesh) {
  const std::uint64_t blocks = in.size("number of blocks");
  const std::uint64_t count = in.size("number of elements");
  in.size("smallest tag");
  in.size("largest tag");
  std::uint64_t found = 0;
  for (std::uint64_t b = 0; b < blocks; ++b) found += read_element_block(in, file, entities, mesh);
  check_total(in, count, found, "elements");
}

}  // namespace suture
