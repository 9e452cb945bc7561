// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sections of Gmsh files, formats 2.x and 4.1. Why not libgmsh: docs/decisions.
#include "kernel/mesh/gmsh_scanner.hpp"

namespace suture {
namespace {

class GmshReader {
 public:
  GmshReader(const FileText& file, const MeshWants& wants, Diagnostics& diagnostics)
      : file_(file),
        wants_(wants),
        diagnostics_(diagnostics),
        in_(file),
        mesh_(in_, file, wants.all_solids) {}

  Mesh read() {
    while (in_.text.skip_space()) {
      const std::string name(in_.text.word("a section"));
      if (name.front() != '$') {
        fail("expected a section such as $Nodes, found " + in_quotes(name) +
             "; the previous section has more entries than its count");
      }
      section(name.substr(1));
    }
    if (!format_) fail("section $MeshFormat is missing");
    if (!has_nodes_) fail("section $Nodes is missing: the file is truncated");
    if (!has_elements_) fail("section $Elements is missing: the file is truncated");
    return mesh_.finish(format_ == 2, diagnostics_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { in_.fail(what); }

  void section(const std::string& name) {
    if (name == "NOD" || name == "ELM") {
      fail("Gmsh format 1 is not supported; save as 4.1 or 2.2 (gmsh -format msh41)");
    }
    if (name == "MeshFormat") {
      format();
    } else if (name == "PhysicalNames") {
      physical_names();
    } else if (name == "Entities" && format_ == 4) {
      start_data();
      read_gmsh4_entities(in_, entities_);
    } else if (name == "Nodes" || name == "ParametricNodes") {
      nodes(name == "ParametricNodes");
    } else if (name == "Elements") {
      elements();
    } else if (name == "NodeData" || name == "ElementData" || name == "ElementNodeData") {
      return data(name);
    } else {
      return skip(name);
    }
    in_.text.expect("$End" + name);
  }

  void format() {
    const double version = in_.text.real("version");
    const int type = in_.text.integer<int>("file type");
    const int size = in_.text.integer<int>("data size");
    if (version >= 2 && version < 3) format_ = 2;
    if (version == 4.1) format_ = 4;
    if (format_ == 0) {
      fail(
          "unsupported Gmsh format (supported: 2.0 to 2.2 and 4.1); save as 4.1 or 2.2 (gmsh "
          "-format msh41)");
    }
    if (type != 0 && type != 1) fail("file type " + std::to_string(type) + "; expected 0 or 1");
    if (size != 8) fail("data size " + std::to_string(size) + "; expected 8");
    if (type == 0) return;
    in_.end_of_line();
    in_.binary = true;
    if (in_.int32("test of the byte order") != 1) {
      fail("the byte order is that of another processor; save the file as ASCII");
    }
  }

  // Counts of format 2 are text even in a binary file; those of 4.1 are not.
  void start_data() {
    if (in_.binary) in_.end_of_line();
  }

  void physical_names() {
    const auto count = in_.text.integer<std::uint64_t>("number of physical names");
    in_.text.require_room(count, 3, "physical names");
    for (std::uint64_t i = 0; i < count; ++i) {
      const int dimension = in_.text.integer<int>("dimension of a physical group");
      const int number = in_.text.integer<int>("number of a physical group");
      std::string_view name = in_.text.skip_line();
      const std::size_t open = name.find('"'), close = name.rfind('"');
      if (open == name.npos || close == open) fail("the name of a physical group is not in quotes");
      if (dimension < 0 || dimension > 3) fail("the dimension of a physical group is not 0 to 3");
      mesh_.name_group(dimension, number, std::string(name.substr(open + 1, close - open - 1)));
    }
  }

  // Format 2 has a section of its own for nodes with parametric coordinates (Mesh.SaveParametric).
  void nodes(bool are_parametric) {
    if (!format_) fail("$Nodes appears before $MeshFormat");
    if (has_nodes_) fail("a second section $Nodes");
    has_nodes_ = true;
    if (format_ == 2) return read_gmsh2_nodes(in_, are_parametric, mesh_);
    start_data();
    read_gmsh4_nodes(in_, file_, mesh_);
  }

  void elements() {
    if (!has_nodes_) fail("$Elements appears before $Nodes");
    if (has_elements_) fail("a second section $Elements");
    has_elements_ = true;
    if (format_ == 2) return read_gmsh2_elements(in_, file_, mesh_);
    start_data();
    read_gmsh4_elements(in_, file_, entities_, mesh_);
  }

  void data(const std::string& name) {
    GmshData data = read_gmsh_data_header(in_, name != "NodeData");
    if (name == "ElementNodeData")
      data.array.unreadable =
          "its values belong to the nodes of each element; save a value per element";
    if (data.array.unreadable.empty() && wants_.wants_array(data.array.name)) {
      read_gmsh_data(in_, data);
      in_.text.expect("$End" + name);
    } else {
      skip(name);
    }
    mesh_.add_data(std::move(data));
  }

  void skip(const std::string& name) {
    if (name.starts_with("Partitioned")) {
      diagnostics_.warn(
          file_.name() +
          ": the mesh is partitioned; the physical groups of its partitions are not read");
    }
    const std::string_view rest(in_.text.position(), in_.text.bytes_left());
    const std::size_t found = rest.find("$End" + name);
    if (found == rest.npos) fail("section $" + name + " has no $End" + name);
    in_.text.seek(in_.text.position() + found);
    in_.text.word("the end of a section");
  }

  const FileText& file_;
  const MeshWants& wants_;
  Diagnostics& diagnostics_;
  GmshScanner in_;
  GmshMesh mesh_;
  GmshEntities entities_;
  int format_ = 0;
  bool has_nodes_ = false, has_elements_ = false;
};

}  // namespace

Mesh read_gmsh(const FileText& file, const MeshWants& wants, Diagnostics& diagnostics) {
  return GmshReader(file, wants, diagnostics).read();
}

}  // namespace suture
