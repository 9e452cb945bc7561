// SPDX-License-Identifier: GPL-3.0-or-later
//
// What lies on the bound of a selection, a cut or a pierced path is inside, also far away from the
// scene's zero.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "kernel/build/built_scene.hpp"
#include "kernel/operations/pierce_path.hpp"
#include "kernel/operations/plane_patch.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/host.hpp"
#include "tests/run/translation.hpp"

namespace suture::test {
namespace {

/// A bar of 8 x 2 x 2 cubes of 0.1 m far away, where 0.1 m is not what it says: what lies
/// on a bound is inside all the same, as in exact arithmetic.
class OnTheBound : public testing::TestWithParam<int> {
 protected:
  OnTheBound() {
    scene_.mesh.box = BoxOptions{far_away, {0.8, 0.2, 0.2}, {8, 2, 2}, {1, 1, 1}};
    scene_.constraints.clear();
    built_.emplace(scene_, diagnostics_);
  }
  static Vec3 p(double x, double y, double z) {
    return {x + far_away[0], y + far_away[1], z + far_away[2]};
  }
  std::vector<Index> vertices(decltype(Selection::what) what) const {
    Selection selection;
    selection.what = std::move(what);
    return built_->selector().vertices(in_frame(selection, built_->frame()));
  }
  template <class Kind>
  Kind local(Kind kind) const {
    Event event;
    event.what = std::move(kind);
    return std::get<Kind>(in_frame(std::move(event), built_->frame()).what);
  }

  const double k_ = GetParam(), x_ = 0.1 * k_;
  Scene scene_ = beam(host(), "tm-faure", 8, 2, 0);
  Diagnostics diagnostics_;
  std::optional<BuiltScene> built_;
};

INSTANTIATE_TEST_SUITE_P(Translation, OnTheBound, testing::Range(1, 8));

TEST_P(OnTheBound, NodesAreSelected) {
  const auto layers = [&](decltype(Selection::what) what) {
    return static_cast<double>(vertices(std::move(what)).size()) / 9;
  };
  EXPECT_EQ(layers(Selection::InBox{p(-1, 0, 0), p(x_, 0.2, 0.2)}), k_ + 1);
  EXPECT_EQ(layers(Selection::InBox{p(x_, 0, 0), p(1, 0.2, 0.2)}), 9 - k_);
  EXPECT_EQ(layers(Selection::HalfSpace{p(x_, 0, 0), {3, 0, 0}}), 9 - k_);
  EXPECT_EQ(layers(Selection::HalfSpace{p(x_, 0, 0), {-3, 0, 0}}), k_ + 1);
  EXPECT_EQ(layers(Selection::Plane{p(x_, 0, 0), {3, 0, 0}, 0}), 1);
  EXPECT_EQ(layers(Selection::Plane{p(x_, 0, 0), {3, 0, 0}, -1}), 1);
  const auto reached = vertices(Selection::Sphere{p(x_, 0, 0), x_});
  const auto on_axis = std::ranges::count_if(reached, [&](Index v) {
    return built_->body().attributes().rest().get(v, 1) == 0 &&
           built_->body().attributes().rest().get(v, 2) == 0;
  });
  EXPECT_EQ(static_cast<double>(on_axis), std::min(2 * k_ + 1, 9.0));
}

TEST_P(OnTheBound, TheFirstOfEquallyNearNodesIsTheNearest) {
  const auto nearest = vertices(Selection::Nearest{p(x_ + 0.05, 0.05, 0.05)});
  const auto first = vertices(Selection::InBox{p(x_, 0, 0), p(x_ + 0.1, 0.1, 0.1)});
  EXPECT_EQ(nearest, std::vector<Index>{first[0]});
}

TEST_P(OnTheBound, CentroidsCountAsPositiveAndAsInside) {
  const double* rest = built_->body().attributes().rest().rows();
  const auto faces = [&](const CutPlane& scene) {
    const CutPlane cut = local(scene);
    return faces_across_patch(built_->body().complex(), rest,
                              {cut.point, cut.normal, cut.radius, cut.polygon});
  };
  for (const Dart face : faces({p(x_ + 0.05, 0, 0), {3, 0, 0}})) {
    const Index upper = std::max(face / 24, built_->body().complex().beta3(face) / 24);
    EXPECT_EQ(static_cast<double>(built_->element_name(upper) % 8), k_) << "between k - 1 and k";
  }
  for (const Dart face : faces({p(x_ + 0.05, 0, 0), {-3, 0, 0}})) {
    const Index lower = std::min(face / 24, built_->body().complex().beta3(face) / 24);
    EXPECT_EQ(static_cast<double>(built_->element_name(lower) % 8), k_) << "between k and k + 1";
  }
  // The links of the four bars meet the plane in a square of 0.1 m: three within its side.
  EXPECT_EQ(faces({p(x_, 0.05, 0.05), {1, 0, 0}, 0.1}).size(), 3u);
  const Pierce pierce = local(Pierce{{}, {p(x_ + 0.05, 0.05, 0.05)}, x_});
  const auto elements =
      elements_along_path(built_->body().complex(), rest, pierce.path, pierce.radius);
  const auto in_first_bar =
      std::ranges::count_if(elements, [&](Index e) { return built_->element_name(e) < 8; });
  EXPECT_EQ(static_cast<double>(in_first_bar), std::min(2 * k_ + 1, 8.0));
}

}  // namespace
}  // namespace suture::test
