// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/tear.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "kernel/base/error.hpp"
#include "tests/base/same_state.hpp"
#include "tests/base/sanitizer.hpp"
#include "tests/topology/meshes.hpp"
#include "tests/topology/operations.hpp"

namespace suture {
namespace {

using namespace meshes;

// Cells with places and nothing that moves them.
struct StillBody : Body {
  explicit StillBody(const Mesh& mesh, unsigned threads = 0) : Body(imported(mesh)) {
    compile(diagnostics, threads);
  }

  static Imported imported(const Mesh& mesh) {
    Imported result;
    result.complex = complex_of(mesh);
    result.rest = rest_of(mesh, result.complex);
    result.user_vertex.resize(result.rest.size());
    return result;
  }
  // Non-manifold vertices were split: places by the elements' corners.
  static std::vector<Vec3> rest_of(const Mesh& mesh, const CellComplex& complex) {
    std::vector<Vec3> rest(complex.count(0));
    for (Index e = 0; e < complex.element_count(); ++e)
      for (std::size_t i = 0; i < 8; ++i)
        rest[complex.vertices_of(e)[i]] = mesh.points[mesh.hexahedra[e][i]];
    return rest;
  }

  template <class Map>
  void deform(Map map) {
    for (Index v = 0; v < complex().count(0); ++v) {
      const Column& rest = attributes().rest();
      const Vec3 x = map(Vec3{rest.get(v, 0), rest.get(v, 1), rest.get(v, 2)});
      for (int c = 0; c < 3; ++c) attributes().position().set(v, c, x[static_cast<std::size_t>(c)]);
    }
  }

  std::vector<Dart> faces(const Tear& tear, const std::vector<Index>& elements = {}) {
    return TearCheck(tear, elements, "/tear").faces(*this, 0);
  }

  Diagnostics diagnostics;
};

Tear tear_by(Tear::By by, double above) {
  Tear tear;
  tear.by = by;
  tear.above = above;
  tear.max_fraction = 1;
  return tear;
}

// The definitions, face by face and without any bound: gradients of the trilinear map
// by its derivatives at the centre, eigenvalues by Eigen.
struct Reference {
  StillBody& body;

  Eigen::Vector3d place(const Column& column, Index e, int node) const {
    const Index v = body.complex().vertices_of(e)[static_cast<std::size_t>(node)];
    return {column.get(v, 0), column.get(v, 1), column.get(v, 2)};
  }
  // dx/dxi at xi = 1/2: N_n = prod (xi or 1 - xi)
  Eigen::Matrix3d gradient(const Column& column, Index e) const {
    Eigen::Matrix3d g = Eigen::Matrix3d::Zero();
    for (int n = 0; n < 8; ++n)
      for (int a = 0; a < 3; ++a) g.col(a) += place(column, e, n) * ((n >> a & 1) ? 0.25 : -0.25);
    return g;
  }
  std::pair<double, int> strain(Index e) const {
    const Eigen::Matrix3d rest = gradient(body.attributes().rest(), e);
    const Eigen::Matrix3d F = gradient(body.attributes().position(), e) * rest.inverse();
    const Eigen::Matrix3d E = 0.5 * (F.transpose() * F - Eigen::Matrix3d::Identity());
    int axis = 0;
    double most = -1e300;
    for (int a = 0; a < 3; ++a) {
      const Eigen::Vector3d n = rest.col((a + 1) % 3).cross(rest.col((a + 2) % 3)).normalized();
      if (n.dot(E * n) > most + 1e-12) {
        most = n.dot(E * n);
        axis = a;
      }
    }
    return {Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(E).eigenvalues()[2], axis};
  }
  double elongation(Index e, int axis) const {
    double most = -1e300;
    for (int a = 0; a < 8; ++a) {
      if (a >> axis & 1) continue;
      const int b = a | 1 << axis;
      const double now =
          (place(body.attributes().position(), e, a) - place(body.attributes().position(), e, b))
              .norm();
      const double rest =
          (place(body.attributes().rest(), e, a) - place(body.attributes().rest(), e, b)).norm();
      most = std::max(most, now / rest - 1);
    }
    return most;
  }
  bool tears(Tear::By by, Dart face, double above) const {
    const Dart mate = body.complex().beta3(face);
    const int axis = face % 24 / 4 > 3 ? 2 : static_cast<int>(face % 24 / 4 % 2);
    const int across = mate % 24 / 4 > 3 ? 2 : static_cast<int>(mate % 24 / 4 % 2);
    if (by == Tear::By::elongation)
      return elongation(face / 24, axis) / 2 + elongation(mate / 24, across) / 2 > above;
    const auto [a, of_a] = strain(face / 24);
    const auto [b, of_b] = strain(mate / 24);
    const bool says = (a >= b && of_a == axis) || (b >= a && of_b == across);
    return says && (a + b) / 2 > above;
  }
  std::vector<Dart> faces(Tear::By by, double above) const {
    std::vector<Dart> found;
    for (Dart d = 0; d < 24 * body.complex().element_count(); d += 4)
      if (body.complex().exists(3, d / 24) && body.complex().beta3(d) != none &&
          d < body.complex().beta3(d) && tears(by, d, above))
        found.push_back(d);
    return found;
  }
};

class BothStrains : public testing::TestWithParam<Tear::By> {};
INSTANTIATE_TEST_SUITE_P(Tear, BothStrains,
                         testing::Values(Tear::By::principal_strain, Tear::By::elongation),
                         [](const auto& by) {
                           return by.param == Tear::By::elongation ? "elongation" : "strain";
                         });

TEST_P(BothStrains, AgreesWithTheDefinitionOnRandomMeshes) {
  const unsigned seed = 2024;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> small(-0.15, 0.15), stretch(0.7, 1.5);
  std::size_t torn = 0, whole = 0;
  for (int round = 0; round < 30; ++round) {
    Mesh mesh = blob(5, 0.8, random);
    for (Vec3& p : mesh.points)
      for (double& c : p) c += small(random);
    StillBody body(mesh);
    Vec3 factor{stretch(random), stretch(random), stretch(random)};
    body.deform([&](Vec3 x) {
      return Vec3{factor[0] * x[0] + 0.2 * x[1] + small(random), factor[1] * x[1] + small(random),
                  factor[2] * x[2] - 0.1 * x[0] + small(random)};
    });
    // A third of the elements is not there: rows and elements differ.
    if (round % 3 == 2) {
      std::vector<Index> going;
      for (Index e = 0; e < body.complex().element_count(); e += 3) going.push_back(e);
      body.complex().pierce(going);
      body.attributes().position().resize(body.complex().count(0));
      body.attributes().rest().resize(body.complex().count(0));
    }
    const double above = 0.2 + 0.02 * round;
    const std::vector<Dart> expected = Reference{body}.faces(GetParam(), above);
    EXPECT_EQ(body.faces(tear_by(GetParam(), above)), expected) << "round " << round;
    torn += expected.size();
    whole += body.complex().element_count() * 3u - expected.size();
  }
  EXPECT_GT(torn, 100u);
  EXPECT_GT(whole, torn);
}

// The twin has looked at the body before the operations, and looks again. What the other has
// built lies before its last cuts.
TEST_P(BothStrains, AfterALoadTheSameFacesTear) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> small(-0.15, 0.15);
  std::size_t torn = 0;
  for (int round = 0; round < 20; ++round) {
    Mesh mesh = grid(5, 4, 4);
    for (Vec3& p : mesh.points)
      for (double& c : p) c += small(random);
    StillBody body(mesh), twin(mesh);
    const Tear tear = tear_by(GetParam(), 0.2);
    std::vector<Index> elements;
    for (Index e = 0; e < 80 && round % 2 == 0; ++e)
      if (random() % 4 != 0) elements.push_back(e);
    TearCheck check(tear, elements, "/tear");
    TearCheck other(tear, elements, "/tear");
    other.faces(twin, 0);
    Operations operations(random);
    const auto look = [&] { return check.faces(body, 0); };
    for (int i = 0; i < 6; ++i) {
      const TopologyChange change = apply(body.complex(), operations.next(body.complex()));
      body.attributes().apply(body.complex(), change);
      if (change.faces_sewn != 0 || !change.removed[3].empty()) check.invalidate();
      if (i % 2 == 0) look();
    }
    body.deform([&](Vec3 x) {
      return Vec3{1.2 * x[0] + small(random), 1.1 * x[1] + small(random), x[2] + small(random)};
    });
    load_state(state_of(body.complex()), twin.complex());
    load_state(state_of(body.attributes()), twin.attributes());
    load_state(state_of(check), other);
    const std::vector<Dart> faces = look();
    EXPECT_EQ(other.faces(twin, 0), faces);
    torn += faces.size();
    TearCheck all(tear, std::array<Index, 2>{0, 1}, "/tear");
    EXPECT_EQ(refusal_of(state_of(check), all), "/: the elements that may tear differ");
  }
  EXPECT_GT(torn, 100u);
}

TEST_P(BothStrains, FindNothingInABodyThatTurnsOrIsAtRest) {
  StillBody body(grid(5, 4, 3));
  EXPECT_TRUE(body.faces(tear_by(GetParam(), 1e-6)).empty());
  body.deform([](Vec3 x) { return Vec3{7 - x[1], x[0], x[2] - 3}; });
  EXPECT_TRUE(body.faces(tear_by(GetParam(), 1e-6)).empty());
}

// Stretched by 30 % along y: exactly the faces across y, and exactly above the value.
TEST_P(BothStrains, TearAcrossTheStretch) {
  StillBody body(grid(3, 4, 2));
  body.deform([](Vec3 x) { return Vec3{x[0], 1.3 * x[1], x[2]}; });
  const double value = GetParam() == Tear::By::elongation ? 0.3 : (1.3 * 1.3 - 1) / 2;
  const std::vector<Dart> faces = body.faces(tear_by(GetParam(), value - 1e-9));
  EXPECT_EQ(faces.size(), 3u * 3 * 2);
  for (const Dart face : faces) EXPECT_EQ(face % 24 / 4 % 2, 1u) << "y0 or y1";
  EXPECT_TRUE(body.faces(tear_by(GetParam(), value + 1e-9)).empty());
}

// No face outside, or half outside, of the chosen elements.
TEST_P(BothStrains, StayBetweenTheChosenElements) {
  StillBody body(grid(6, 1, 1));
  body.deform([](Vec3 x) { return Vec3{1.5 * x[0], x[1], x[2]}; });
  EXPECT_EQ(body.faces(tear_by(GetParam(), 0.2)).size(), 5u);
  EXPECT_EQ(body.faces(tear_by(GetParam(), 0.2), {1, 2, 3}),
            (std::vector<Dart>{24 + 8, 2 * 24 + 8}));
}

TEST(TearCheck, RefusesToTearEverythingAtOnce) {
  StillBody body(grid(4, 4, 4));
  body.deform([](Vec3 x) { return Vec3{1.3 * x[0], x[1], x[2]}; });
  Tear tear = tear_by(Tear::By::principal_strain, 0.1);
  tear.max_fraction = 0.25;
  TearCheck check(tear, {}, "/events/0/tear");
  EXPECT_THROW(check.faces(body, 0), NumericalError);
  try {
    check.faces(body, 0);
    ADD_FAILURE();
  } catch (const NumericalError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("/events/0/tear: would tear 48 of 144 faces"), std::string::npos) << text;
    EXPECT_NE(text.find("nothing was torn"), std::string::npos) << text;
  }
  tear.max_fraction = 0.34;
  EXPECT_EQ(body.faces(tear).size(), 48u);
}

// A check that was made before elements went, or were cut, sees what is there now.
TEST(TearCheck, FollowsCutsAndRemovals) {
  StillBody body(grid(5, 1, 1));
  body.deform([](Vec3 x) { return Vec3{1.5 * x[0], x[1], x[2]}; });
  const Tear tear = tear_by(Tear::By::principal_strain, 0.2);
  TearCheck check(tear, {}, "/tear");
  EXPECT_EQ(check.faces(body, 0).size(), 4u);
  body.complex().pierce(std::array<Index, 1>{1});
  check.invalidate();
  EXPECT_EQ(check.faces(body, 0), (std::vector<Dart>{2 * 24 + 8, 3 * 24 + 8}));
}

TEST(TearCheck, TheSameForAnyNumberOfThreads) {
  std::vector<Dart> expected;
  for (const unsigned threads : test::thread_counts()) {
    const Mesh mesh = grid(40, 40, 40);
    StillBody body(mesh, threads);
    body.deform([](Vec3 x) { return Vec3{1.2 * x[0] + 0.1 * std::sin(x[1]), x[1], x[2]}; });
    TearCheck check(tear_by(Tear::By::principal_strain, 0.222), {}, "/tear");
    const std::vector<Dart> faces = check.faces(body, 0);
    if (threads == 1) expected = faces;
    EXPECT_GT(faces.size(), 1000u);
    EXPECT_EQ(faces, expected) << threads << " threads";
  }
}

}  // namespace
}  // namespace suture
