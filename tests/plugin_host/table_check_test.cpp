// SPDX-License-Identifier: GPL-3.0-or-later
// One change at a time to a valid table, and the single sentence that it must produce.
#include "kernel/plugin_host/table_check.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>
#include <numeric>
#include <span>

#include "kernel/plugin_host/table_copy.hpp"
#include "tests/plugin_host/change_case.hpp"

namespace suture {
namespace {

/// A plugin with two models that uses every kind of entry.
struct Tables {
  static suture_status force(const suture_context*, const suture_batch*) { return SUTURE_OK; }
  static suture_status sum(const suture_context*, const suture_batch*, double*) {
    return SUTURE_OK;
  }
  static suture_status prepare(const suture_context*, void*) { return SUTURE_OK; }

  const char* choices[2] = {"clamp", "keep"};
  suture_parameter parameters[2] = {
      {sizeof(suture_parameter), SUTURE_NUMBER, SUTURE_MINIMUM_EXCLUDED, 0, "E", "Pa",
       "Young's modulus.", 1e5, 0, std::numeric_limits<double>::infinity(), nullptr},
      {sizeof(suture_parameter), SUTURE_CHOICE, 0, 2, "mode", "1", "What to do.", 1, 0, 0,
       choices}};
  suture_contribution sums[2] = {{sizeof(suture_contribution), SUTURE_HEXAHEDRON, sum},
                                 {sizeof(suture_contribution), SUTURE_HEXAHEDRON, sum}};
  suture_attribute attributes[3] = {{sizeof(suture_attribute), 0, 1, SUTURE_FROM_VOLUMES,
                                     SUTURE_SHARED_MASS, 1, "mass", "kg", "Lumped.", 0, sums, 0, 0},
                                    {sizeof(suture_attribute), 1, 1, SUTURE_FROM_VOLUMES,
                                     SUTURE_OUTPUT, 1, "k", "N/m", "Stiffness.", 0, sums, 0, 0},
                                    {sizeof(suture_attribute), 0, 3, SUTURE_COPY, SUTURE_TRIAL, 0,
                                     "pull", "N", "A load.", 0, nullptr, 0, 0}};
  std::uint32_t cell_columns[1] = {1};
  std::uint32_t vertex_columns[2] = {2, UINT32_MAX};
  suture_functor functors[1] = {{sizeof(suture_functor),
                                 1,
                                 SUTURE_EDGE,
                                 0,
                                 0,
                                 8,
                                 0,
                                 SUTURE_READ_POSITION,
                                 1,
                                 2,
                                 0,
                                 0,
                                 cell_columns,
                                 vertex_columns,
                                 "edges",
                                 "Springs.",
                                 force,
                                 nullptr,
                                 nullptr,
                                 0,
                                 0}};
  suture_model models[2] = {{sizeof(suture_model), 0, "mass-springs", "Springs.", "f = k u", "none",
                             2, 3, 1, 0, parameters, attributes, functors, prepare, 64, nullptr},
                            {sizeof(suture_model), 0, "other", "Springs.", "f = k u", "none", 2, 3,
                             1, 0, parameters, attributes, functors, nullptr, 0, nullptr}};
  const char* extensions[1] = {SUTURE_ENERGY_1};
  suture_plugin plugin{sizeof(suture_plugin),
                       SUTURE_MAGIC,
                       SUTURE_ABI_MAJOR,
                       SUTURE_ABI_MINOR,
                       8,
                       1,
                       "springs",
                       "1.0",
                       "MIT",
                       "Springs.",
                       models,
                       1,
                       0,
                       extensions};
};

std::string joined(const std::vector<std::string>& lines) {
  return std::accumulate(lines.begin(), lines.end(), std::string(),
                         [](const std::string& all, const std::string& line) {
                           return all + (all.empty() ? "" : "\n") + line;
                         });
}

std::vector<std::string> problems_of(const suture_plugin& plugin) {
  std::vector<std::string> problems;
  const auto copy = copy_tables(plugin, problems);
  return problems.empty() ? table_problems(copy->plugin) : problems;
}

std::string problems_with(const std::function<void(Tables&)>& change) {
  Tables tables;
  change(tables);
  return joined(problems_of(tables.plugin));
}

TEST(TableCheck, AGoodTableHasNoProblem) {
  EXPECT_EQ(problems_with([](Tables&) {}), "");
  EXPECT_EQ(problems_with([](Tables& t) { t.plugin.model_count = 2; }), "");
}

using TableCase = ChangeCase<Tables>;

class TableCheckCase : public ::testing::TestWithParam<TableCase> {};

TEST_P(TableCheckCase, NamesModelEntryAndFault) {
  EXPECT_EQ(problems_with(GetParam().change), GetParam().expected);
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

#define MODEL "model 'mass-springs'"
const TableCase plugin_cases[] = {
    {"Size", [](Tables& t) { t.plugin.size = 8; },
     "its member size is 8, expected 80 (first member of every struct: sizeof)"},
    {"Magic", [](Tables& t) { t.plugin.magic = 1; }, "its magic number is wrong"},
    {"Major", [](Tables& t) { t.plugin.abi_major = 2; }, "its table says ABI 2.0"},
    {"Id", [](Tables& t) { t.plugin.id = "My Plugin"; },
     "its id is 'My Plugin'; expected lower-case letters, digits and '-', a letter first"},
    {"NullVersion", [](Tables& t) { t.plugin.version = nullptr; }, "version is NULL"},
    {"NoModels", [](Tables& t) { t.plugin.model_count = 0; }, "has no model"},
    {"NullModels", [](Tables& t) { t.plugin.models = nullptr; },
     "models is NULL, but its count is 1"},
    {"TwoModels",
     [](Tables& t) {
       t.plugin.model_count = 2;
       t.models[1].id = "mass-springs";
     },
     MODEL ": the id occurs twice"},
    {"Extension", [](Tables& t) { t.extensions[0] = "suture.energi/1"; },
     "requires the host's extension 'suture.energi/1', which this Suture does not have (did you "
     "mean 'suture.energy/1'?); use a newer Suture"},
    {"ModelSize", [](Tables& t) { t.models[0].size += 8; },
     "model 0: its member size is 112, expected 104 (first member of every struct: sizeof)"},
    {"ModelId", [](Tables& t) { t.models[0].id = nullptr; },
     "model 0: its id is NULL; expected lower-case letters, digits and '-', a letter first"},
    {"NullFormula", [](Tables& t) { t.models[0].formula = nullptr; }, MODEL ": formula is NULL"},
    {"ModelFlags", [](Tables& t) { t.models[0].flags = 128; }, MODEL ": flags has unknown bits"},
    {"InstanceWithoutPrepare", [](Tables& t) { t.models[0].prepare = nullptr; },
     MODEL ": requests instance_bytes, but has no function prepare to fill them"},
    {"NoFunctor", [](Tables& t) { t.models[0].functor_count = 0; }, MODEL ": has no functor"},
    {"DamagedCount", [](Tables& t) { t.models[0].parameter_count = 0xDEADBEEF; },
     MODEL ": the count of parameters is 3735928559, at most 4096"},
};

const TableCase parameter_cases[] = {
    {"Twice", [](Tables& t) { t.parameters[1].name = "E"; },
     MODEL ", parameter 'E': the name occurs twice"},
    {"NullName", [](Tables& t) { t.parameters[0].name = nullptr; },
     MODEL ", parameter 0: its name is not a letter followed by letters, digits and '_'"},
    {"NullUnit", [](Tables& t) { t.parameters[0].unit = nullptr; },
     MODEL ", parameter 'E': unit is NULL"},
    {"Type", [](Tables& t) { t.parameters[0].type = 9; },
     MODEL ", parameter 'E': type is 9, the last known value is 4"},
    {"EmptyRange", [](Tables& t) { t.parameters[0].maximum = -1; },
     MODEL ", parameter 'E': its range from 0 to -1 is empty\n" MODEL
           ", parameter 'E': its default 100000 is outside its range from 0 to -1"},
    {"RangeOfNan",
     [](Tables& t) {
       t.parameters[0].minimum = nan;
       t.parameters[0].flags = SUTURE_REQUIRED;
     },
     MODEL ", parameter 'E': its range from nan to inf is empty"},
    {"DefaultExcluded", [](Tables& t) { t.parameters[0].default_value = 0; },
     MODEL ", parameter 'E': its default 0 is outside its range from 0 to inf"},
    {"DefaultNan", [](Tables& t) { t.parameters[0].default_value = nan; },
     MODEL ", parameter 'E': its default nan is outside its range from 0 to inf"},
    {"Integer",
     [](Tables& t) {
       t.parameters[0].type = SUTURE_INTEGER;
       t.parameters[0].default_value = 1.5;
     },
     MODEL ", parameter 'E': its default 1.5 is not an integer"},
    {"Boolean",
     [](Tables& t) {
       t.parameters[0].type = SUTURE_BOOLEAN;
       t.parameters[0].default_value = 2;
     },
     MODEL ", parameter 'E': its default 2 is neither 0 nor 1"},
    {"ChoiceTwice", [](Tables& t) { t.choices[1] = "clamp"; },
     MODEL ", parameter 'mode', choice 'clamp': the choice occurs twice"},
    {"ChoiceNull", [](Tables& t) { t.choices[0] = nullptr; },
     MODEL ", parameter 'mode': choice 0 is empty or NULL"},
    {"ChoiceDefault", [](Tables& t) { t.parameters[1].default_value = 2; },
     MODEL ", parameter 'mode': its default 2 is not an index into its choices"},
    {"ChoicesOfNumber", [](Tables& t) { t.parameters[1].type = SUTURE_BOOLEAN; },
     MODEL ", parameter 'mode': has choices, but its type is not SUTURE_CHOICE"},
};

/// E may differ from element to element; its values are in the third attribute.
void vary(Tables& t) {
  t.parameters[0].flags |= SUTURE_PER_ELEMENT;
  t.attributes[2] = {sizeof(suture_attribute),
                     3,
                     1,
                     SUTURE_COPY,
                     SUTURE_PARAMETER,
                     0,
                     "E",
                     "Pa",
                     "E",
                     1e5,
                     nullptr,
                     0,
                     0};
  t.functors[0].vertex_column_count = 0;
}

const TableCase per_element_cases[] = {
    {"Sound", [](Tables& t) { vary(t); }, ""},
    {"NoAttribute",
     [](Tables& t) {
       vary(t);
       t.attributes[2].components = 3;
     },
     MODEL ", parameter 'E': has SUTURE_PER_ELEMENT, but the model has no attribute of this name "
           "with SUTURE_PARAMETER, dimension 3 and components 1"},
    {"NoParameter",
     [](Tables& t) {
       vary(t);
       t.parameters[0].flags = 0;
     },
     MODEL ", attribute 'E': has SUTURE_PARAMETER, but no parameter of this name has "
           "SUTURE_PER_ELEMENT"},
    {"Choice", [](Tables& t) { t.parameters[1].flags |= SUTURE_PER_ELEMENT; },
     MODEL ", parameter 'mode': has SUTURE_PER_ELEMENT, which only numbers and directions can "
           "have\n" MODEL ", parameter 'mode': has SUTURE_PER_ELEMENT, but the model has no "
           "attribute of this name with SUTURE_PARAMETER, dimension 3 and components 1"},
    {"Direction",
     [](Tables& t) {
       vary(t);
       t.parameters[0].type = SUTURE_DIRECTION;
       t.attributes[2].components = 3;
     },
     MODEL ", parameter 'E': has type SUTURE_DIRECTION, but not both flags SUTURE_PER_ELEMENT and "
           "SUTURE_REQUIRED"},
    {"Trial",
     [](Tables& t) {
       vary(t);
       t.attributes[2].flags |= SUTURE_TRIAL;
     },
     MODEL ", attribute 'E': has SUTURE_PARAMETER: expected policy SUTURE_COPY and no trial copy"},
    {"FromParameters", [](Tables& t) { t.attributes[1].flags |= SUTURE_FROM_PARAMETERS; },
     MODEL ", attribute 'k': has SUTURE_FROM_PARAMETERS: expected dimension 3 and policy "
           "SUTURE_FROM_VOLUMES"},
};

const TableCase attribute_cases[] = {
    {"Twice", [](Tables& t) { t.attributes[2].name = "k"; },
     MODEL ", attribute 'k': the name occurs twice"},
    {"Dimension", [](Tables& t) { t.attributes[2].dimension = 4; },
     MODEL ", attribute 'pull': dimension is 4, the last known value is 3\n" MODEL
           ", functor 'edges': its vertex column 2 is an attribute of dimension 4, expected 0"},
    {"Components", [](Tables& t) { t.attributes[2].components = 0; },
     MODEL ", attribute 'pull': has 0 components, expected 1 to 9"},
    {"Policy", [](Tables& t) { t.attributes[2].policy = 11; },
     MODEL ", attribute 'pull': policy is 11, the last known value is 3"},
    {"NoContribution", [](Tables& t) { t.attributes[1].contribution_count = 0; },
     MODEL ", attribute 'k': has policy SUTURE_FROM_VOLUMES, but no contribution"},
    {"ContributionNull", [](Tables& t) { t.attributes[1].contributions = nullptr; },
     MODEL ", attribute 'k': contributions is NULL, but its count is 1"},
    {"ContributionWithoutFunction", [](Tables& t) { t.sums[0].function = nullptr; },
     MODEL ", attribute 'mass', contribution 0: its function is NULL\n" MODEL
           ", attribute 'k', contribution 0: its function is NULL"},
    {"ContributionOfTetrahedra",
     [](Tables& t) {
       t.attributes[1].contributions = &t.sums[1];
       t.sums[1].cell_type = 5;
     },
     MODEL ", attribute 'k', contribution 0: its cell_type is 5, expected 4 (SUTURE_HEXAHEDRON): "
           "bodies of this Suture have no other 3-cells"},
    {"ContributionTwice", [](Tables& t) { t.attributes[1].contribution_count = 2; },
     MODEL ", attribute 'k', contribution 1: is a second one for the same cell_type"},
    {"ContributionUnused", [](Tables& t) { t.attributes[1].policy = SUTURE_SHARE; },
     MODEL ", attribute 'k': has a contribution, but not policy SUTURE_FROM_VOLUMES"},
    {"TrialOfSum", [](Tables& t) { t.attributes[1].flags = SUTURE_TRIAL; },
     MODEL ", attribute 'k': has both a trial copy and policy SUTURE_FROM_VOLUMES, which exclude "
           "each other"},
    {"MassOnEdges", [](Tables& t) { t.attributes[0].dimension = 1; },
     MODEL ", attribute 'mass': has SUTURE_SHARED_MASS: expected dimension 0, 1 component and "
           "policy SUTURE_FROM_VOLUMES"},
    {"Initial", [](Tables& t) { t.attributes[2].initial = nan; },
     MODEL ", attribute 'pull': its initial value is not finite"},
    {"FieldWithState", [](Tables& t) { t.attributes[2].flags |= SUTURE_FIELD; },
     MODEL ", attribute 'pull': has SUTURE_FIELD: expected dimension 0, 1 to 3 components, policy "
           "SUTURE_COPY and neither a trial copy nor another use"},
    {"RangeOfState", [](Tables& t) { t.attributes[2].maximum = 1; },
     MODEL ", attribute 'pull': has a range without SUTURE_FIELD"},
    {"EmptyRange",
     [](Tables& t) {
       t.attributes[2].flags = SUTURE_FIELD;
       t.attributes[2].minimum = t.attributes[2].initial = 2;
       t.attributes[2].maximum = 1;
     },
     MODEL ", attribute 'pull': its minimum is not below its maximum\n" MODEL
           ", attribute 'pull': its initial value lies outside of its range"},
    {"CapacityWithoutField", [](Tables& t) { t.attributes[0].flags = SUTURE_CAPACITY; },
     MODEL ", attribute 'mass': has SUTURE_CAPACITY, but no field (SUTURE_FIELD) stands before it "
           "that has none yet"},
    {"RelaxationWithoutField", [](Tables& t) { t.attributes[0].flags = SUTURE_RELAXATION; },
     MODEL
     ", attribute 'mass': has SUTURE_RELAXATION, but no field (SUTURE_FIELD) stands before it "
     "that has none yet"},
    {"RisingAlone", [](Tables& t) { t.attributes[0].flags |= SUTURE_RISING; },
     MODEL ", attribute 'mass': has SUTURE_RISING without SUTURE_FIELD"},
    {"CapacityOfEdges",
     [](Tables& t) {
       t.attributes[0] = {sizeof(suture_attribute),
                          0,
                          1,
                          SUTURE_COPY,
                          SUTURE_FIELD,
                          0,
                          "T",
                          "K",
                          "Heat",
                          0,
                          nullptr,
                          0,
                          0};
       t.attributes[1].flags = SUTURE_CAPACITY;
     },
     MODEL ", attribute 'k': has SUTURE_CAPACITY: expected dimension 0, 1 component, policy "
           "SUTURE_FROM_VOLUMES and neither a trial copy nor another use\n" MODEL
           ", functor 'edges': its cell column 1 has SUTURE_CAPACITY, which no functor reads"},
};

const TableCase functor_cases[] = {
    {"Force", [](Tables& t) { t.functors[0].force = nullptr; },
     MODEL ", functor 'edges': its function force is NULL"},
    {"Lanes", [](Tables& t) { t.functors[0].lanes = 16; },
     MODEL ", functor 'edges': is written for 16 lanes, this host has 8"},
    {"Scalar", [](Tables& t) { t.functors[0].scalar = 1; },
     MODEL ", functor 'edges': scalar is 1, the last known value is 0"},
    {"Reads", [](Tables& t) { t.functors[0].reads = 64; },
     MODEL ", functor 'edges': reads has unknown bits"},
    {"CellType", [](Tables& t) { t.functors[0].cell_type = SUTURE_HEXAHEDRON; },
     MODEL ", functor 'edges': its cell_type is 4, expected 2 with dimension 1"},
    {"Dimension", [](Tables& t) { t.functors[0].dimension = 4; },
     MODEL ", functor 'edges': its dimension is 4, expected 0 to 3\n" MODEL
           ", functor 'edges': its cell column 1 is an attribute of dimension 1, expected 4"},
    {"Reserved", [](Tables& t) { t.functors[0].reserved = 1; },
     MODEL ", functor 'edges': reserved is not 0"},
    {"Shape", [](Tables& t) { t.functors[0].shape = SUTURE_GENERAL; },
     MODEL ", functor 'edges': names a shape, which only cells of dimension 3 have"},
    {"Faces", [](Tables& t) { t.functors[0].faces = SUTURE_BOUNDARY_FACES; },
     MODEL
     ", functor 'edges': names a set of faces, but its dimension is not 2, or its cells are lips"},
    {"ColumnOutOfRange", [](Tables& t) { t.cell_columns[0] = 3; },
     MODEL ", functor 'edges': its cell column 3 is not an attribute: the model has 3"},
    {"ColumnDimension", [](Tables& t) { t.cell_columns[0] = 2; },
     MODEL ", functor 'edges': its cell column 2 is an attribute of dimension 0, expected 1"},
    {"VertexColumnDimension", [](Tables& t) { t.vertex_columns[0] = 1; },
     MODEL ", functor 'edges': its vertex column 1 is an attribute of dimension 1, expected 0"},
    {"MassAsColumn", [](Tables& t) { t.vertex_columns[0] = 0; },
     MODEL ", functor 'edges': its vertex column 0 has SUTURE_SHARED_MASS and is therefore not a "
           "column; use the vertex column UINT32_MAX for the vertex mass"},
    {"RateOfNoField", [](Tables& t) { t.functors[0].field = 3; },
     MODEL ", functor 'edges': its field is 3, expected 0 or 1 + the index of an attribute with "
           "SUTURE_FIELD"},
    {"RateWithoutTangent",
     [](Tables& t) {
       t.attributes[2].components = 1;
       t.attributes[2].flags = SUTURE_FIELD;
       t.functors[0].field = 3;
     },
     MODEL ", functor 'edges': changes a field, but has no suture.tangent/1"},
    {"NullColumns", [](Tables& t) { t.functors[0].cell_columns = nullptr; },
     MODEL ", functor 'edges': cell_columns is NULL, but its count is 1"},
};

INSTANTIATE_TEST_SUITE_P(Plugin, TableCheckCase, ::testing::ValuesIn(plugin_cases), name_of_case);
INSTANTIATE_TEST_SUITE_P(PerElement, TableCheckCase, ::testing::ValuesIn(per_element_cases),
                         name_of_case);
INSTANTIATE_TEST_SUITE_P(Parameter, TableCheckCase, ::testing::ValuesIn(parameter_cases),
                         name_of_case);
INSTANTIATE_TEST_SUITE_P(Attribute, TableCheckCase, ::testing::ValuesIn(attribute_cases),
                         name_of_case);
INSTANTIATE_TEST_SUITE_P(Functor, TableCheckCase, ::testing::ValuesIn(functor_cases), name_of_case);

// A scene's author sees all faults at once.
TEST(TableCheck, AllFaultsAreReportedTogether) {
  const auto problems = problems_with([](Tables& t) {
    t.parameters[0].unit = nullptr;
    t.attributes[2].policy = 11;
    t.functors[0].force = nullptr;
  });
  EXPECT_EQ(std::count(problems.begin(), problems.end(), '\n'), 2);
}

// ------------------------------------------------------- older, smaller structs --

/// Structs one after the other, each cut to `size` bytes: what a compiler of an older minor
/// lays out.
template <class T>
std::vector<double> cut(std::span<const T> table, std::uint32_t size) {
  std::vector<double> bytes(table.size() * size / sizeof(double));
  for (std::size_t i = 0; i < table.size(); ++i) {
    T entry = table[i];
    entry.size = size;
    std::memcpy(reinterpret_cast<char*>(bytes.data()) + i * size, &entry, size);
  }
  return bytes;
}

/// As if model.extension, functor.enabled, parameter.choices and the functions of
/// contributions had come with a later minor.
const TableSizes older{80, 96, 96, 64, 64, 8};

struct OlderPlugin : Tables {
  OlderPlugin() {
    parameters[1].type = SUTURE_NUMBER;
    parameters[1].choice_count = 0;
    parameters[1].maximum = 2;
    functors[1] = functors[0];
    functors[1].name = "more edges";
    for (suture_functor& f : functors) f.enabled = [](auto*, auto*) { return 0; };
    models[0].parameters =
        as<suture_parameter>(parameter_bytes = cut<suture_parameter>(parameters, 64));
    models[0].functors = as<suture_functor>(functor_bytes = cut<suture_functor>(functors, 96));
    models[0].functor_count = 2;
    for (suture_model& m : models) m.extension = [](auto*) -> const void* { return "?"; };
    models[1].parameters = models[0].parameters;
    models[1].functors = models[0].functors;
    models[1].functor_count = 2;
    for (int i = 0; i < 2; ++i) attributes[i].contributions = as<suture_contribution>(sum_bytes);
    plugin.models = as<suture_model>(model_bytes = cut<suture_model>(models, 96));
    plugin.model_count = 2;
  }
  template <class T>
  static const T* as(const std::vector<double>& bytes) {
    return reinterpret_cast<const T*>(bytes.data());
  }
  suture_functor functors[2] = {Tables::functors[0]};
  std::vector<double> parameter_bytes, functor_bytes, model_bytes,
      sum_bytes = cut<suture_contribution>(sums, 8);
};

TEST(TableCopy, OlderStructsAreReadAndWhatTheyLackIsZero) {
  const OlderPlugin old;
  std::vector<std::string> problems;
  const auto copy = copy_tables(old.plugin, problems, older);
  ASSERT_EQ(joined(problems), "");
  ASSERT_EQ(copy->models.size(), 2u);
  for (const int i : {0, 1}) {
    const suture_model& m = copy->plugin.models[i];
    EXPECT_EQ(m.size, sizeof(suture_model));
    EXPECT_STREQ(m.id, old.models[i].id);
    EXPECT_EQ(m.instance_bytes, old.models[i].instance_bytes);
    EXPECT_EQ(m.extension, nullptr);
    EXPECT_STREQ(m.parameters[1].name, "mode");
    EXPECT_EQ(m.parameters[1].maximum, 2);
    EXPECT_EQ(m.parameters[1].choices, nullptr);
    EXPECT_STREQ(m.functors[1].name, "more edges");
    EXPECT_EQ(m.functors[1].force, &Tables::force);
    EXPECT_EQ(m.functors[1].enabled, nullptr);
    EXPECT_EQ(m.functors[1].size, sizeof(suture_functor));
    EXPECT_EQ(m.attributes[1].contributions[0].cell_type, unsigned(SUTURE_HEXAHEDRON));
    EXPECT_EQ(m.attributes[1].contributions[0].function, nullptr);
    EXPECT_EQ(m.attributes[2].components, 3u);
  }
}

TEST(TableCopy, StructsBelowThePublishedSizeAreRefused) {
  const OlderPlugin old;
  EXPECT_EQ(joined(problems_of(old.plugin)),
            "model 0: its member size is 96, expected 104 (first member of every struct: sizeof)");
}

TEST(TableCopy, EntriesOfOneArrayHaveOneSize) {
  Tables tables;
  tables.parameters[1].size = 64;
  EXPECT_EQ(joined(problems_of(tables.plugin)), MODEL
            ", parameter 1: its member size is 64, expected 72 (first member of every struct: "
            "sizeof)");
}

}  // namespace
}  // namespace suture
