// SPDX-License-Identifier: GPL-3.0-or-later
#include <string>

#include "kernel/base/error.hpp"
#include "kernel/topology/cell_complex.hpp"
#include "kernel/topology/incidence.hpp"

namespace suture {
namespace {

const char* const cell_names[] = {"vertex", "edge", "face"};

std::string dart_text(Dart d) {
  return "dart " + std::to_string(d) + " (element " + std::to_string(d / 24) + ", face " +
         std::to_string(d % 24 / 4) + ", position " + std::to_string(d % 4) + ")";
}

[[noreturn]] void broken(const std::string& law, Dart d, const std::string& found) {
  throw TopologyError("the map is invalid: " + law + " is violated at " + dart_text(d) + ": " +
                      found);
}

/// beta3 is an involution without fixed points that joins different elements, and
/// beta1 after beta3 is one too (faces are glued edge by edge, in opposite senses).
void check_beta3(const CellComplex& map) {
  const Dart darts = 24 * map.element_count();
  for (Dart d = 0; d < darts; ++d) {
    const Dart mate = map.beta3(d);
    if (mate == none) continue;
    if (mate >= darts) broken("beta3 maps to a dart", d, "it is " + std::to_string(mate));
    if (mate / 24 == d / 24)
      broken("beta3 joins different elements", d, "it is " + dart_text(mate));
    if (map.beta3(mate) != d)
      broken("beta3(beta3(d)) = d", d, "beta3 is " + dart_text(mate) + ", whose beta3 is not d");
    const Dart turned = CellComplex::beta1(mate);
    const Dart back = map.beta3(turned);
    if (back == none || CellComplex::beta1(back) != d)
      broken("beta1(beta3(beta1(beta3(d)))) = d", d,
             "the joined faces do not run in opposite directions");
  }
}

/// Darts of one orbit carry one id, that exists.
void check_labels(const CellComplex& map, int dimension) {
  const std::string name = cell_names[dimension];
  for (Dart d = 0; d < 24 * map.element_count(); ++d) {
    if (!map.exists(3, d / 24)) continue;
    const Index id = map.cell(dimension, d);
    if (id >= map.count(dimension))
      broken("every " + name + " id is below the count", d, "it is " + std::to_string(id));
    const Dart mate = map.beta3(d);
    if (mate == none) continue;
    const Dart same = dimension == 0 ? CellComplex::beta1(mate) : mate;
    if (map.cell(dimension, same) != id)
      broken("one id per " + name, d,
             std::to_string(id) + " here, " + std::to_string(map.cell(dimension, same)) + " at " +
                 dart_text(same) + " of the same " + name);
  }
}

/// Different orbits carry different ids, and dart_of(id) is the orbit's smallest
/// dart: the stars of all ids together reach every incidence.
template <int Dimension>
void check_orbits(const CellComplex& map) {
  using namespace incidence;
  const std::string name = cell_names[Dimension];
  std::vector<bool> reached(std::size_t{24} * map.element_count(), false);
  std::vector<Dart> star;
  for (Index id = 0; id < map.count(Dimension); ++id) {
    if (!map.exists(Dimension, id)) continue;
    const Dart some = map.dart_of(Dimension, id);
    if (some / 24 >= map.element_count())
      broken("dart_of is a dart", some, "given for " + name + " " + std::to_string(id));
    if (map.cell(Dimension, some) != id)
      broken("dart_of(" + name + " id) lies on it", some,
             "given for " + std::to_string(id) + ", it lies on " +
                 std::to_string(map.cell(Dimension, some)));
    map.star(Dimension, id, star);
    if (star[0] != some)
      broken("dart_of(" + name + " id) is its smallest dart", some, dart_text(star[0]));
    for (const Dart d : star) reached[d] = true;
  }
  for (Dart d = 0; d < 24 * map.element_count(); ++d)
    if (map.exists(3, d / 24) && dart_at<Dimension>(local_cell_of<Dimension>(d)) == d &&
        !reached[d])
      broken("one " + name + " per id", d,
             "id " + std::to_string(map.cell(Dimension, d)) + " belongs to another orbit");
}

/// Nothing is left of a removed element, and the holes are counted.
void check_holes(const CellComplex& map, int dimension) {
  Index holes = 0;
  for (Index id = 0; id < map.count(dimension); ++id) holes += !map.exists(dimension, id);
  if (holes != map.count(dimension) - map.existing(dimension))
    broken("existing() counts the " +
               (dimension == 3 ? "elements" : cell_names[dimension] + std::string(" ids")),
           0,
           std::to_string(holes) + " do not exist, but existing() reports " +
               std::to_string(map.existing(dimension)) + " of " +
               std::to_string(map.count(dimension)) + " do");
  for (Dart d = 0; dimension < 3 && d < 24 * map.element_count(); ++d)
    if (!map.exists(3, d / 24) && (map.cell(dimension, d) != none || map.beta3(d) != none))
      broken("a removed element has no cells and no neighbours", d,
             "it has " + std::string(cell_names[dimension]) + " " +
                 std::to_string(map.cell(dimension, d)));
}

}  // namespace

void CellComplex::validate() const {
  check_beta3(*this);
  check_holes(*this, 3);
  for (int dimension = 0; dimension < 3; ++dimension)
    if (dimension == 0 || count(dimension) > 0) check_holes(*this, dimension);
  check_labels(*this, 0);
  check_orbits<0>(*this);
  if (!edges_.empty()) {
    check_labels(*this, 1);
    check_orbits<1>(*this);
  }
  if (!faces_.empty()) {
    check_labels(*this, 2);
    check_orbits<2>(*this);
  }
  for (const auto* marks : {&cell_marks_[0], &cell_marks_[1], &element_marks_})
    for (std::size_t i = 0; i < marks->size(); ++i)
      if ((*marks)[i] != 0)
        broken("nothing is marked between operations", 0,
               "one of the cells from number " + std::to_string(64 * i) + " on is marked");
}

}  // namespace suture
