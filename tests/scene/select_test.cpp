// SPDX-License-Identifier: GPL-3.0-or-later
//
// Selections contain only existing cells, also after operations.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "kernel/base/error.hpp"
#include "kernel/build/built_scene.hpp"
#include "tests/run/beam.hpp"

namespace suture::test {
namespace {

Selection selection(decltype(Selection::what) what) {
  Selection result;
  result.what = std::move(what);
  result.path = "/where";
  return result;
}

/// A bar of 4 x 1 x 1 cubes of 0.25 m along x whose first cube is removed, and whose last
/// is cut off.
class CutBar : public ::testing::Test {
 protected:
  CutBar() {
    built_->dynamics().start();
    const auto last = built_->selector().elements(selection(Selection::Nearest{{1, 0, 0}}));
    for (Dart d = 24 * last[0]; d < 24 * last[0] + 24; d += 4)
      if (built_->body().complex().can_cut(d)) built_->body().cut({d});
    built_->body().pierce(built_->selector().elements(selection(Selection::Nearest{{0, 0, 0}})));
  }
  const Selector& selector() const { return built_->selector(); }

  PluginHost host_;
  Diagnostics diagnostics_;
  Scene scene_ = beam(host_, "tm-faure", 4, 1, 0);
  std::unique_ptr<BuiltScene> built_ = std::make_unique<BuiltScene>(scene_, diagnostics_);
};

TEST_F(CutBar, VerticesAreThoseThatExistBothSidesOfACutAmongThem) {
  EXPECT_EQ(selector().vertices(selection(Selection::All{})).size(), 12u + 8u);
  const auto at = [&](double x) {
    return selector().vertices(selection(Selection::Plane{{x, 0, 0}, {1, 0, 0}, -1})).size();
  };
  EXPECT_EQ(at(0.5), 4u);
  EXPECT_EQ(at(0.75), 8u);
  EXPECT_THROW(at(0), InputError) << "the nodes there went with their element";
  EXPECT_THROW(selector().vertices(selection(Selection::Named{"x0"})), InputError);
}

TEST_F(CutBar, ElementsAreThoseThatExist) {
  EXPECT_EQ(selector().elements(selection(Selection::All{})).size(), 3u);
  const auto nearest = selector().elements(selection(Selection::Nearest{{0, 0, 0}}));
  ASSERT_EQ(nearest.size(), 1u);
  EXPECT_TRUE(built_->body().complex().exists(3, nearest[0]));
}

TEST_F(CutBar, BoundaryFacesAreThoseOfNow) {
  const Selection all = selection(Selection::All{});
  EXPECT_EQ(selector().boundary_faces(all).size(), 10u + 6u) << "a bar of two cubes and a cube";
}

// Against the algebra of sets, for random combinations of places, numbers and names.
TEST_F(CutBar, CombinationsSelectWhatTheAlgebraOfSetsSays) {
  const unsigned seed = std::random_device{}();
  std::mt19937 engine(seed);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(engine() % n); };
  const std::vector<Selection> leaves{
      selection(Selection::All{}),
      selection(Selection::InBox{{0.2, 0, 0}, {0.8, 0.1, 1}}),
      selection(Selection::HalfSpace{{0, 0.1, 0}, {0, -1, 0}}),
      selection(Selection::Cylinder{{0.25, 0, 0}, {0.75, 0, 0}, 0.2}),
      selection(Selection::Nearest{{0.6, 0, 0}}),
      selection(Selection::Ids{{1, 2}}),
      selection(Selection::Named{"x1"}),
  };
  using How = Selection::Combined::How;
  using Cells = std::set<Index>;
  const double* rest = built_->body().attributes().rest().rows();
  const auto nodes = [&](const Selection& s) {
    const auto found = selector().vertices_now(s, rest);
    return Cells(found.begin(), found.end());
  };
  const Cells all = nodes(leaves[0]);
  const auto combined = [&](auto& self, int depth) -> std::pair<Selection, Cells> {
    if (depth == 0 || below(5) == 0) {
      const Selection leaf = leaves[below(leaves.size())];
      return {leaf, nodes(leaf)};
    }
    constexpr How hows[] = {How::all_of, How::any_of, How::none_of};
    Selection::Combined tree{hows[below(3)], {}};
    const std::size_t parts = tree.how == How::none_of ? 1 : 1 + below(3);
    Cells cells;
    for (std::size_t i = 0; i < parts; ++i) {
      const auto [part, own] = self(self, depth - 1);
      tree.parts.push_back(part);
      Cells next;
      if (i == 0)
        next = own;
      else if (tree.how == How::all_of)
        std::ranges::set_intersection(cells, own, std::inserter(next, next.end()));
      else
        std::ranges::set_union(cells, own, std::inserter(next, next.end()));
      cells = next;
    }
    if (tree.how != How::none_of) return {selection(tree), cells};
    Cells rest_of;
    std::ranges::set_difference(all, cells, std::inserter(rest_of, rest_of.end()));
    return {selection(tree), rest_of};
  };
  for (int i = 0; i < 300; ++i) {
    const auto [tree, cells] = combined(combined, 3);
    ASSERT_EQ(nodes(tree), cells) << "tree " << i << " of seed " << seed;
  }
}

TEST_F(CutBar, ACylinderIncludesItsEnds) {
  const auto count = [&](double from, double to, double radius) {
    return selector()
        .vertices(selection(Selection::Cylinder{{from, 0, 0}, {to, 0, 0}, radius}))
        .size();
  };
  EXPECT_EQ(count(0.25, 0.5, 0.01), 2u);
  EXPECT_EQ(count(0.25, 0.5, 0.25), 6u) << "all corners of two squares but those on the diagonal";
  EXPECT_EQ(count(0.25, 0.5, 0.36), 8u);
}

}  // namespace
}  // namespace suture::test
