// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <bit>
#include <cstring>
#include <map>
#include <span>
#include <unordered_map>

#include "kernel/mesh/readers.hpp"

// Code shared by the readers of the Gmsh formats 2 and 4.1.

namespace suture {

/// Reads the numbers of a Gmsh file as text or as binary data, so that one reader serves both.
class GmshScanner {
 public:
  explicit GmshScanner(const FileText& file) : file_(file), text(file) {}

  bool binary = false;

  /// A 32-bit integer; an unsigned 64-bit integer (`size_t` of format 4.1); a finite double.
  std::int32_t int32(const char* what) {
    return binary ? take<std::int32_t>(what) : text.integer<std::int32_t>(what);
  }
  std::uint64_t size(const char* what) {
    return binary ? take<std::uint64_t>(what) : text.integer<std::uint64_t>(what);
  }
  double real(const char* what) {
    if (!binary) return text.real(what);
    const double value = take<double>(what);
    if (value - value != 0) fail(std::string(what) + " is not finite");
    return value;
  }
  /// A double that need not be finite.
  double any_real(const char* what) { return binary ? take<double>(what) : text.any_real(what); }
  /// Fails unless `count` entries can follow, of `bytes` bytes each in a binary file or `values`
  /// words each in a text.
  void require_room(std::uint64_t count, std::uint64_t values, std::uint64_t bytes,
                    const char* what) const;
  void skip_bytes(std::uint64_t n, const char* what);
  /// The line feed between a text line and the bytes that follow it.
  void end_of_line();
  [[noreturn]] void fail(const std::string& what) const;

 private:
  template <class T>
  T take(const char* what) {
    if (text.bytes_left() < sizeof(T)) fail_end(what);
    T value;
    std::memcpy(&value, text.position(), sizeof(T));
    text.seek(text.position() + sizeof(T));
    return value;
  }
  [[noreturn]] void fail_end(const char* what) const;

  const FileText& file_;

 public:
  TextCursor text;
};

/// A Gmsh element type: its number, nodes, dimension and name in the plural.
struct GmshType {
  int number;
  unsigned nodes;
  int dimension;
  const char* name;
  unsigned corners = 0;  ///< of tetrahedra, prisms and pyramids, which are their first nodes
};
inline constexpr int gmsh_hexahedron = 5;
/// Null for an unknown type.
const GmshType* find_gmsh_type(int number);

/// A section $NodeData or $ElementData; the array has a value for each of the tags.
struct GmshData {
  MeshArray array;
  std::uint64_t count = 0;  ///< of its entries
  std::vector<std::uint64_t> tags;
};

/// Collects the data of both formats into a Mesh.
class GmshMesh {
 public:
  GmshMesh(GmshScanner& in, const FileText& file, bool all_solids)
      : in_(in), file_(file), all_solids_(all_solids) {}

  void name_group(int dimension, int number, std::string name);
  void reserve_points(std::uint64_t count);
  void add_point(std::uint64_t tag, const Vec3& x);
  /// Called once between the last point and the first element.
  void end_points();
  /// The index of the point with this tag; fails if there is none.
  Index point(std::uint64_t tag) const {
    const Index found = tag < dense_.size() ? dense_[tag] : sparse_point(tag);
    if (found == none) fail_tag(tag);
    return found;
  }
  void add_hexahedron(std::uint64_t tag, const Hexahedron& vtk_order, std::span<const int> groups);
  /// Whether cells of a type are read as hexahedra of which nodes coincide.
  bool wants_solid(const GmshType& type) const { return all_solids_ && type.corners != 0; }
  /// Adds one of them, by the tags of its nodes.
  void add_solid(std::uint64_t tag, const GmshType& type, std::span<const std::uint64_t> nodes,
                 std::span<const int> groups);
  /// Adds a node of a lower-dimensional cell that belongs to groups.
  void add_group_point(int dimension, Index point, std::span<const int> groups);
  void add_data(GmshData data);
  void count_skipped(const GmshType& type, std::uint64_t count);
  /// Names the groups, and warns of names that no group of the file has; `repeats`: the file
  /// repeats a hexahedron for each of its groups.
  Mesh finish(bool repeats, Diagnostics& diagnostics);

 private:
  using Group = std::pair<int, int>;  // dimension, number
  void add_cell(std::uint64_t tag, const Hexahedron& nodes, std::span<const int> groups);
  Index sparse_point(std::uint64_t tag) const;
  [[noreturn]] void fail_tag(std::uint64_t tag) const;
  std::string name_of(const Group& group) const;
  void join_repeated_hexahedra();
  void place_data(GmshData& data);

  GmshScanner& in_;
  const FileText& file_;
  const bool all_solids_;
  bool has_curved_ = false;
  Mesh mesh_;
  std::vector<GmshData> data_;
  std::map<Group, std::string> names_;
  std::map<Group, std::vector<Index>> members_;
  std::vector<Index> dense_;  // tag -> point, where tags are near 1, 2, ...
  std::unordered_map<std::uint64_t, Index> sparse_;
};

/// The readers of formats 2 and 4.1 call these for the sections of a file.
void read_gmsh2_nodes(GmshScanner& in, bool are_parametric, GmshMesh& mesh);
void read_gmsh2_elements(GmshScanner& in, const FileText& file, GmshMesh& mesh);

/// The same for a section $NodeData or $ElementData: its header, then its values.
GmshData read_gmsh_data_header(GmshScanner& in, bool of_elements);
void read_gmsh_data(GmshScanner& in, GmshData& data);

/// Physical groups of the entities of a geometry: (dimension, tag) -> groups.
using GmshEntities = std::map<std::pair<int, int>, std::vector<int>>;
void read_gmsh4_entities(GmshScanner& in, GmshEntities& entities);
void read_gmsh4_nodes(GmshScanner& in, const FileText& file, GmshMesh& mesh);
void read_gmsh4_elements(GmshScanner& in, const FileText& file, const GmshEntities& entities,
                         GmshMesh& mesh);

}  // namespace suture
