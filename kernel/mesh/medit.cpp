// SPDX-License-Identifier: GPL-3.0-or-later
//
// Medit ASCII meshes. Format: P. Frey, "MEDIT: an interactive mesh visualization
// software", INRIA RT-0253 (2001), appendix; keywords of libMeshb added.
#include <algorithm>
#include <array>
#include <numeric>
#include <string_view>

#include "kernel/base/sort_unique.hpp"
#include "kernel/mesh/readers.hpp"
#include "kernel/mesh/vtk_order.hpp"

namespace suture {
namespace {

// Sections that are skipped: words per entry, and what to call the entries in a
// count (null: no cells).
struct Section {
  std::string_view keyword;
  unsigned words;
  const char* cells;
};
constexpr Section skipped_sections[] = {
    {"Edges", 3, "edges"},
    {"Triangles", 4, "triangles"},
    {"Tetrahedra", 5, "tetrahedra"},
    {"Pyramids", 6, "pyramids"},
    {"Prisms", 7, "prisms"},
    {"Wedges", 7, "prisms"},
    {"Pentahedra", 7, "prisms"},
    {"Corners", 1, nullptr},
    {"Ridges", 1, nullptr},
    {"RequiredVertices", 1, nullptr},
    {"RequiredEdges", 1, nullptr},
    {"RequiredTriangles", 1, nullptr},
    {"RequiredQuadrilaterals", 1, nullptr},
};

class MeditReader {
 public:
  MeditReader(const FileText& file, Diagnostics& diagnostics)
      : file_(file), diagnostics_(diagnostics), in_(file, TextCursor::Comments::hash) {}

  Mesh read() {
    header();
    bool ended = false;
    while (!ended && in_.skip_space()) ended = section(in_.word("a keyword"));
    if (!ended) {
      diagnostics_.warn(file_.name() + ": the closing 'End' is missing; the file may be truncated");
    }
    check_hexahedra();
    add_sets();
    number_from_one();
    return std::move(mesh_);
  }

 private:
  void header() {
    if (in_.peek_word() != "MeshVersionFormatted") {
      in_.fail("a Medit mesh begins with 'MeshVersionFormatted', found " +
               in_quotes(in_.peek_word()) + " (binary .meshb is not supported)");
    }
    in_.word("a keyword");
    const int version = in_.integer<int>("version");
    if (version < 1 || version > 4) {
      in_.fail("Medit version " + std::to_string(version) + "; supported versions are 1 to 4");
    }
  }

  // Reads what follows a keyword; true for End.
  bool section(std::string_view keyword) {
    if (keyword == "End") return true;
    if (keyword == "Dimension") {
      const int dimension = in_.integer<int>("dimension");
      if (dimension != 3) in_.fail("dimension " + std::to_string(dimension) + "; expected 3");
    } else if (keyword == "Vertices") {
      vertices();
    } else if (keyword == "Hexahedra" || keyword == "Hexaedra") {
      hexahedra();
    } else if (keyword == "Quadrilaterals" || keyword == "Quads") {
      quadrilaterals();
    } else if (keyword.starts_with("HexahedraQ")) {
      in_.fail(std::string(keyword) + ": " + too_many_nodes(27));
    } else {
      skip(keyword);
    }
    return false;
  }

  std::uint64_t count(const char* what, unsigned words) {
    const auto n = in_.integer<std::uint64_t>("a count");
    in_.require_room(n, words, what);
    check_count(file_, n, what);
    return n;
  }

  void vertices() {
    if (!mesh_.points.empty()) in_.fail("a second section 'Vertices'");
    const std::uint64_t n = count("vertices", 4);
    mesh_.points.resize(n);
    point_refs_.resize(n);
    for (std::uint64_t i = 0; i < n; ++i) {
      for (double& x : mesh_.points[i]) x = in_.real("coordinate");
      point_refs_[i] = in_.integer<std::int64_t>("reference of a vertex");
    }
  }

  // Indices are checked at the end: the sections may come in any order.
  void hexahedra() {
    if (!mesh_.hexahedra.empty()) in_.fail("a second section 'Hexahedra'");
    const std::uint64_t n = count("hexahedra", 9);
    hexahedra_begin_ = in_.position();
    mesh_.hexahedra.resize(n);
    element_refs_.resize(n);
    for (std::uint64_t e = 0; e < n; ++e) {
      Hexahedron nodes;
      for (Index& node : nodes) node = in_.integer<Index>("number of a vertex") - 1;
      mesh_.hexahedra[e] = swap_vtk_order(nodes);
      element_refs_[e] = in_.integer<std::int64_t>("reference of a hexahedron");
    }
  }

  void check_hexahedra() {
    for (std::size_t e = 0; e < mesh_.hexahedra.size(); ++e) {
      for (const Index node : mesh_.hexahedra[e]) {
        if (node >= mesh_.points.size()) fail_index(hexahedra_begin_, e, 9, "hexahedron", node);
      }
    }
  }

  // Finds the line of an entry again, so that the good case keeps no positions.
  [[noreturn]] void fail_index(const char* section_begin, std::size_t entry, unsigned words,
                               const char* what, Index node) {
    in_.seek(section_begin);
    for (std::size_t i = 0; i < words * entry; ++i) in_.word("a number");
    in_.skip_space();
    in_.fail(std::string(what) + " " + std::to_string(entry + 1) + " has vertex " +
             std::to_string(Index(node + 1)) + "; the vertices are numbered 1 to " +
             grouped(mesh_.points.size()));
  }

  // Surfaces carry the labels of boundaries: their points become sets.
  void quadrilaterals() {
    if (quads_begin_) in_.fail("a second section 'Quadrilaterals'");
    const std::uint64_t n = count("quadrilaterals", 5);
    quads_begin_ = in_.position();
    mesh_.skipped_cells["quadrilaterals"] += n;
    quads_.resize(n);
    quad_refs_.resize(n);
    for (std::uint64_t i = 0; i < n; ++i) {
      for (Index& node : quads_[i]) node = in_.integer<Index>("number of a vertex") - 1;
      quad_refs_[i] = in_.integer<std::int64_t>("reference of a quadrilateral");
    }
  }

  void skip(std::string_view keyword) {
    for (const Section& known : skipped_sections) {
      if (known.keyword != keyword) continue;
      const std::uint64_t n = count(known.cells ? known.cells : "entries", known.words);
      for (std::uint64_t i = 0; i < n * known.words; ++i) in_.word("a number");
      if (known.cells) mesh_.skipped_cells[known.cells] += n;
      return;
    }
    const char first = keyword.front();
    if (!((first >= 'A' && first <= 'Z') || (first >= 'a' && first <= 'z'))) {
      in_.seek(keyword.data());
      in_.fail("expected a keyword, found " + in_quotes(keyword) +
               "; the previous section has more entries than its count");
    }
    unknown_section(keyword);
  }

  // Numbers follow until the next keyword.
  void unknown_section(std::string_view keyword) {
    in_.integer<std::uint64_t>(("count of unknown section " + in_quotes(keyword)).c_str());
    const auto is_number = [](std::string_view w) {
      return !w.empty() &&
             (w[0] == '-' || w[0] == '+' || w[0] == '.' || (w[0] >= '0' && w[0] <= '9'));
    };
    while (is_number(in_.peek_word())) in_.word("a number");
    diagnostics_.warn(file_.name() + ": skipped the section " + in_quotes(keyword));
  }

  void add_sets() {
    add_sets_by_value(mesh_.point_sets, "ref", point_refs_, false, file_.name(), diagnostics_);
    add_sets_by_value(mesh_.element_sets, "ref", element_refs_, false, file_.name(), diagnostics_);
    Sets quads;
    add_sets_by_value(quads, "quads ref", quad_refs_, false, file_.name(), diagnostics_);
    for (const auto& [name, members] : quads) mesh_.point_sets[name] = points_of(members);
  }

  std::vector<Index> points_of(const std::vector<Index>& quads) {
    std::vector<Index> points;
    for (const Index quad : quads) {
      for (const Index node : quads_[quad]) {
        if (node >= mesh_.points.size()) fail_index(quads_begin_, quad, 5, "quadrilateral", node);
        points.push_back(node);
      }
    }
    sort_unique(points);
    return points;
  }

  // Vertices and elements of Medit are called 1, 2, ...
  void number_from_one() {
    mesh_.point_ids.resize(mesh_.points.size());
    std::iota(mesh_.point_ids.begin(), mesh_.point_ids.end(), 1);
    mesh_.element_ids.resize(mesh_.hexahedra.size());
    std::iota(mesh_.element_ids.begin(), mesh_.element_ids.end(), 1);
  }

  const FileText& file_;
  Diagnostics& diagnostics_;
  TextCursor in_;
  Mesh mesh_;
  std::vector<std::int64_t> point_refs_, element_refs_;
  std::vector<std::array<Index, 4>> quads_;
  std::vector<std::int64_t> quad_refs_;
  const char* hexahedra_begin_ = nullptr;
  const char* quads_begin_ = nullptr;
};

}  // namespace

Mesh read_medit(const FileText& file, const WantsArray&, Diagnostics& diagnostics) {
  return MeditReader(file, diagnostics).read();
}

}  // namespace suture
