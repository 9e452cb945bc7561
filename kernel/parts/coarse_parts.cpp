// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/coarse_parts.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "kernel/base/sort_unique.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/parts/cube_sides.hpp"
#include "kernel/parts/moments.hpp"
#include "kernel/parts/wall_tiles.hpp"

// How cells are described anew
// ============================
//
//   points     Points of elements at the same place of the mesh have one number.
//   cells      Cells whose union is convex, to within the snap distance of blades, become one.
//   walls      The triangles between different cells. A wall knows the cells on both sides, and
//              how the surface of the body shows it (part_walls.hpp).
//   tiles      Walls in one plane, with the same cells on both sides, are one tile, unless an edge
//              between them is the end of another wall (wall_tiles.hpp).
//   corners    A point between two edges of tiles in a line is none of their corners.
//   cones      Tiles are divided into triangles, cells into tetrahedra with one common corner.
//
// A cell that cannot be described so keeps its tetrahedra and their points; then all begins again
// without it.

namespace suture {
namespace {

constexpr double volume_error = 1e-12;  // of a cell
constexpr unsigned most_attempts = 30;

class Coarsening {
 public:
  Coarsening(Parts& parts, std::vector<Index>& cut_of_triangle, const CellComplex& complex,
             const LatticePlaces& places, std::span<const Index> elements)
      : parts_(parts),
        cuts_(cut_of_triangle),
        complex_(complex),
        map_(parts, cut_of_triangle, complex, places, elements),
        described_(map_.elements().size()) {
    fixed_.cells.resize(map_.cells().size());
    fixed_.walls.resize(map_.walls().size());
    fixed_.points.resize(map_.point_count());
  }

  void run() {
    for (unsigned attempt = 0; attempt < most_attempts; ++attempt) {
      CellSets sets(map_, fixed_.cells);
      WallTiles tiles(map_, sets, fixed_);
      if (tiles.find() && find_cones(sets, tiles.all())) return write(sets, tiles.all());
    }
  }

 private:
  /// The new tetrahedra of an element.
  struct Described {
    bool is_changed = false;
    std::vector<std::array<Index, 4>> tetrahedra;
    std::vector<Index> cells;
  };

  /// A set of cells, by its first cell.
  struct Shell {
    std::vector<Triangle> triangles;  ///< oriented outwards
    std::vector<Index> tetrahedra;    ///< as they were
    std::size_t cells = 0;
    bool is_changed = false;
    std::vector<std::array<Index, 4>> cone;  ///< what replaces the tetrahedra, if anything
  };
  std::vector<Shell> shells_of(CellSets& sets, const std::vector<WallTile>& tiles) const {
    std::vector<Shell> shells(map_.cells().size());
    for (const WallTile& tile : tiles)
      for (const PartWalls::Side& side : map_.walls()[tile.walls[0]].known_sides()) {
        const Index cell = sets.root(side);
        Shell& shell = shells[cell];
        shell.is_changed = shell.is_changed || tile.is_changed;
        for (const auto& [a, b, c] : tile.triangles)
          shell.triangles.push_back(cell == tile.cell ? Triangle{a, b, c} : Triangle{a, c, b});
      }
    for (Index c = 0; c < map_.cells().size(); ++c) {
      Shell& shell = shells[sets.root(c)];
      ++shell.cells;
      shell.tetrahedra.insert(shell.tetrahedra.end(), map_.cells()[c].tetrahedra.begin(),
                              map_.cells()[c].tetrahedra.end());
    }
    return shells;
  }

  /// Divides cells whose tiles have changed, or that could do with fewer tetrahedra. False if there
  /// are cells that cannot be divided so: they are fixed then.
  bool find_cones(CellSets& sets, const std::vector<WallTile>& tiles) {
    std::vector<Shell> shells = shells_of(sets, tiles);
    middles_.clear();
    bool is_done = true;
    for (Index c = 0; c < map_.cells().size(); ++c) {
      Shell& shell = shells[c];
      if (shell.tetrahedra.empty()) continue;
      const Index element = map_.cells()[c].element;
      const bool must = shell.is_changed || shell.cells > 1;
      if (!must && (!map_.elements()[element].is_wanted || shell.tetrahedra.size() == 1 ||
                    fixed_.cells[c] != 0))
        continue;
      double volume = 0;
      for (const Index m : sets.members(c)) volume += map_.cells()[m].volume;
      shell.cone = cone(element, shell.triangles, volume);
      if (!must && shell.cone.size() >= shell.tetrahedra.size()) shell.cone.clear();
      if (!shell.cone.empty() || !must) continue;
      is_done = false;
      for (const Index m : sets.members(c)) fixed_.cells[m] = 1;
    }
    if (is_done) describe(shells);
    return is_done;
  }

  void describe(const std::vector<Shell>& shells) {
    for (Index c = 0; c < map_.cells().size(); ++c)
      if (!shells[c].cone.empty()) described_[map_.cells()[c].element].is_changed = true;
    for (Index c = 0; c < map_.cells().size(); ++c) {
      Described& element = described_[map_.cells()[c].element];
      const Shell& shell = shells[c];
      if (shell.tetrahedra.empty() || !element.is_changed) continue;
      const Index number = element.cells.empty() ? 0 : element.cells.back() + 1;
      element.tetrahedra.insert(element.tetrahedra.end(), shell.cone.begin(), shell.cone.end());
      if (shell.cone.empty())
        for (const Index t : shell.tetrahedra)
          element.tetrahedra.push_back(map_.tetrahedra()[t].corners);
      element.cells.resize(element.tetrahedra.size(), number);
    }
  }

  /// Tetrahedra between a corner of a cell, or its middle, and the triangles of its faces. Empty if
  /// one of them would not be positive.
  std::vector<std::array<Index, 4>> cone(Index element, const std::vector<Triangle>& triangles,
                                         double volume) {
    std::vector<Index> corners;
    for (const Triangle& t : triangles) corners.insert(corners.end(), t.begin(), t.end());
    sort_unique(corners);
    std::ranges::sort(corners, {}, [&](Index p) { return map_.place(element, p); });
    const double least = 1e-9 * volume;
    std::size_t fewest = triangles.size();
    Index best = none;
    for (const Index apex : corners) {
      const Vec3& at = map_.place(element, apex);
      std::size_t count = 0;
      for (const Triangle& t : triangles) {
        if (std::ranges::find(t, apex) != t.end()) continue;
        const auto& [a, b, c] = t;
        if (!(six_volumes({at, map_.place(element, a), map_.place(element, b),
                           map_.place(element, c)}) > least)) {
          count = triangles.size();
          break;
        }
        ++count;
      }
      if (count >= fewest) continue;
      fewest = count;
      best = apex;
    }
    std::vector<std::array<Index, 4>> tetrahedra;
    Vec3 middle{};
    if (best == none) {
      for (const Index p : corners)
        middle =
            plus(middle, scaled(1.0 / static_cast<double>(corners.size()), map_.place(element, p)));
      best = static_cast<Index>(map_.point_count() + middles_.size());
    }
    const bool has_middle = best >= map_.point_count();
    double sum = 0;
    for (const Triangle& t : triangles) {
      if (std::ranges::find(t, best) != t.end()) continue;
      const auto& [a, b, c] = t;
      const double six =
          six_volumes({has_middle ? middle : map_.place(element, best), map_.place(element, a),
                       map_.place(element, b), map_.place(element, c)});
      if (!(six > 0)) return {};
      sum += six;
      tetrahedra.push_back({best, a, b, c});
    }
    if (!(std::abs(sum - volume) < volume_error)) return {};
    if (has_middle) middles_.push_back(middle);
    return tetrahedra;
  }

  void write(CellSets& sets, const std::vector<WallTile>& tiles) {
    Parts out;
    out.first.push_back(0);
    std::vector<Index> new_point(parts_.points.size(), none);
    const auto old = [&](Index p) {
      if (new_point[p] == none) {
        new_point[p] = static_cast<Index>(out.points.size());
        out.points.push_back(parts_.points[p]);
      }
      return new_point[p];
    };
    std::vector<std::unordered_map<Index, Index>> written(map_.elements().size());  // points
    const auto point = [&](Index i, Index p) {
      const auto [known, is_new] = written[i].try_emplace(p, static_cast<Index>(out.points.size()));
      if (is_new)
        out.points.push_back({map_.elements()[i].number, p < map_.point_count()
                                                             ? map_.place(i, p)
                                                             : middles_[p - map_.point_count()]});
      return known->second;
    };
    std::unordered_map<Index, Index> position;
    for (Index i = 0; i < map_.elements().size(); ++i) position[map_.elements()[i].number] = i;
    const auto changed = [&](Index e) {
      const auto at = position.find(e);
      return at != position.end() && described_[at->second].is_changed ? at->second : none;
    };
    for (std::size_t i = 0; i < parts_.elements.size(); ++i) {
      const Index e = parts_.elements[i];
      if (!complex_.exists(3, e)) continue;
      const Index at = changed(e);
      if (at != none && is_full(at)) continue;
      if (at != none) {
        for (const auto& [a, b, c, d] : described_[at].tetrahedra)
          out.tetrahedra.push_back({point(at, a), point(at, b), point(at, c), point(at, d)});
        out.cells.insert(out.cells.end(), described_[at].cells.begin(), described_[at].cells.end());
      } else {
        for (Index t = parts_.first[i]; t < parts_.first[i + 1]; ++t) {
          const auto& [a, b, c, d] = parts_.tetrahedra[t];
          out.tetrahedra.push_back({old(a), old(b), old(c), old(d)});
          out.cells.push_back(Index{parts_.cells[t]});
        }
      }
      out.elements.push_back(e);
      out.moments.push_back(parts_.moments[i]);
      out.first.push_back(static_cast<Index>(out.tetrahedra.size()));
    }
    std::vector<Index> cuts;
    const auto add = [&](const Triangle& corners, std::uint8_t is_cut, Index cut) {
      out.triangles.push_back(corners);
      out.is_cut.push_back(is_cut);
      cuts.push_back(cut);
    };
    for (std::size_t t = 0; t < parts_.triangles.size(); ++t) {
      const auto& [a, b, c] = parts_.triangles[t];
      const Index e = parts_.points[a].element;
      if (!complex_.exists(3, e)) continue;
      const Index at = changed(e);
      if (at == none) {
        add({old(a), old(b), old(c)}, parts_.is_cut[t], cuts_[t]);
      } else if (!map_.is_matched(t)) {
        const auto same = [&](Index p) {
          const Index known = map_.known_number(at, parts_.points[p].at);
          return map_.has(at, known) ? point(at, known) : old(p);
        };
        add({same(a), same(b), same(c)}, parts_.is_cut[t], cuts_[t]);
      }
    }
    for (const WallTile& tile : tiles) {
      for (const PartWalls::Side& side : map_.walls()[tile.walls[0]].known_sides()) {
        const Index i = map_.element_of(side);
        if (side.mark.is_cut == PartWalls::hidden || !described_[i].is_changed) continue;
        const bool is_own = sets.root(side) == tile.cell;
        for (const auto& [a, b, c] : tile.triangles)
          add({point(i, a), point(i, is_own ? b : c), point(i, is_own ? c : b)}, side.mark.is_cut,
              side.mark.cut);
      }
    }
    out.general = std::move(parts_.general);
    out.outer_sides = std::move(parts_.outer_sides);
    parts_ = std::move(out);
    cuts_ = std::move(cuts);
  }

  /// The six tetrahedra of a whole element.
  bool is_full(Index i) const {
    const Described& element = described_[i];
    if (element.tetrahedra.size() != 6) return false;
    for (const auto& t : element.tetrahedra)
      for (const Index p : t)
        if (p >= map_.point_count() || !EdgeEnds(map_.place(i, p)).is_corner()) return false;
    double volume = 0;
    for (const auto& [a, b, c, d] : element.tetrahedra)
      volume +=
          six_volumes({map_.place(i, a), map_.place(i, b), map_.place(i, c), map_.place(i, d)});
    return std::abs(volume - 48) < 1e-9;
  }

  Parts& parts_;
  std::vector<Index>& cuts_;
  const CellComplex& complex_;
  const PartWalls map_;
  FixedParts fixed_;
  std::vector<Described> described_;  ///< by element of the map
  std::vector<Vec3> middles_;         ///< of cells, the points behind all others
};

}  // namespace

void coarsen_parts(Parts& parts, std::vector<Index>& cut_of_triangle, const CellComplex& complex,
                   const LatticePlaces& places, std::span<const Index> elements) {
  Coarsening(parts, cut_of_triangle, complex, places, elements).run();
}

}  // namespace suture
