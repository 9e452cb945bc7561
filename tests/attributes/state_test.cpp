// SPDX-License-Identifier: GPL-3.0-or-later
//
// Loaded attributes are bitwise identical to the saved ones, and evolve identically.
#include "tests/attributes/bodies.hpp"
#include "tests/base/same_state.hpp"
#include "tests/topology/operations.hpp"

namespace suture {
namespace {

using Regions = std::vector<std::vector<Index>>;

/// A map and its attributes, with a model on each region.
struct Simulated {
  const fake::Model& model;
  CellComplex complex;
  Attributes attributes;

  Simulated(const fake::Model& m, const FakeBody& body, const Regions& regions)
      : model(m), complex(body.complex), attributes(complex, body.rest) {
    for (std::size_t i = 0; i < regions.size(); ++i)
      add(attributes, complex, model.table, regions[i], 2 + static_cast<double>(i));
    initialise(attributes, complex);
  }
  void apply(const Request& request) { attributes.apply(complex, suture::apply(complex, request)); }
  void move(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> shift(-1, 1);
    for (Index v = 0; v < attributes.vertex_count(); ++v)
      for (int c = 0; c < 3; ++c) {
        attributes.position().set(v, c, shift(random));
        attributes.velocity().set(v, c, shift(random));
        attributes.force().set(v, c, seed % 3 == 0 ? shift(random) : 0);
      }
    for (const auto& instance : attributes.instances())
      for (Table& table : instance->tables())
        for (Column& column : table.columns)
          if (column.has_trial())
            for (Index row = 0; row < column.size(); ++row)
              for (int c = 0; c < column.spec().components; ++c) {
                column.set(row, c, shift(random));
                column.trial_block(0)[column.offset(row) + static_cast<std::size_t>(c) * 8] =
                    shift(random);
              }
    for (const auto& instance : attributes.instances())
      for (Table& table : instance->tables())
        for (Column& column : table.columns) column.pad();
  }
  /// Columns that operations alone change.
  void mark(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    for (const auto& instance : attributes.instances())
      for (Table& table : instance->tables())
        for (Column& column : table.columns)
          for (Index row = 0; row < column.size(); ++row)
            if (column.spec().policy != SUTURE_FROM_VOLUMES)
              column.set(row, 0, static_cast<double>(random() % 100));
    for (Index v = 0; v < attributes.vertex_count(); v += 5)
      attributes.fixed().set(v, 0, static_cast<double>(random() % 8));
  }
  void state(Archive& archive) {
    archive("map", complex);
    archive("attributes", attributes);
  }
};

Regions random_regions(const FakeBody& body, Random& random) {
  Regions regions(1 + random() % 3);
  for (auto& region : regions)
    for (Index e = 0; e < body.complex.element_count() && regions.size() > 1; ++e)
      if (random() % 3 != 0) region.push_back(e);
  return regions;
}

void expect_same_rows(const Table& a, const Table& b) {
  ASSERT_EQ(a.cells.size(), b.cells.size());
  ASSERT_EQ(a.cells.live_count(), b.cells.live_count());
  ASSERT_EQ(a.volumes, b.volumes);
  for (Index row = 0; row < a.cells.size(); ++row) {
    ASSERT_EQ(a.cells.is_live(row), b.cells.is_live(row));
    ASSERT_EQ(a.cells.cell(row), b.cells.cell(row));
  }
  for (std::size_t i = 0; i < a.columns.size(); ++i) {
    const Column &one = a.columns[i], &other = b.columns[i];
    ASSERT_EQ(one.size(), other.size());
    ASSERT_EQ(one.is_constant(), other.is_constant());
    for (Index row = 0; row < one.size(); ++row)
      for (int c = 0; c < one.spec().components; ++c)
        ASSERT_EQ(one.get(row, c), other.get(row, c)) << one.spec().name << ", row " << row;
  }
}

/// As others see it, whatever state() says.
void expect_same(const Simulated& a, const Simulated& b) {
  for (int d = 0; d < 4; ++d) {
    expect_same_rows(a.attributes.kernel(d), b.attributes.kernel(d));
    for (std::size_t i = 0; i < a.attributes.instances().size(); ++i)
      expect_same_rows(a.attributes.instances()[i]->table(d),
                       b.attributes.instances()[i]->table(d));
  }
  const RestPlaces one = a.attributes.rest_places(a.complex),
                   other = b.attributes.rest_places(b.complex);
  ASSERT_EQ(one.own().count(), other.own().count());
  for (Index e = 0; e < a.complex.element_count(); ++e) {
    ASSERT_EQ(one.own().slot(e), other.own().slot(e));
    if (a.complex.exists(3, e)) {
      ASSERT_EQ(one.of(e), other.of(e));
    }
  }
}

TEST(State, AttributesThatAreLoadedGoOnAsThoseThatWereSaved) {
  const fake::Model model(fake::everything());
  int strangers = 0;
  for (int round = 0; round < 60; ++round) {
    Random random;
    const FakeBody body({3 + static_cast<Index>(random() % 3), 3, 4}, &random,
                        round % 2 == 0 ? 0.2 : 4e-15);
    const Regions regions = random_regions(body, random);
    Simulated one(model, body, regions), twin(model, body, regions);
    const std::uint64_t seed = random();
    if (round % 4 < 2) {
      one.mark(seed);
      twin.mark(seed);  // as the scene does
    }
    std::mt19937 choice(static_cast<unsigned>(random()));
    Operations operations(choice);
    for (int before = round % 10; before > 0; --before) one.apply(operations.next(one.complex));
    one.move(random());
    twin.move(3);
    load_state(state_of(one), twin);
    ASSERT_EQ(difference_of_states(one, twin), "");
    expect_same(one, twin);
    if (HasFatalFailure()) return;
    strangers += one.attributes.rest_places(one.complex).own().empty() ? 0 : 1;
    for (int after = 0; after < 6; ++after) {
      const Request request = operations.next(one.complex);
      one.apply(request);
      twin.apply(request);
      ASSERT_EQ(difference_of_states(one, twin), "") << "operation " << after;
      const std::uint64_t moves = random();
      one.move(moves);
      twin.move(moves);
      one.attributes.accept_trials();
      twin.attributes.accept_trials();
      expect_same(one, twin);
      if (HasFatalFailure()) return;
    }
    ASSERT_EQ(difference_of_states(one, twin), "");
  }
  EXPECT_GT(strangers, 0) << "no element was saved with a rest shape of its own";
}

// What operations do not change of element columns is not saved.
TEST(State, OfAnotherRegionIsRefused) {
  const fake::Model model(fake::everything());
  const FakeBody body({3, 3, 3});
  Simulated one(model, body, {{0, 1, 2}}), other(model, body, {{0, 1, 2, 3}});
  one.apply({Operation::Kind::pierce, {}, {20}, {}});
  EXPECT_EQ(refusal_of(state_of(one.attributes), other.attributes),
            "/instances/0/tables/3: a column has a different number of rows");
}

TEST(State, OfAColumnReportsWhetherItIsTheSameEverywhere) {
  ColumnSpec spec;
  spec.components = 2;
  spec.initial = 5;
  Column one(spec, 1), twin(spec, 1);
  one.resize(20);
  twin.resize(12);
  const StateTree constant = state_of(one);
  load_state(constant, twin);
  EXPECT_TRUE(twin.is_constant());
  EXPECT_EQ(twin.size(), 20u);
  one.set(13, 1, 7);
  load_state(state_of(one), twin);
  EXPECT_FALSE(twin.is_constant());
  EXPECT_EQ(twin.get(13, 1), 7);
  EXPECT_EQ(difference_of_states(one, twin), "");
  EXPECT_EQ(refusal_of(constant, twin), "/: only one of the two columns is constant");
}

TEST(State, OfAColumnWithoutValuesForItsRowsIsRefusedBeforeThereIsRoomForThem) {
  ColumnSpec spec;
  spec.components = 3;
  Column one(spec, 1), twin(spec, 1);
  one.resize(20);
  one.set(13, 1, 7);
  StateTree tree = state_of(one);
  overwrite(tree, "rows", 0, Index{0xfffffff0});
  EXPECT_EQ(refusal_of(tree, twin), "/: the column has a different number of rows");
}

/// The accepted values of all columns that have a trial copy.
std::vector<double> states_of(const Attributes& attributes) {
  std::vector<double> values;
  for (const auto& instance : attributes.instances())
    for (int d = 0; d < 4; ++d)
      for (const Column& column : instance->table(d).columns)
        for (Index row = 0; row < column.size() && column.has_trial(); ++row)
          for (int c = 0; c < column.spec().components; ++c) values.push_back(column.get(row, c));
  return values;
}

TEST(State, AStateToGoBackToHasTheMotionAndTheStatesOfModels) {
  const fake::Model model(fake::everything());
  Random random;
  const FakeBody body({12, 16, 20}, &random);  // more than one part
  Simulated one(model, body, {{}});
  one.apply({Operation::Kind::pierce, {}, {3, 7}, {}});
  one.move(3);
  const StateTree before = state_of(one);
  StateBuffer buffer;
  buffer.save(one.attributes);
  one.move(4);
  EXPECT_NE(difference(before, state_of(one)), "");
  buffer.load(one.attributes);
  for (Column& column : one.attributes.instances()[0]->table(2).columns)
    if (column.has_trial()) {  // what trials are does not matter then
      column.accept();
      column.accept();
    }
  const StateTree after = state_of(one);
  const auto motion = [](const StateTree& tree) {
    return &tree.groups.at("attributes").groups.at("motion").arrays.at("0");
  };
  ASSERT_EQ(motion(before)->size(), motion(after)->size());
  EXPECT_EQ(
      std::memcmp(motion(before)->bytes.get(), motion(after)->bytes.get(), motion(before)->size()),
      0);
  const std::vector<double> found = states_of(one.attributes);
  Simulated twin(model, body, {{}});
  load_state(before, twin);
  EXPECT_EQ(states_of(twin.attributes), found);
}

TEST(State, OfABodyWithoutOperationsLeavesOutWhatIsBuiltAgain) {
  const fake::Model model(fake::everything());
  const FakeBody body({6, 6, 6});
  Simulated one(model, body, {{}});
  const std::size_t vertices = body.rest.size();
  const Column& memory = one.attributes.instances()[0]->table(2).columns.back();
  const std::size_t states = memory.block_count() * 8 * 2 * 8 * 2;
  EXPECT_LT(state_of(one.attributes).bytes(), 48 * vertices + states + 1500);
}

TEST(State, OfOtherModelsOrMeshesIsRefused) {
  const fake::Model model(fake::everything());
  auto fewer = fake::everything(), other = fewer;
  fewer.erase(fewer.begin() + fake::plain);
  other[fake::edge].components = 1;
  fake::contribute_by(other[fake::edge], &fake::contribute<12, 1>);
  const fake::Model without(fewer), narrow(other);
  fake::Model fresh(fake::everything());
  fresh.table.id = "foreign";
  const FakeBody body({3, 3, 3});
  Simulated one(model, body, {{}});
  for (const bool operated : {false, true}) {
    if (operated) one.apply({Operation::Kind::pierce, {}, {3}, {}});
    const StateTree tree = state_of(one.attributes);
    Simulated lacks(without, body, {{}}), smaller(narrow, body, {{}}), foreign(fresh, body, {{}});
    EXPECT_EQ(refusal_of(tree, lacks.attributes),
              "/instances/0/tables/1: model 'body' (fake) had other columns of dimension 1: edge "
              "(2), plain (1); now: edge (2)");
    EXPECT_EQ(refusal_of(tree, smaller.attributes),
              "/instances/0/tables/1: model 'body' (fake) had other columns of dimension 1: edge "
              "(2), plain (1); now: edge (1), plain (1)");
    Simulated larger(model, FakeBody({3, 3, 4}), {{}}), line(model, FakeBody({9, 3, 1}), {{}}),
        two(model, body, {{}, {}}), part(model, body, {{0, 1, 2}});
    if (!operated) {  // afterwards the map reports it
      EXPECT_EQ(refusal_of(tree, larger.attributes), "/motion: the number of vertices differs");
      EXPECT_EQ(refusal_of(tree, line.attributes), "/motion: the number of vertices differs");
    }
    EXPECT_EQ(refusal_of(tree, two.attributes),
              "/instances: the number of items differs from this run");
    if (operated) {
      EXPECT_EQ(refusal_of(tree, part.attributes),
                "/instances/0/tables/0/cells: the cells of the region differ");
    }
    EXPECT_EQ(refusal_of(tree, foreign.attributes),
              "/instances/0: the state belongs to model 'body' (fake), but this is model 'body' "
              "(foreign)");
    EXPECT_EQ(refusal_of(tree, one.attributes),
              operated ? "/: operations have already been applied to this body" : "");
  }
}

}  // namespace
}  // namespace suture
