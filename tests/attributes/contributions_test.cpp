// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/contributions.hpp"

#include <cstdio>
#include <limits>

#include "kernel/base/error.hpp"
#include "tests/attributes/bodies.hpp"

namespace suture {
namespace {

/// A model on a random body, its columns summed.
struct Summed {
  Summed(const fake::Model& model, std::array<Index, 3> cells, Random* random)
      : body(cells, random), attributes(body.complex, body.rest) {
    instance = &add(attributes, body.complex, model.table, {}, 3);
    initialise(attributes, body.complex);
  }
  RestBatch batch(std::span<const Index> numbers = {}) {
    return RestBatch(attributes.rest_places(body.complex), numbers);
  }
  FakeBody body;
  Attributes attributes;
  Instance* instance = nullptr;
};

TEST(RestBatch, HoldsCornersLaneByLaneAndRepeatsTheLast) {
  Random random(1);
  const fake::Model model(fake::everything());
  Summed s(model, {3, 2, 1}, &random);
  const std::vector<Index> elements{4, 1, 2}, numbers{10, 11, 12, 13, 14, 15};
  RestBatch rest = s.batch(numbers);
  const suture_batch& batch = rest.gather(*s.instance, elements);
  EXPECT_EQ(batch.valid, 3u);
  EXPECT_EQ(batch.nodes, 8u);
  for (Index lane = 0; lane < 8; ++lane) {
    const Index e = elements[std::min(lane, 2u)];
    EXPECT_EQ(batch.cell_ids[lane], 10 + e);
    for (std::size_t n = 0; n < 8; ++n)
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_EQ(batch.rest[(n * 3 + c) * 8 + lane],
                  s.body.rest[s.body.complex.vertices_of(e)[n]][c]);
  }
  RestBatch plain = s.batch();
  EXPECT_EQ(plain.gather(*s.instance, elements).cell_ids[1], 1u);
}

suture_status refuses(const suture_context* context, const suture_batch* batch, double*) {
  context->error->cell = batch->cell_ids[1];
  std::snprintf(context->error->text, sizeof context->error->text, "it is flat");
  return SUTURE_STOP;
}

TEST(Contribute, ARefusalNamesTheModelTheAttributeAndTheElement) {
  fake::Model model(fake::everything());
  Summed s(model, {2, 1, 1}, nullptr);
  suture_attribute bad = model.attributes[fake::edge];
  fake::contribute_by(bad, refuses);
  const std::vector<Index> elements{0, 1}, numbers{70, 71};
  RestBatch rest = s.batch(numbers);
  std::vector<double> out(12 * 2 * 8);
  try {
    contribute(*s.instance, bad, rest.gather(*s.instance, elements), out.data());
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              s.instance->title() + ": attribute 'edge' at element 71: it is flat");
  }
}

suture_status gives_minus_one(const suture_context*, const suture_batch*, double* out) {
  for (int i = 0; i < 8 * 8; ++i) out[i] = i == 3 * 8 + 1 ? -1 : 1;
  return SUTURE_OK;
}
suture_status gives_infinity(const suture_context*, const suture_batch*, double* out) {
  for (int i = 0; i < 8 * 8; ++i) out[i] = std::numeric_limits<double>::infinity();
  return SUTURE_OK;
}

TEST(Contribute, ValuesThatAreNotFiniteAndNegativeMassesAreRefusedWithTheirElement) {
  const fake::Model model(fake::everything());
  Summed s(model, {2, 1, 1}, nullptr);
  suture_attribute mass = fake::attribute("mass", 0, 1, &gives_minus_one, SUTURE_FROM_VOLUMES, 0);
  const std::vector<Index> elements{0, 1}, numbers{70, 71};
  RestBatch rest = s.batch(numbers);
  std::vector<double> out(8 * 8);
  const auto message = [&] {
    try {
      contribute(*s.instance, mass, rest.gather(*s.instance, elements), out.data());
      return std::string();
    } catch (const PluginError& error) {
      return std::string(error.what());
    }
  };
  EXPECT_EQ(message(), "");
  mass.flags = SUTURE_SHARED_MASS;
  EXPECT_NE(
      message().find("attribute 'mass', contribution of elements 70, 71: element 71 gives -1"),
      std::string::npos)
      << message();
  fake::contribute_by(mass, gives_infinity);
  mass.flags = 0;
  EXPECT_NE(message().find("element 70 gives inf"), std::string::npos) << message();
}

TEST(UniformContribution, OneElementSpeaksForAllThatGiveTheSame) {
  const fake::Model model(
      {fake::attribute("mass", 0, 1, &fake::box_mass, SUTURE_FROM_VOLUMES, SUTURE_SHARED_MASS)});
  const suture_attribute& mass = model.attributes[0];
  Summed cubes(model, {5, 3, 2}, nullptr);
  RestBatch rest = cubes.batch();
  const auto uniform = uniform_contribution(*cubes.instance, mass, cubes.body.complex, rest, 1e-12);
  EXPECT_EQ(uniform, std::vector<double>(8, 3.0 / 8));
  // One vertex moved by a thousandth, in the last of all elements.
  FakeBody other({5, 3, 2});
  other.rest[other.complex.vertices_of(29)[1]][0] += 1e-3;
  Attributes attributes(other.complex, other.rest);
  Instance& instance = add(attributes, other.complex, model.table, {}, 3);
  initialise(attributes, other.complex);
  RestBatch moved(attributes.rest_places(other.complex), {});
  EXPECT_TRUE(uniform_contribution(instance, mass, other.complex, moved, 1e-4).empty());
  EXPECT_EQ(uniform_contribution(instance, mass, other.complex, moved, 1e-2).size(), 8u);
}

// The closed form, from the functor and from uniform values: rho V / 8 per corner.
TEST(Sums, OfABoxAreItsMassAtEveryVertex) {
  const fake::Model model(
      {fake::attribute("mass", 0, 1, &fake::box_mass, SUTURE_FROM_VOLUMES, SUTURE_SHARED_MASS)});
  Summed s(model, {4, 3, 2}, nullptr);
  const std::vector<double> given(8, 3.0 / 8);
  for (const bool uniform : {false, true}) {
    RestBatch rest = s.batch();
    Column& mass = s.attributes.mass();
    std::fill_n(mass.rows(), mass.size(), 1.0);  // sums are added to what is there
    sum_contributions(*s.instance, model.attributes[0], s.body.complex, rest,
                      s.attributes.kernel(0).cells, mass,
                      uniform ? std::span<const double>(given) : std::span<const double>());
    for (Index v = 0; v < mass.size(); ++v) {
      std::vector<Dart> star;
      s.body.complex.star(0, v, star);
      EXPECT_NEAR(mass.get(v, 0), 1 + 3.0 / 8 * static_cast<double>(star.size()), 1e-14) << v;
    }
  }
}

/// Every touched row is what a sum over the whole body gives, the others are left alone.
void expect_sums_again(Summed& s, TouchedSums& touched, const TopologyChange& change) {
  Attributes fresh(s.body.complex, rest_of(s.attributes));
  add(fresh, s.body.complex, s.instance->model(), {}, 3);
  initialise(fresh, s.body.complex);
  RestBatch rest = s.batch();
  for (const Index v : change.stars[0].cells) s.attributes.mass().set(v, 0, 0);
  for (const Index cell : change.stars[1].cells) {  // whatever stood there
    const Index row = s.instance->table(1).cells.row(cell);
    if (row != none) s.instance->column(fake::edge)->set(row, 0, -5);
  }
  touched.sum(*s.instance, s.body.complex, rest, change);
  touched.clear(change);
  for (Index v = 0; v < s.attributes.vertex_count(); ++v)
    ASSERT_EQ(s.attributes.mass().get(v, 0), fresh.mass().get(v, 0)) << v;
  const CellSet &here = s.instance->table(1).cells, &there = fresh.instances()[0]->table(1).cells;
  for (Index row = 0; row < here.size(); ++row)
    for (int c = 0; c < 2 && here.is_live(row); ++c)
      ASSERT_EQ(s.instance->column(fake::edge)->get(row, c),
                fresh.instances()[0]->column(fake::edge)->get(there.row(here.cell(row)), c));
}

TEST(TouchedSums, GiveTheBitsOfASumOverAllElements) {
  Random random;
  const fake::Model model(fake::everything());
  Summed s(model, {6, 5, 4}, &random);
  TouchedSums touched;
  touched.reserve(s.body.complex);
  for (int round = 0; round < 6; ++round) {
    const TopologyChange change =
        round % 2 == 0
            ? s.body.complex.cut(random_faces(s.body.complex, random, 0.1))
            : s.body.complex.pierce(std::array<Index, 1>{static_cast<Index>(17 * round)});
    s.attributes.apply(s.body.complex, change);
    expect_sums_again(s, touched, change);
  }
}

TEST(TouchedSums, TakeUniformValuesUntilTheyDiffer) {
  const fake::Model model(fake::everything());
  Summed s(model, {3, 3, 3}, nullptr);
  const suture_attribute& mass = model.attributes[fake::mass];
  TouchedSums touched;
  EXPECT_EQ(touched.keep_uniform(*s.instance, mass, std::vector<double>(8, 2)).size(), 8u);
  const TopologyChange change = s.body.complex.pierce(std::array<Index, 1>{13});  // the middle
  s.attributes.apply(s.body.complex, change);
  const auto sum = [&](Index v) {
    for (const Index w : change.stars[0].cells) s.attributes.mass().set(w, 0, 1);  // of another
    RestBatch rest = s.batch();
    touched.sum(*s.instance, s.body.complex, rest, change);
    touched.clear(change);
    return s.attributes.mass().get(v, 0);
  };
  ASSERT_EQ(change.stars[0].cells.size(), 8u);
  const Index v = change.stars[0].cells[0];
  EXPECT_EQ(sum(v), 1 + 7 * 2.0);
  EXPECT_TRUE(touched.keep_uniform(*s.instance, mass, {}).empty());
  EXPECT_NE(sum(v), 1 + 7 * 2.0) << "asked again";
}

}  // namespace
}  // namespace suture
