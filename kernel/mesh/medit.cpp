// SPDX-License-Identifier: GPL-3.0-or-later
//
// Medit ASCII meshes. Format: P. Frey, "MEDIT: an interactive mesh visualization
// software", INRIA RT-0253 (2001), appendix; keywords of libMeshb added.
#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <string_view>

#include "kernel/base/sort_unique.hpp"
#include "kernel/mesh/readers.hpp"
#include "kernel/mesh/solid_cells.hpp"

namespace suture {
namespace {

// Cells with an inside: corners of each, and what to call them.
struct SolidSection {
  std::string_view keyword;
  unsigned corners;
  const char *one, *many;
};
constexpr SolidSection solid_sections[] = {
    {"Hexahedra", 8, "hexahedron", "hexahedra"},
    {"Hexaedra", 8, "hexahedron", "hexahedra"},
    {"Tetrahedra", 4, "tetrahedron", "tetrahedra"},
    {"Pyramids", 5, "pyramid", "pyramids"},
    {"Prisms", 6, "prism", "prisms"},
    {"Wedges", 6, "prism", "prisms"},
    {"Pentahedra", 6, "prism", "prisms"},
};

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
    {"Corners", 1, nullptr},
    {"Ridges", 1, nullptr},
    {"RequiredVertices", 1, nullptr},
    {"RequiredEdges", 1, nullptr},
    {"RequiredTriangles", 1, nullptr},
    {"RequiredQuadrilaterals", 1, nullptr},
};

// Faces whose references name sets of points.
struct Faces {
  const char *prefix, *one, *many;
  unsigned corners;
  const char* begin;  // of the entries in the file; null without
  std::vector<Index> nodes;
  std::vector<std::int64_t> refs;
};

class MeditReader {
 public:
  MeditReader(const FileText& file, bool all_solids, Diagnostics& diagnostics)
      : file_(file),
        all_solids_(all_solids),
        diagnostics_(diagnostics),
        in_(file, TextCursor::Comments::hash) {}

  Mesh read() {
    header();
    bool ended = false;
    while (!ended && in_.skip_space()) ended = section(in_.word("a keyword"));
    if (!ended) {
      diagnostics_.warn(file_.name() + ": the closing 'End' is missing; the file may be truncated");
    }
    check_solids();
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
    } else if (const SolidSection* section = find_solid(keyword)) {
      solids(*section);
    } else if (keyword == "Quadrilaterals" || keyword == "Quads") {
      faces(quads_);
    } else if (keyword == "Triangles" && all_solids_) {
      faces(triangles_);
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

  static const SolidSection* find_solid(std::string_view keyword) {
    for (const SolidSection& section : solid_sections)
      if (section.keyword == keyword) return &section;
    return nullptr;
  }

  // Indices are checked at the end: the sections may come in any order.
  void solids(const SolidSection& section) {
    const std::uint64_t n = count(section.many, section.corners + 1);
    for (const ReadSolids& read : solids_)
      if (read.section->many == section.many)
        in_.fail("a second section " + in_quotes(section.keyword));
    if (section.corners != 8 && !all_solids_)
      return skip_entries(section.many, n, section.corners + 1);
    solids_.push_back({&section, in_.position(), mesh_.hexahedra.size()});
    mesh_.hexahedra.reserve(mesh_.hexahedra.size() + n);
    element_refs_.reserve(mesh_.hexahedra.size() + n);
    std::array<Index, 8> nodes;
    for (std::uint64_t e = 0; e < n; ++e) {
      for (unsigned i = 0; i < section.corners; ++i)
        nodes[i] = in_.integer<Index>("number of a vertex") - 1;
      mesh_.hexahedra.push_back(collapsed(std::span<const Index>(nodes.data(), section.corners)));
      element_refs_.push_back(in_.integer<std::int64_t>("reference of a cell"));
    }
  }

  void check_solids() {
    for (std::size_t s = 0; s < solids_.size(); ++s) {
      const ReadSolids& read = solids_[s];
      const std::size_t end =
          s + 1 < solids_.size() ? solids_[s + 1].first : mesh_.hexahedra.size();
      for (std::size_t e = read.first; e < end; ++e)
        for (const Index node : mesh_.hexahedra[e])
          if (node >= mesh_.points.size())
            fail_index(read.begin, e - read.first, read.section->corners + 1, read.section->one,
                       node);
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
  void faces(Faces& faces) {
    if (faces.begin) in_.fail(std::string("a second section of ") + faces.many);
    const std::uint64_t n = count(faces.many, faces.corners + 1);
    faces.begin = in_.position();
    mesh_.skipped_cells[faces.many] += n;
    faces.nodes.reserve(faces.corners * n);
    faces.refs.reserve(n);
    for (std::uint64_t i = 0; i < n; ++i) {
      for (unsigned c = 0; c < faces.corners; ++c)
        faces.nodes.push_back(in_.integer<Index>("number of a vertex") - 1);
      faces.refs.push_back(in_.integer<std::int64_t>("reference of a face"));
    }
  }

  void skip_entries(const char* cells, std::uint64_t n, unsigned words) {
    for (std::uint64_t i = 0; i < n * words; ++i) in_.word("a number");
    if (cells) mesh_.skipped_cells[cells] += n;
  }

  void skip(std::string_view keyword) {
    for (const Section& known : skipped_sections) {
      if (known.keyword != keyword) continue;
      return skip_entries(known.cells, count(known.cells ? known.cells : "entries", known.words),
                          known.words);
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
    for (const Faces* faces : {&quads_, &triangles_}) {
      Sets sets;
      add_sets_by_value(sets, faces->prefix, faces->refs, false, file_.name(), diagnostics_);
      for (const auto& [name, members] : sets) mesh_.point_sets[name] = points_of(*faces, members);
    }
  }

  std::vector<Index> points_of(const Faces& faces, const std::vector<Index>& members) {
    std::vector<Index> points;
    for (const Index face : members) {
      for (unsigned c = 0; c < faces.corners; ++c) {
        const Index node = faces.nodes[faces.corners * face + c];
        if (node >= mesh_.points.size())
          fail_index(faces.begin, face, faces.corners + 1, faces.one, node);
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

  struct ReadSolids {
    const SolidSection* section;
    const char* begin;  // of its entries in the file
    std::size_t first;  // of its cells
  };

  const FileText& file_;
  const bool all_solids_;
  Diagnostics& diagnostics_;
  TextCursor in_;
  Mesh mesh_;
  std::vector<std::int64_t> point_refs_, element_refs_;
  Faces quads_{"quads ref", "quadrilateral", "quadrilaterals", 4, nullptr, {}, {}};
  Faces triangles_{"triangles ref", "triangle", "triangles", 3, nullptr, {}, {}};
  std::vector<ReadSolids> solids_;
};

}  // namespace

Mesh read_medit(const FileText& file, const MeshWants& wants, Diagnostics& diagnostics) {
  return MeditReader(file, wants.all_solids, diagnostics).read();
}

}  // namespace suture
