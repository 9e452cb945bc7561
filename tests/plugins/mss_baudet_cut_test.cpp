// SPDX-License-Identifier: GPL-3.0-or-later
// The plugin in the kernel while faces are cut, compared with the plain harness on the resulting
// mesh: only the policies of the columns may be needed.
#include <gtest/gtest.h>

#include <numeric>

#include "kernel/attributes/attributes.hpp"
#include "kernel/forces/force_loop.hpp"
#include "kernel/mesh/box.hpp"
#include "tests/plugins/mss_baudet.hpp"

namespace suture::testing {
namespace {

std::vector<double> in_declared_order(const suture_model& model,
                                      const std::map<std::string, double>& given) {
  std::vector<double> values;
  for (std::uint32_t i = 0; i < model.parameter_count; ++i) {
    const auto at = given.find(model.parameters[i].name);
    values.push_back(at == given.end() ? model.parameters[i].default_value : at->second);
  }
  return values;
}

std::vector<Vec3> values_of(const Column& column) {
  std::vector<Vec3> out(column.size());
  for (Index v = 0; v < column.size(); ++v)
    for (int c = 0; c < 3; ++c) out[v][static_cast<std::size_t>(c)] = column.get(v, c);
  return out;
}
void set_values(Column& column, const std::vector<Vec3>& values) {
  for (Index v = 0; v < column.size(); ++v)
    for (int c = 0; c < 3; ++c) column.set(v, c, values[v][static_cast<std::size_t>(c)]);
}
double sum_of(const Column& column) {
  double sum = 0;
  for (Index row = 0; row < column.size(); ++row) sum += column.get(row, 0);
  return sum;
}

/// 5 x 4 x 3 hexahedra that are no boxes, as one instance of the plugin.
struct Body {
  explicit Body(const std::map<std::string, double>& given) : parameters(given) {
    Mesh mesh = make_box({.size = {0.5, 0.4, 0.3}, .cells = {5, 4, 3}});
    mesh.points = shaken(mesh.points, 0.01, 31);
    complex = CellComplex(mesh.hexahedra, static_cast<Index>(mesh.points.size()));
    attributes = std::make_unique<Attributes>(complex, mesh.points);
    const suture_model& model = mss_baudet();
    instance =
        &attributes->add(std::make_unique<Instance>(
                             model, "body", in_declared_order(model, parameters), diagnostics),
                         complex, {});
    attributes->initialise(complex, diagnostics);
    loop = std::make_unique<ForceLoop>(*attributes, complex, 1);
  }

  void cut(const std::vector<Dart>& faces) {
    const TopologyChange change = complex.cut(faces);
    ASSERT_FALSE(change.empty());
    attributes->apply(complex, change);
    loop->follow(complex, change);
  }

  const Column& column(const std::string& name) const {
    for (std::uint32_t a = 0; a < instance->model().attribute_count; ++a)
      if (name == instance->model().attributes[a].name) return *instance->column(a);
    throw std::out_of_range(name);
  }

  /// Forces at a random state, from the kernel and from the harness.
  void expect_the_harness_forces(unsigned seed) {
    const auto rest = values_of(attributes->rest());
    const std::vector<Vec3> zero(rest.size(), Vec3{});
    const auto x = shaken(rest, 0.02, seed), v = shaken(zero, 1, seed + 1);
    set_values(attributes->position(), x);
    set_values(attributes->velocity(), v);
    set_values(attributes->force(), zero);
    loop->add_forces(0, 0);

    HarnessMesh mesh{rest, {complex.vertices().begin(), complex.vertices().end()}, {}, 0};
    mesh.identity.resize(rest.size());
    std::iota(mesh.identity.begin(), mesh.identity.end(), Index{0});
    mesh.vertices = static_cast<Index>(rest.size());
    ModelHarness plain(instance->model(), parameters, mesh);
    const auto expected = plain.forces(x, v);
    EXPECT_GT(norm_of(expected), 1e3);
    EXPECT_LT(distance(values_of(attributes->force()), expected), 1e-12 * norm_of(expected));
  }

  std::map<std::string, double> parameters;
  Diagnostics diagnostics;
  CellComplex complex;
  std::unique_ptr<Attributes> attributes;
  Instance* instance = nullptr;
  std::unique_ptr<ForceLoop> loop;
};

/// Faces between elements left and right of a plane of the grid.
std::vector<Dart> faces_across_x(const CellComplex& complex, Index column) {
  std::vector<Dart> faces;
  for (Index e = 0; e < complex.element_count(); ++e)
    if (e % 5 == column) faces.push_back(24 * e + 4 * 2);  // face 2: x = 1
  return faces;
}

std::vector<Dart> random_faces(const CellComplex& complex, double share, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Dart> faces;
  for (Dart d = 0; d < 24 * complex.element_count(); d += 4)
    if (complex.can_cut(d) && random() < share * double(std::mt19937::max())) faces.push_back(d);
  return faces;
}

TEST(MssBaudetCut, StiffnessRestTensionAndMassAreConserved) {
  Body body(with(paper_material(), {{"correction", 1}}));
  const double k = sum_of(body.column("stiffness")), l = sum_of(body.column("rest_tension")),
               m = sum_of(body.attributes->mass());
  const Index edges = body.column("stiffness").size();
  EXPECT_NEAR(m, 1000 * 0.06, 3);  // the block is distorted
  for (unsigned round = 0; round < 4; ++round) {
    body.cut(random_faces(body.complex, 0.2, 40 + round));
    EXPECT_NEAR(sum_of(body.column("stiffness")), k, 1e-12 * k);
    EXPECT_NEAR(sum_of(body.column("rest_tension")), l, 1e-12 * l);
    EXPECT_NEAR(sum_of(body.attributes->mass()), m, 1e-12 * m);
  }
  EXPECT_GT(body.column("stiffness").size(), edges);
}

TEST(MssBaudetCut, ForcesAfterCutsAreThoseOfTheMeshThatIsLeft) {
  Body body(with(paper_material(), {{"correction", 1}}));
  body.expect_the_harness_forces(50);
  for (unsigned round = 0; round < 4; ++round) {
    body.cut(random_faces(body.complex, 0.2, 60 + round));
    body.expect_the_harness_forces(70 + round);
  }
}

// The harness names an edge by its vertices, and viscosity is not additive: only
// cuts that leave no two edges between the same vertices, as planes do.
TEST(MssBaudetCut, ViscosityAfterAPlaneCutComesFromTheNewSums) {
  Body body(with(paper_material(), {{"viscosity", 0.7}}));
  body.expect_the_harness_forces(80);
  body.cut(faces_across_x(body.complex, 2));
  body.expect_the_harness_forces(81);
  Index islands = 0;
  body.complex.islands(&islands);
  EXPECT_EQ(islands, 2u);
}

// On a grid no element has memory of its own, with correction neither, although
// coordinates are rounded: lengths of 0.6/60 differ in their last bits, and
// near nu = 1/4 the correction is a small difference of large terms.
TEST(MssBaudetCut, ElementsOfAGridShareTheirConstants) {
  const Mesh mesh = make_box({.size = {0.6, 0.01, 1.2}, .cells = {60, 1, 120}});
  CellComplex complex(mesh.hexahedra, static_cast<Index>(mesh.points.size()));
  Attributes attributes(complex, mesh.points);
  Diagnostics diagnostics;
  const auto parameters =
      in_declared_order(mss_baudet(), with(paper_material(), {{"correction", 1}, {"nu", 0.26}}));
  Instance& instance = attributes.add(
      std::make_unique<Instance>(mss_baudet(), "beam", parameters, diagnostics), complex, {});
  attributes.initialise(complex, diagnostics);
  EXPECT_EQ(instance.table(3).columns.size(), 6u);
  for (const Column& column : instance.table(3).columns)
    EXPECT_TRUE(column.is_constant()) << column.spec().name;
}

}  // namespace
}  // namespace suture::testing
