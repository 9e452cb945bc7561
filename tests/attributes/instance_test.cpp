// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/instance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <limits>
#include <thread>

#include "kernel/attributes/attributes.hpp"
#include "kernel/base/error.hpp"
#include "kernel/mesh/box.hpp"
#include "tests/attributes/fake_models.hpp"

namespace suture {
namespace {

std::string message_of(const auto& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Instance, PreparesTheModelsOwnMemory) {
  fake::Model model({});
  model.table.instance_bytes = 3 * sizeof(double);
  model.table.prepare = [](const suture_context* context, void* instance) -> suture_status {
    auto* values = static_cast<double*>(instance);
    if (reinterpret_cast<std::uintptr_t>(instance) % SUTURE_ALIGNMENT != 0) return SUTURE_STOP;
    if (values[0] != 0 || values[2] != 0 || context->instance != instance) return SUTURE_STOP;
    values[2] = 2 * context->parameters[0];
    return SUTURE_OK;
  };
  Diagnostics diagnostics;
  Instance instance(model.table, "a", {21}, diagnostics);
  instance.set_workers(3);
  for (unsigned w = 0; w < 3; ++w)
    EXPECT_EQ(static_cast<const double*>(instance.context(w).instance)[2], 42);
  EXPECT_NE(instance.context(0).error, instance.context(2).error);
  EXPECT_EQ(instance.context(1).host->has_extension(SUTURE_INSPECT_1), 1);
  EXPECT_EQ(instance.context(1).host->has_extension("suture.nothing/1"), 0);
}

TEST(Instance, AFailedPreparationIsAPluginErrorWithItsText) {
  fake::Model model({});
  model.table.prepare = [](const suture_context* context, void*) -> suture_status {
    std::snprintf(context->error->text, sizeof(context->error->text), "no table for nu");
    return SUTURE_STOP;
  };
  Diagnostics diagnostics;
  EXPECT_THROW(Instance(model.table, "a", {1}, diagnostics), PluginError);
  const std::string text = message_of([&] { Instance(model.table, "a", {1}, diagnostics); });
  EXPECT_NE(text.find("model 'a' (fake)"), std::string::npos) << text;
  EXPECT_NE(text.find("no table for nu"), std::string::npos) << text;
}

TEST(Instance, AReportedErrorRefusesTheScene) {
  fake::Model model({});
  model.table.prepare = [](const suture_context* context, void*) -> suture_status {
    context->host->report(context, SUTURE_ERROR, UINT32_MAX, "nu", "nu = 0.5 is not admitted");
    context->host->report(context, SUTURE_WARNING, UINT32_MAX, "E", "E is small");
    return SUTURE_OK;
  };
  Diagnostics diagnostics;
  EXPECT_THROW(Instance(model.table, "a", {1}, diagnostics), InputError);
  EXPECT_EQ(diagnostics.warnings(), std::vector<std::string>{"model 'a' (fake): E is small"});
}

TEST(Instance, RefusesOtherThanTheDeclaredParameters) {
  Diagnostics diagnostics;
  const fake::Model model({});
  EXPECT_THROW(Instance(model.table, "a", {1, 2}, diagnostics), PluginError);
}

/// Gives each vertex the parameter of its element.
suture_status give_parameter(const suture_context*, const suture_batch* batch, double* out) {
  for (int k = 0; k < 8; ++k)
    for (int lane = 0; lane < 8; ++lane) out[k * 8 + lane] = batch->cell_columns[0][lane];
  return SUTURE_OK;
}

TEST(Instance, FillsColumnsWithWhatIsGivenAndHandsParametersToContributions) {
  fake::Model model({fake::attribute("rho", 3, 1, nullptr, SUTURE_COPY, SUTURE_PARAMETER),
                     fake::attribute("sum", 0, 1, &give_parameter),
                     fake::attribute("pull", 0, 2, nullptr, SUTURE_COPY, 0, 3),
                     fake::attribute("wear", 3, 1, nullptr, SUTURE_COPY, SUTURE_TRIAL)});
  model.parameters.flags = SUTURE_PER_ELEMENT;
  const double differs = std::numeric_limits<double>::quiet_NaN();
  BoxOptions box;
  box.cells = {3, 1, 1};
  const Mesh mesh = make_box(box);
  CellComplex complex(mesh.hexahedra, 16);
  Attributes attributes(complex, mesh.points);
  std::vector<double> pulls;
  for (int v = 0; v < 32; ++v) pulls.push_back(v);
  Diagnostics diagnostics;
  // The region leaves out the first element.
  const Instance& instance = attributes.add(
      std::make_unique<Instance>(
          model.table, "a", std::vector{differs}, diagnostics, true,
          std::vector<GivenColumn>{{0, true, {-1, 10, 200}}, {2, true, pulls}, {3, false, {5}}}),
      complex, {1, 2});
  attributes.initialise(complex, diagnostics);
  const auto row = [&](int dimension, Index cell) {
    return instance.table(dimension).cells.row(cell);
  };
  EXPECT_EQ(instance.column(0)->get(row(3, 1), 0), 10);
  EXPECT_EQ(instance.column(0)->get(row(3, 2), 0), 200);
  EXPECT_EQ(instance.column(3)->get(row(3, 2), 0), 5);
  for (const Index element : {1, 2})
    for (const Index v : complex.vertices_of(element)) {
      const bool first = std::ranges::count(complex.vertices_of(1), v) != 0;
      const bool second = std::ranges::count(complex.vertices_of(2), v) != 0;
      EXPECT_EQ(instance.column(1)->get(row(0, v), 0), 10 * first + 200 * second);
      EXPECT_EQ(instance.column(2)->get(row(0, v), 1), 2 * v + 1);
    }
  EXPECT_EQ(instance.columns_given_by_cell().size(), 2u);

  const Instance& uniform = attributes.add(
      std::make_unique<Instance>(model.table, "b", std::vector{7.0}, diagnostics), complex, {});
  EXPECT_TRUE(uniform.column(0)->is_constant());
  EXPECT_EQ(uniform.column(0)->get(0, 0), 7);
}

TEST(Findings, AreSaidOncePerKeyWhateverTheThreadsDid) {
  Findings findings;
  std::vector<std::thread> threads;
  for (Index t = 0; t < 4; ++t)
    threads.emplace_back([&findings, t] {
      for (Index cell = t; cell < 1000; cell += 4) {
        findings.add(SUTURE_WARNING, 999 - cell, "thin",
                     "element " + std::to_string(999 - cell) + " is thin");
        if (cell % 100 == 0) findings.add(SUTURE_NOTE, cell, "odd", "an odd cell");
      }
    });
  for (std::thread& thread : threads) thread.join();
  Diagnostics diagnostics;
  findings.deliver("model 'a'", diagnostics);
  EXPECT_EQ(diagnostics.warnings(),
            std::vector<std::string>{"model 'a': element 0 is thin [thin: 1000 cells, first 0]"});
  EXPECT_EQ(diagnostics.notes(),
            std::vector<std::string>{"model 'a': an odd cell [odd: 10 cells, first 0]"});
  findings.deliver("model 'a'", diagnostics);
  EXPECT_EQ(diagnostics.warnings().size(), 1u);
}

/// A row of three elements, the second of them no parallelepiped.
struct Row {
  CellComplex complex;
  std::vector<Vec3> rest;
  Row() {
    BoxOptions box;
    box.cells = {3, 1, 1};
    box.size = {3, 1, 1};
    Mesh mesh = make_box(box);
    rest = mesh.points;
    rest[mesh.hexahedra[1][6]][2] += 0.25;  // X6 of the second: shared with X7 of the first
    complex = CellComplex(mesh.hexahedra, static_cast<Index>(rest.size()));
  }
};

suture_functor functor(std::uint32_t dimension, std::uint32_t shape) {
  suture_functor f{};
  f.size = sizeof(f);
  f.dimension = dimension;
  f.shape = shape;
  f.lanes = SUTURE_LANES;
  f.name = "f";
  return f;
}

TEST(Instance, OrdersParallelepipedsFirstIfAFunctorAsks) {
  Row row;
  const fake::Model asks({}, {functor(3, SUTURE_PARALLELEPIPED), functor(3, SUTURE_GENERAL)});
  const fake::Model does_not({}, {functor(3, SUTURE_ANY_SHAPE)});
  Diagnostics diagnostics;
  Attributes attributes(row.complex, row.rest);
  Instance& ordered = attributes.add(
      std::make_unique<Instance>(asks.table, "a", std::vector{1.0}, diagnostics), row.complex, {});
  EXPECT_EQ(ordered.general_begin, 1u);
  EXPECT_EQ(ordered.table(3).cells.cell(0), 2u);
  EXPECT_EQ(ordered.table(3).cells.cell(1), 0u);
  EXPECT_EQ(ordered.table(3).cells.cell(2), 1u);
  Instance& plain =
      attributes.add(std::make_unique<Instance>(does_not.table, "b", std::vector{1.0}, diagnostics),
                     row.complex, {});
  EXPECT_TRUE(plain.table(3).cells.is_all());
  EXPECT_EQ(plain.general_begin, 3u);
}

/// Reports every element it is shown, and checks what the batch holds.
suture_status inspect_elements(const suture_context* context, const suture_batch* batch) {
  for (std::uint32_t lane = 0; lane < batch->valid; ++lane) {
    char text[80];
    std::snprintf(text, sizeof text, "element %u of value %g", batch->cell_ids[lane],
                  batch->cell_columns[0][lane]);
    context->host->report(context, SUTURE_WARNING, batch->cell_ids[lane], "seen", text);
  }
  const bool whole = batch->nodes == 8 && batch->rest == batch->position && batch->velocity[0] == 0;
  return whole ? SUTURE_OK : SUTURE_STOP;
}

TEST(Instance, InspectsTheCellsOfAFunctorWithTheNumbersOfTheUser) {
  Row row;
  static const suture_inspect_1 extension = {sizeof(suture_inspect_1), 0, &inspect_elements};
  static const std::uint32_t columns[] = {0};
  suture_functor general = functor(3, SUTURE_GENERAL);
  general.cell_columns = columns;
  general.cell_column_count = 1;
  general.extension = [](const char* id) -> const void* {
    return std::strcmp(id, SUTURE_INSPECT_1) == 0 ? &extension : nullptr;
  };
  const fake::Model model({fake::attribute("v", 3, 1, nullptr, SUTURE_COPY, 0, 2.5)}, {general});
  Diagnostics diagnostics;
  Attributes attributes(row.complex, row.rest);
  const std::vector<Index> numbers{70, 60, 50};
  attributes.user_element = numbers;
  attributes.add(std::make_unique<Instance>(model.table, "a", std::vector{1.0}, diagnostics),
                 row.complex, {});
  attributes.initialise(row.complex, diagnostics);
  EXPECT_EQ(diagnostics.warnings(),
            std::vector<std::string>{
                "model 'a' (fake): element 60 of value 2.5 [seen: 2 cells, first 60]"});
}

TEST(Instance, AContributionThatFailsOrIsNotFiniteNamesTheElement) {
  Row row;
  const fake::Model fails({fake::attribute(
      "k", 1, 1,
      [](const suture_context* context, const suture_batch* batch, double*) -> suture_status {
        context->error->cell = batch->cell_ids[1];
        std::snprintf(context->error->text, sizeof(context->error->text), "too flat");
        return SUTURE_STOP;
      })});
  const fake::Model not_finite({fake::attribute(
      "k", 1, 1, [](const suture_context*, const suture_batch*, double* out) -> suture_status {
        for (int i = 0; i < 12 * 8; ++i) out[i] = i == 8 ? NAN : 1;
        return SUTURE_OK;
      })});
  const auto start = [&](const fake::Model& model) {
    Diagnostics diagnostics;
    Attributes attributes(row.complex, row.rest);
    attributes.add(std::make_unique<Instance>(model.table, "a", std::vector{1.0}, diagnostics),
                   row.complex, {});
    attributes.initialise(row.complex, diagnostics);
  };
  EXPECT_THROW(start(fails), InputError);
  EXPECT_THROW(start(not_finite), PluginError);
  EXPECT_NE(message_of([&] { start(fails); }).find("attribute 'k' at element 1: too flat"),
            std::string::npos);
  EXPECT_NE(message_of([&] { start(not_finite); }).find("element 0 gives nan"), std::string::npos);
}

}  // namespace
}  // namespace suture
