// SPDX-License-Identifier: GPL-3.0-or-later
//
// Forces and loads of a loaded body are bitwise identical to those of an uninterrupted run.
#include <tbb/global_control.h>

#include <cstring>

#include "kernel/forces/dead_loads.hpp"
#include "kernel/forces/enclosed_volumes.hpp"
#include "kernel/forces/force_loop.hpp"
#include "kernel/forces/pressures.hpp"
#include "tests/attributes/fake_models.hpp"
#include "tests/base/same_state.hpp"
#include "tests/base/sanitizer.hpp"
#include "tests/forces/spring_model.hpp"
#include "tests/topology/operations.hpp"

namespace suture::state_test {
namespace {

using Body = spring_model::Body;
using spring_model::box;

/// Pulls the nodes of cells to where they were: forces that depend on which cells are
/// visited, in which order.
suture_status pull(const suture_context*, const suture_batch* batch) {
  for (std::uint32_t i = 0; i < batch->nodes * 3 * 8; ++i)
    batch->force[i] = batch->cell_columns[0][i % 8] * (batch->rest[i] - batch->position[i]);
  return SUTURE_OK;
}

/// Functors on the faces of the boundary and on vertices.
const suture_model& wall_model() {
  struct Tables {
    std::uint32_t face = 1, vertex = 2;
    suture_functor functor(const char* name, bool on_faces) {
      suture_functor f{};
      f.size = sizeof f;
      f.dimension = on_faces ? 2 : 0;
      f.cell_type = on_faces ? SUTURE_QUADRILATERAL : SUTURE_VERTEX;
      f.lanes = 8;
      f.faces = on_faces ? SUTURE_BOUNDARY_FACES : SUTURE_ALL_FACES;
      f.reads = SUTURE_READ_REST | SUTURE_READ_POSITION;
      f.cell_column_count = 1;
      f.cell_columns = on_faces ? &face : &vertex;
      f.name = name;
      f.doc = "";
      f.force = pull;
      return f;
    }
    fake::Model model{{fake::attribute("mass", 0, 1, &fake::contribute<8, 1>, SUTURE_FROM_VOLUMES,
                                       SUTURE_SHARED_MASS),
                       fake::attribute("face", 2, 1, &fake::contribute<6, 1>),
                       fake::attribute("vertex", 0, 1, &fake::contribute<8, 1>)},
                      {functor("walls", true), functor("anchors", false)}};
  };
  static Tables tables;
  return tables.model.table;
}

/// Springs on two regions and, in some, walls; forces and loads.
struct Simulated {
  Body body;
  std::unique_ptr<ForceLoop> loop;
  std::unique_ptr<DeadLoads> loads;
  std::unique_ptr<Pressures> pressures;
  std::unique_ptr<EnclosedVolumes> volumes;
  std::vector<double> force;

  Simulated(const BoxOptions& box, unsigned variant, unsigned threads) : body(box, true) {
    auto parameters = spring_model::defaults();
    if (variant % 2 == 0) parameters[spring_model::edge_damping] = 3;
    const std::vector<Index> part = variant % 3 == 0 ? part_of_all() : std::vector<Index>{};
    body.add(parameters, {}, variant % 4 != 1);  // threads have work on small loops, too
    body.add(parameters, part, variant % 4 != 1);
    if (variant % 3 != 1)
      body.attributes().add(
          std::make_unique<Instance>(wall_model(), "walls", std::vector{2.0}, body.diagnostics),
          complex(), variant % 2 == 0 ? std::vector<Index>{} : part_of_all());
    attributes().initialise(complex(), body.diagnostics);
    loop = std::make_unique<ForceLoop>(attributes(), complex(), threads);
    loads = std::make_unique<DeadLoads>(attributes());
    pressures = std::make_unique<Pressures>(attributes());
    volumes = std::make_unique<EnclosedVolumes>(attributes(), complex());
    if (variant % 5 == 0) hold();
    add_loads();
  }
  CellComplex& complex() { return body.complex(); }
  Attributes& attributes() { return body.attributes(); }

  std::vector<Index> part_of_all() {
    std::vector<Index> part;
    for (Index e = 0; e < complex().element_count(); ++e)
      if (e % 7 < 5) part.push_back(e);
    return part;
  }
  void hold() {
    std::vector<bool> fixed(attributes().vertex_count());
    for (Index v = 0; v < fixed.size(); ++v) fixed[v] = attributes().rest().get(v, 2) < 0.11;
    loop->skip_fixed(fixed);
  }
  void add_loads() {
    std::vector<Index> vertices;
    for (Index v = 0; v < attributes().vertex_count(); v += 3) vertices.push_back(v);
    std::vector<Dart> faces;
    for (Dart d = 0; d < 24 * complex().element_count(); d += 4)
      if (complex().beta3(d) == none) faces.push_back(d);
    loads->add_force(complex(), vertices, {1, 2, 3}, {});
    loads->add_traction(complex(), faces, {0.3, 0.2, 0.1}, {});
    pressures->add(complex(), faces, 7, {});
    volumes->add(faces, 5, {}, "");
  }
  void apply(const Request& request) {
    const TopologyChange change = suture::apply(complex(), request);
    attributes().apply(complex(), change);
    for (ForceTerm* term : terms()) term->follow(complex(), change);
  }
  const std::vector<double>& forces() {
    Column& column = attributes().force();
    std::fill_n(column.rows(), std::size_t{column.size()} * 4, 0.0);
    loop->add_forces(0, 0);
    for (ForceTerm* term : terms())
      if (term != loop.get())
        term->add_forces_in_step({}, attributes().kernel(0).cells.live(), column.rows());
    force.assign(column.rows(), column.rows() + std::size_t{column.size()} * 4);
    return force;
  }
  void state(Archive& archive) {
    archive("map", complex());
    archive("attributes", attributes());
    archive("loop", *loop);
    archive("loads", *loads);
    archive("pressures", *pressures);
    archive("volumes", *volumes);
  }
  std::array<ForceTerm*, 4> terms() {
    return {loop.get(), loads.get(), pressures.get(), volumes.get()};
  }
};

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

void go_on_alike(const BoxOptions& box, unsigned variant, unsigned threads, std::mt19937& random) {
  Simulated one(box, variant, 1), twin(box, variant, threads);
  Operations operations(random);
  for (auto before = random() % 6; before > 0; --before) one.apply(operations.next(one.complex()));
  one.body.shake(0.02, static_cast<unsigned>(random()));
  one.forces();
  std::vector<Index> whole;
  for (Index e = 0; e < one.complex().element_count(); ++e)
    if (one.complex().exists(3, e) && e % 3 == 0) whole.push_back(e);
  if (variant % 2 == 1) one.loop->sleep(whole);
  load_state(state_of(one), twin);
  ASSERT_EQ(difference_of_states(one, twin), "");
  for (int after = 0; after < 6; ++after) {
    if (after > 0) {  // first, the work goes on from what was loaded
      const Request request = operations.next(one.complex());
      one.apply(request);
      twin.apply(request);
    }
    const auto seed = static_cast<unsigned>(random());
    one.body.shake(0.02, seed);
    twin.body.shake(0.02, seed);
    ASSERT_TRUE(same_bits(one.forces(), twin.forces())) << "operation " << after;
    ASSERT_EQ(one.loop->energy(0), twin.loop->energy(0));
    ASSERT_EQ(difference_of_states(one, twin), "") << "operation " << after;
  }
}

class StateOn : public testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Threads, StateOn, testing::Values(1, 3));

TEST_P(StateOn, ForcesThatAreLoadedHaveTheBitsOfThoseThatWentOn) {
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
  const unsigned first = std::random_device{}(), variants = test::sanitizer.empty() ? 30 : 10;
  for (unsigned variant = 0; variant < variants; ++variant) {
    const unsigned seed = first + variant;
    SCOPED_TRACE("seed " + std::to_string(seed) + ", variant " + std::to_string(variant));
    std::mt19937 random(seed);
    const bool large = variant % 10 == 9;  // several chunks of each functor
    go_on_alike(large ? box(10, 8, 7) : box(6, 5, 4), variant, GetParam(), random);
    if (HasFatalFailure()) return;
  }
}

TEST(State, OfAMotionLoadsGiveTheirBookAlone) {
  Simulated one(box(3, 3, 3), 1, 1);
  one.body.shake(0.02, 1);
  one.forces();
  StateBuffer buffer;
  buffer.save(*one.loads);
  const StateTree before = state_of(*one.loads);
  one.body.shake(0.02, 2);
  one.forces();
  EXPECT_NE(difference(before, state_of(*one.loads)), "");
  buffer.load(*one.loads);
  EXPECT_EQ(difference(before, state_of(*one.loads)), "");
}

TEST(State, OfOtherLoadsOrFunctorsIsRefused) {
  Simulated one(box(3, 3, 3), 1, 1), walls(box(3, 3, 3), 5, 1), larger(box(3, 3, 4), 1, 1);
  EXPECT_EQ(refusal_of(state_of(*one.loop), *walls.loop),
            "/functors: the number of items differs from this run");
  EXPECT_EQ(refusal_of(state_of(*one.loop), *larger.loop), "/functors/0: the rows differ");
  const StateTree tree = state_of(*one.loads);
  one.loads->add_traction(one.complex(), std::array<Dart, 1>{0}, {1, 0, 0}, {});
  EXPECT_EQ(refusal_of(tree, *one.loads), "/loads: the number of items differs from this run");
}

}  // namespace
}  // namespace suture::state_test
