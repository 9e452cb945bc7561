// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/topology/fuzz.hpp"

#include <algorithm>

#include "kernel/base/error.hpp"
#include "kernel/topology/islands.hpp"
#include "tests/topology/cgal_map.hpp"
#include "tests/topology/changes.hpp"
#include "tests/topology/meshes.hpp"

namespace suture::fuzz {
namespace {

using Kind = Operation::Kind;

/// For every dart the smallest dart of its cell (dimension 0..3) or island (4).
std::vector<Dart> orbits(const CellComplex& map, const Islands& islands, int dimension) {
  const Dart darts = 24 * map.element_count();
  std::vector<Dart> first(
      std::max({map.count(std::min(dimension, 3)), islands.count(), darts / 24}), none);
  std::vector<Dart> result(darts, none);
  for (Dart d = 0; d < darts; ++d) {
    if (!map.exists(3, d / 24)) continue;
    const Index id = dimension == 4 ? islands.of(d / 24) : map.cell(dimension, d);
    if (first[id] == none) first[id] = d;
    result[d] = first[id];
  }
  return result;
}

/// The same mesh on both sides, with the islands followed.
class Players {
 public:
  explicit Players(const Mesh& mesh)
      : map_(meshes::complex_of(mesh)), islands_(map_), oracle_(mesh) {}

  const CellComplex& map() const { return map_; }
  Tally tally;

  /// Returns the law that is broken afterwards, or "".
  std::string perform(const Operation& operation) {
    const Request wanted = request(map_, operation);
    const CellComplex before = map_;
    try {
      const TopologyChange change = apply(map_, wanted);
      islands_.update(map_, change);
      count(change);
      if (const std::string unreported = ChangeCheck::offence(before, map_, change);
          !unreported.empty())
        return unreported;
    } catch (const TopologyError& error) {  // seams can be impossible together
      return refused(wanted, error.what());
    }
    follow(wanted);
    return compare();
  }

  std::string compare() const {
    try {
      map_.validate();
      islands_.validate(map_);
    } catch (const TopologyError& error) {
      return error.what();
    }
    if (!oracle_.is_valid()) return "CGAL's map is not valid";
    for (int dimension = 0; dimension <= 4; ++dimension)
      if (orbits(map_, islands_, dimension) != oracle_.orbits(dimension))
        return "the orbits of dimension " + std::to_string(dimension) + " are not those of CGAL";
    return {};
  }

 private:
  void count(const TopologyChange& change) {
    tally.faces_cut += change.faces_cut;
    tally.elements_removed += change.removed[3].size();
    tally.faces_sewn += change.faces_sewn;
    tally.vertices_split += change.splits[0].size();
    tally.vertices_merged += change.merges[0].size();
    tally.copies += change.copies.size();
    tally.absorbed += change.absorbed.size();
  }

  void follow(const Request& wanted) {
    switch (wanted.kind) {
      case Kind::pierce:
        return oracle_.pierce(wanted.elements);
      case Kind::sew:
        return oracle_.sew(wanted.seams);
      case Kind::clone:
        return oracle_.clone(wanted.cloning);
      default:
        return oracle_.cut(wanted.faces);
    }
  }

  std::string refused(const Request& wanted, const std::string& why) {
    if (wanted.kind == Kind::clone) return compare();  // an earlier line has been left out
    if (wanted.kind != Kind::sew) return "refused: " + why;
    if (!oracle_.folds(wanted.seams)) return "refused, but CGAL can: " + why;
    ++tally.refused;
    return compare();  // and nothing has happened
  }

  CellComplex map_;
  Islands islands_;
  CgalMap oracle_;
};

/// Operations at random on a map as it is.
class Author {
 public:
  Author(const CellComplex& map, std::mt19937& random) : map_(map), random_(random) {}

  Operation write() {
    const auto kind = below(20);
    if (kind < 7) return cut();
    if (kind < 11) return tear();
    if (kind < 14) return pierce();
    return kind < 18 ? sew() : clone();
  }

 private:
  std::size_t below(std::size_t end) { return random_() % end; }

  Dart some_dart() { return static_cast<Dart>(below(24 * std::size_t{map_.element_count()})); }

  Operation cut() {
    std::vector<Dart> faces = meshes::interior_faces(map_);
    std::shuffle(faces.begin(), faces.end(), random_);
    const std::size_t most = below(4) == 0 ? faces.size() / 2 : faces.size() / 12;
    faces.resize(std::min(faces.size(), 1 + below(most + 1)));
    for (Dart& d : faces) {
      remember({d, map_.beta3(d)});
      d = below(2) ? d + static_cast<Dart>(below(4)) : map_.beta3(d);
    }
    return {Kind::cut, faces};
  }

  Operation tear() {
    Operation result{Kind::tear, {}};
    for (auto n = 1 + below(4); n > 0; --n) result.numbers.push_back(some_dart());
    for (const Dart d : request(map_, result).faces) remember({d, map_.beta3(d)});
    return result;
  }

  Operation pierce() {
    Operation result{Kind::pierce, {}};
    for (auto n = 1 + below(1 + map_.element_count() / 16); n > 0; --n)
      result.numbers.push_back(some_dart() / 24);
    return result;
  }

  /// Mostly what was cut before, all of it or a part; at times faces that never met.
  Operation sew() {
    std::shuffle(cut_.begin(), cut_.end(), random_);
    const std::size_t kept = below(3) == 0 ? 0 : below(cut_.size() + 1);
    std::vector<Seam> seams(cut_.begin() + std::ptrdiff_t(kept), cut_.end());
    cut_.resize(kept);
    if (below(4) == 0) {
      seams.resize(std::min<std::size_t>(seams.size(), 3));
      add_foreign(seams);
    }
    Operation result{Kind::sew, {}};
    for (Seam seam : seams) {
      for (auto turns = below(4); turns > 0; --turns)
        seam = {CellComplex::beta1(seam.one), CellComplex::beta0(seam.other)};
      result.numbers.insert(result.numbers.end(), {seam.one, seam.other});
    }
    return result;
  }

  /// One to three copies of some elements, joined at random where their originals were; others go,
  /// as if a copy had taken their material.
  Operation clone() {
    Cloning cloning;
    std::vector<std::vector<Index>> now(map_.element_count());  // what takes the place of each
    for (Index e = 0; e < now.size(); ++e) {
      if (below(12) != 0 || !map_.exists(3, e)) {
        now[e] = {e};
        continue;
      }
      for (auto n = below(4); n > 0; --n) {
        now[e].push_back(map_.element_count() + static_cast<Index>(cloning.origins.size()));
        cloning.origins.push_back(e);
      }
    }
    for (Index e = 0; e < now.size(); ++e)
      if (now[e].empty() && cloning.origins.empty())
        now[e] = {e};
      else if (now[e].empty())
        cloning.absorbed.push_back(
            {e, map_.element_count() + static_cast<Index>(below(cloning.origins.size()))});
    for (const Dart d : meshes::interior_faces(map_)) join(d, now, cloning);
    return operation_of(cloning);
  }

  void join(Dart face, std::vector<std::vector<Index>>& now, Cloning& cloning) {
    const Dart mate = map_.beta3(face);
    std::vector<Index>&ones = now[face / 24], &others = now[mate / 24];
    if (ones == std::vector{face / 24} && others == std::vector{mate / 24}) {
      if (below(12) == 0) cloning.cut.push_back(face);
      return;
    }
    std::shuffle(ones.begin(), ones.end(), random_);
    for (std::size_t i = 0; i < std::min(ones.size(), others.size()); ++i) {
      const Seam seam{24 * ones[i] + face % 24, 24 * others[i] + mate % 24};
      if (below(4) == 0)
        remember(seam);
      else
        cloning.seams.push_back(seam);
    }
  }

  /// Faces on the boundary that never met, up to two of each of two elements: glued
  /// twice, elements tend to fold.
  void add_foreign(std::vector<Seam>& seams) {
    std::vector<Dart> open;
    for (Dart d = 0; d < 24 * map_.element_count(); d += 4)
      if (map_.exists(3, d / 24) && map_.beta3(d) == none) open.push_back(d);
    for (int i = 0; i < 3 && !open.empty(); ++i) {
      const Dart one = open[below(open.size())], other = open[below(open.size())];
      seams.push_back({one, other});
      for (int f = 0; f < 2; ++f)
        seams.push_back({24 * (one / 24) + static_cast<Dart>(below(24)),
                         24 * (other / 24) + static_cast<Dart>(below(24))});
    }
  }

  void remember(Seam seam) { cut_.push_back(seam); }

  const CellComplex& map_;
  std::mt19937& random_;
  std::vector<Seam> cut_;
};

/// Zeller and Hildebrandt (2002), ddmin: leaves out ever smaller pieces of `items`, in
/// groups of `width`, as long as `still` holds for the rest; until none can go.
template <class T, class Still>
void minimise(std::vector<T>& items, std::size_t width, const Still& still) {
  std::size_t piece = items.size() / width;
  for (bool shorter = true; piece > 0; piece = shorter ? piece : piece / 2) {
    shorter = false;
    for (std::size_t at = 0; at < items.size();) {
      const std::size_t end = std::min(at + piece * width, items.size());
      std::vector<T> rest(items.begin(), items.begin() + std::ptrdiff_t(at));
      rest.insert(rest.end(), items.begin() + std::ptrdiff_t(end), items.end());
      if (still(rest)) {
        items = std::move(rest);
        shorter = true;
      } else {
        at = end;
      }
    }
  }
}

}  // namespace

std::optional<Offence> play(const Journal& journal) {
  Players players(journal.mesh);
  if (const std::string law = players.compare(); !law.empty()) return Offence{0, law};
  for (std::size_t i = 0; i < journal.operations.size(); ++i)
    if (const std::string law = players.perform(journal.operations[i]); !law.empty())
      return Offence{i, law};
  return {};
}

std::optional<Offence> play_random(const Mesh& mesh, std::size_t operations, std::mt19937& random,
                                   Journal& journal, Tally& tally) {
  journal.mesh = mesh;
  journal.operations.clear();
  Players players(mesh);
  players.tally = tally;
  Author author(players.map(), random);
  if (const std::string law = players.compare(); !law.empty()) return Offence{0, law};
  for (std::size_t i = 0; i < operations; ++i) {
    journal.operations.push_back(author.write());
    if (const std::string law = players.perform(journal.operations.back()); !law.empty())
      return Offence{i, law};
  }
  tally = players.tally;
  return {};
}

Journal shrink(Journal journal, const std::function<bool(const Journal&)>& fails) {
  Journal trial = journal;
  minimise(journal.operations, 1, [&](const std::vector<Operation>& operations) {
    trial.operations = operations;
    return fails(trial);
  });
  for (std::size_t i = 0; i < journal.operations.size(); ++i) {
    trial.operations = journal.operations;
    minimise(journal.operations[i].numbers, journal.operations[i].kind == Kind::sew ? 2 : 1,
             [&](const std::vector<Index>& numbers) {
               trial.operations[i].numbers = numbers;
               return fails(trial);
             });
  }
  return journal;
}

}  // namespace suture::fuzz
