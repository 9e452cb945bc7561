// SPDX-License-Identifier: GPL-3.0-or-later
//
// A map and its islands that are loaded do what those do that were saved.
#include <gtest/gtest.h>

#include <cstring>

#include "kernel/topology/islands.hpp"
#include "tests/base/same_state.hpp"
#include "tests/topology/meshes.hpp"
#include "tests/topology/operations.hpp"

namespace suture {
namespace {

using namespace meshes;

/// A map and its islands, as a run has them.
struct Body {
  CellComplex map;
  Islands islands;

  explicit Body(const Mesh& mesh)
      : map(mesh.hexahedra, static_cast<Index>(mesh.points.size())), islands(map) {}
  TopologyChange follow(const Request& request) {
    TopologyChange change = apply(map, request);
    islands.update(map, change);
    return change;
  }
  void state(Archive& archive) {
    archive("map", map);
    archive("islands", islands);
  }
};

std::vector<Index> numbers_of(const Stars& stars) {
  std::vector<Index> all(stars.cells.begin(), stars.cells.end());
  all.insert(all.end(), stars.offsets.begin(), stars.offsets.end());
  all.insert(all.end(), stars.darts.begin(), stars.darts.end());
  return all;
}

/// Everything that a change says, in its order.
std::vector<Index> numbers_of(const TopologyChange& change) {
  std::vector<Index> all{change.faces_cut, change.faces_sewn};
  const auto add = [&](const auto& values) {
    all.push_back(static_cast<Index>(values.size()));
    all.insert(all.end(), values.begin(), values.end());
  };
  for (std::size_t d = 0; d < 3; ++d) {
    for (const Split& s : change.splits[d]) all.insert(all.end(), {s.old_cell, s.new_cell});
    for (const Merge& m : change.merges[d]) all.insert(all.end(), {m.kept, m.gone});
    add(numbers_of(change.gone[d]));
    add(numbers_of(change.stars[d]));
  }
  for (const auto& removed : change.removed) add(removed);
  add(change.elements);
  return all;
}

/// The ids that the map has built by now are asked for at different times.
void build(CellComplex& map, unsigned what) {
  if ((what & 1) != 0) map.require_edges();
  if ((what & 2) != 0) map.require_faces();
}

TEST(State, AMapThatIsLoadedGoesOnAsTheOneThatWasSaved) {
  std::random_device seeds;
  for (unsigned round = 0; round < 60; ++round) {
    const unsigned seed = seeds();
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const Mesh mesh = round % 3 == 0 ? shuffled(blob(5, 0.7, random), random) : grid(5, 4, 3);
    Body body(mesh), twin(mesh);
    build(body.map, random() % 4);
    build(twin.map, random() % 4);
    Operations operations(random);
    for (auto before = random() % 8; before > 0; --before) {
      body.follow(operations.next(body.map));
    }
    build(body.map, random() % 4);
    load_state(state_of(body), twin);
    ASSERT_EQ(difference_of_states(body, twin), "");
    for (int after = 0; after < 8; ++after) {
      const Request request = operations.next(body.map);
      ASSERT_EQ(numbers_of(body.follow(request)), numbers_of(twin.follow(request)));
      const unsigned what = random() % 4;
      build(body.map, what);
      build(twin.map, what);
      ASSERT_EQ(difference_of_states(body, twin), "");
    }
    twin.map.validate();
    twin.islands.validate(twin.map);
  }
}

TEST(State, OfAMapWithoutOperationsIsSmall) {
  Body body(grid(10, 10, 10)), twin(grid(10, 10, 10));
  build(body.map, 3);
  const StateTree tree = state_of(body.map);
  EXPECT_LT(tree.bytes(), 100u);
  load_state(tree, twin.map);
  EXPECT_TRUE(twin.map.has_edges() && twin.map.has_faces());
  EXPECT_EQ(twin.map.edges().back(), body.map.edges().back());
}

TEST(State, OfAnotherMeshIsRefused) {
  Body body(grid(3, 3, 3)), other(grid(3, 3, 2)), line(grid(27, 1, 1));
  StateTree fresh = state_of(body);
  EXPECT_EQ(refusal_of(fresh, other),
            "/map: a map of 27 elements and 64 vertices belongs to a different mesh: this one has "
            "18 and 48");
  EXPECT_NE(refusal_of(fresh, line), "");
  body.follow({Operation::Kind::pierce, {}, {3}, {}});
  EXPECT_EQ(refusal_of(fresh, body), "/map: operations have already been applied to this map");
  const StateTree operated = state_of(body);
  EXPECT_NE(refusal_of(operated, other), "");
  EXPECT_NE(refusal_of(operated, line), "");
  EXPECT_EQ(refusal_of(operated.groups.at("islands"), other.islands),
            "/: the islands belong to a different mesh");
}

TEST(State, ThatNamesCellsThatAreNotThereIsRefused) {
  Body body(grid(3, 3, 3));
  body.follow({Operation::Kind::pierce, {}, {3}, {}});
  const std::pair<const char*, const char*> arrays[] = {{"map", "corners"},
                                                        {"map", "links"},
                                                        {"islands", "of_elements"},
                                                        {"islands", "some_element"}};
  for (const auto& [group, name] : arrays) {
    StateTree tree = state_of(body);
    const StateTree::Array& array = tree.groups.at(group).arrays.at(name);
    constexpr Index far_away = 0x7FFFFFFF;
    std::memcpy(array.bytes.get() + array.size() - sizeof far_away, &far_away, sizeof far_away);
    Body twin(grid(3, 3, 3));
    EXPECT_NE(refusal_of(tree, twin).find(" that "), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace suture
