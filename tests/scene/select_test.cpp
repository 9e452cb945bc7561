// SPDX-License-Identifier: GPL-3.0-or-later
//
// Selections contain only existing cells, also after operations.
#include <gtest/gtest.h>

#include <algorithm>

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

}  // namespace
}  // namespace suture::test
