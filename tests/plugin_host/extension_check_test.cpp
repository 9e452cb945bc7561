// SPDX-License-Identifier: GPL-3.0-or-later
// One change at a time to the extensions of a plugin, and the sentence that it must produce.
#include "kernel/plugin_host/extension_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <string_view>

#include "kernel/base/error.hpp"
#include "kernel/plugin_host/output_fields.hpp"
#include "suture/parts.h"
#include "suture/single.h"
#include "tests/plugin_host/change_case.hpp"

namespace suture {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A model of two functors on edges, which offer every extension. Those of the last object.
struct Offer {
  Offer() { present = this; }
  ~Offer() { present = nullptr; }
  Offer(const Offer&) = delete;
  Offer& operator=(const Offer&) = delete;

  static suture_status force(const suture_context*, const suture_batch*) { return SUTURE_OK; }
  static suture_status one(const suture_context*, const suture_batch*, double*) {
    return SUTURE_OK;
  }
  static suture_status two(const suture_context*, const suture_batch*, double*, double*) {
    return SUTURE_OK;
  }
  static suture_status apply(const suture_context*, const suture_batch*, const double*,
                             const double*, double*) {
    return SUTURE_OK;
  }
  static suture_status apply_single(const suture_context*, const suture_single_batch*, const float*,
                                    const float*, float*) {
    return SUTURE_OK;
  }
  static suture_status compute(const suture_context*, const suture_batch*, double* const*) {
    return SUTURE_OK;
  }
  static const void* of_first(const char* id) {
    const std::string_view asked = id;
    if (present->throws) throw 42;
    if (asked == SUTURE_ENERGY_1) return &present->energy;
    if (asked == SUTURE_STABLE_DT_1) return &present->stable_dt;
    if (asked == SUTURE_TANGENT_1) return &present->tangent;
    if (asked == SUTURE_TANGENT_SINGLE_1) return &present->single;
    if (asked == SUTURE_INSPECT_1) return &present->inspect;
    const bool is_general = present->functors[0].shape == SUTURE_GENERAL;
    if (asked == (is_general ? SUTURE_PARTS_2 : SUTURE_PARTS_1)) return &present->parts;
    return asked == SUTURE_OUTPUT_1 ? &present->output : nullptr;
  }
  static const void* of_second(const char* id) {
    return std::string_view(id) == SUTURE_OUTPUT_1 ? &present->other_output : nullptr;
  }

  static inline const Offer* present = nullptr;
  bool throws = false;
  suture_energy_1 energy{sizeof energy, 0, one};
  suture_stable_dt_1 stable_dt{sizeof stable_dt, 0, two};
  suture_tangent_1 tangent{sizeof tangent, 0, apply};
  suture_parts_1 parts{sizeof parts, 0, nullptr};
  suture_functor on_parts{};
  suture_tangent_single_1 single{sizeof single, SUTURE_SINGLE_LANES, SUTURE_READ_POSITION, 0,
                                 apply_single};
  suture_inspect_1 inspect{sizeof inspect, 0, force};
  suture_field fields[2] = {{sizeof(suture_field), 6, "stress", "Pa", "Stress."},
                            {sizeof(suture_field), 1, "strain", "1", "Strain."}};
  suture_field other_fields[1] = {{sizeof(suture_field), 1, "strain", "1", "Strain."}};
  suture_output_1 output{sizeof output, 2, fields, compute};
  suture_output_1 other_output{sizeof output, 1, other_fields, compute};
  suture_functor functors[2] = {{sizeof(suture_functor),
                                 1,
                                 SUTURE_EDGE,
                                 0,
                                 0,
                                 8,
                                 0,
                                 SUTURE_READ_POSITION,
                                 0,
                                 0,
                                 0,
                                 0,
                                 nullptr,
                                 nullptr,
                                 "edges",
                                 "Springs.",
                                 force,
                                 of_first,
                                 nullptr,
                                 0,
                                 0},
                                {sizeof(suture_functor),
                                 1,
                                 SUTURE_EDGE,
                                 0,
                                 0,
                                 8,
                                 0,
                                 SUTURE_READ_POSITION,
                                 0,
                                 0,
                                 0,
                                 0,
                                 nullptr,
                                 nullptr,
                                 "others",
                                 "Springs.",
                                 force,
                                 of_second,
                                 nullptr,
                                 0,
                                 0}};
  suture_model model{sizeof model, 0,       "springs", "Springs.", "f = k u", "none", 0, 0, 2, 0,
                     nullptr,      nullptr, functors,  nullptr,    0,         nullptr};
  suture_plugin plugin{
      sizeof plugin, SUTURE_MAGIC, SUTURE_ABI_MAJOR, SUTURE_ABI_MINOR, 8, 1, "springs",
      "1.0",         "MIT",        "Springs.",       &model,           0, 0, nullptr};
};

using ExtensionCase = ChangeCase<Offer>;

class ExtensionCheck : public ::testing::TestWithParam<ExtensionCase> {};

TEST_P(ExtensionCheck, NamesFunctorExtensionAndFault) {
  Offer offer;
  EXPECT_THAT(extension_problems(offer.plugin), IsEmpty());
  GetParam().change(offer);
  EXPECT_THAT(extension_problems(offer.plugin), ElementsAre(GetParam().expected));
}

#define FIRST "model 'springs', functor 'edges', extension "
#define OUTPUT FIRST "'suture.output/1'"
const ExtensionCase cases[] = {
    {"Energy", [](Offer& o) { o.energy.energy = nullptr; },
     FIRST "'suture.energy/1': its function is NULL"},
    {"Bounds", [](Offer& o) { o.stable_dt.bounds = nullptr; },
     FIRST "'suture.stable-dt/1': its function is NULL"},
    {"Tangent", [](Offer& o) { o.tangent.apply = nullptr; },
     FIRST "'suture.tangent/1': its function is NULL"},
    {"PartsReserved", [](Offer& o) { o.parts.reserved = 1; },
     FIRST "'suture.parts/1': reserved is not 0"},
    {"PartsOfElementsAreMissing", [](Offer& o) { o.functors[0].dimension = 3; },
     FIRST "'suture.parts/1': its functor is NULL, which a functor on elements may not have"},
    {"PartsOfGeneralElementsAreMissing",
     [](Offer& o) {
       o.functors[0].dimension = 3;
       o.functors[0].shape = SUTURE_GENERAL;
     },
     FIRST "'suture.parts/2': its functor is NULL, which a functor on elements may not have"},
    {"PartsOnEdges",
     [](Offer& o) {
       o.on_parts = o.functors[0];
       o.parts.functor = &o.on_parts;
     },
     FIRST
     "'suture.parts/1': its functor differs in dimension, shape or reads, or is not on elements"},
    {"SingleTangent", [](Offer& o) { o.single.apply = nullptr; },
     FIRST "'suture.tangent-single/1': its function is NULL"},
    {"SingleLanes", [](Offer& o) { o.single.lanes = 8; },
     FIRST "'suture.tangent-single/1': lanes is 8, expected 16"},
    {"SingleReads", [](Offer& o) { o.single.reads = 8; },
     FIRST "'suture.tangent-single/1': reads has unknown bits"},
    {"SingleColumns", [](Offer& o) { o.single.columns = 2; },
     FIRST "'suture.tangent-single/1': columns is 2, but the functor has 0 cell columns"},
    {"Inspect", [](Offer& o) { o.inspect.inspect = nullptr; },
     FIRST "'suture.inspect/1': its function is NULL"},
    {"Size", [](Offer& o) { o.energy.size = 0; },
     FIRST "'suture.energy/1': its member size is 0, expected 16 (first member of every struct: "
           "sizeof)"},
    {"Reserved", [](Offer& o) { o.tangent.reserved = 1; },
     FIRST "'suture.tangent/1': reserved is not 0"},
    {"Output", [](Offer& o) { o.output.compute = nullptr; }, OUTPUT ": its function is NULL"},
    {"OutputSize", [](Offer& o) { o.output.size = 32; },
     OUTPUT ": its member size is 32, expected 24 (first member of every struct: sizeof)"},
    {"NullFields", [](Offer& o) { o.output.fields = nullptr; },
     OUTPUT ": fields is NULL, but its count is 2"},
    {"Count", [](Offer& o) { o.output.field_count = 0xDEADBEEF; },
     OUTPUT ": the count of fields is 3735928559, at most 4096"},
    {"FieldSize", [](Offer& o) { o.fields[1].size = 0; },
     OUTPUT ", field 1: its member size is 0, expected 32 (first member of every struct: sizeof)"},
    {"Components", [](Offer& o) { o.fields[0].components = 9; },
     OUTPUT ", field 'stress': has 9 components, expected 1, 3 or 6"},
    {"NullName", [](Offer& o) { o.fields[0].name = nullptr; },
     OUTPUT ", field 0: its name is not a letter followed by letters, digits and '_'"},
    {"Name", [](Offer& o) { o.fields[0].name = "von Mises"; },
     OUTPUT ", field 'von Mises': its name is not a letter followed by letters, digits and '_'"},
    {"NullUnit", [](Offer& o) { o.fields[0].unit = nullptr; },
     OUTPUT ", field 'stress': unit is NULL"},
    {"NullDoc", [](Offer& o) { o.fields[0].doc = nullptr; },
     OUTPUT ", field 'stress': doc is NULL"},
    {"Twice",
     [](Offer& o) {
       o.fields[0].name = "strain";
       o.fields[0].components = 1;
     },
     OUTPUT ", field 'strain': the name occurs twice"},
    {"OtherComponents", [](Offer& o) { o.other_fields[0].components = 6; },
     "model 'springs', functor 'others', extension 'suture.output/1', field 'strain': has 6 "
     "components, but the field of this name in an earlier functor of the model has 1"},
};
INSTANTIATE_TEST_SUITE_P(Offer, ExtensionCheck, ::testing::ValuesIn(cases), name_of_case);

TEST(Extensions, ThatThrowAreAFaultOfThePlugin) {
  Offer offer;
  offer.throws = true;
  try {
    extension_problems(offer.plugin);
    FAIL();
  } catch (const PluginError& error) {
    EXPECT_THAT(error.what(), HasSubstr("functor 'edges', extension: the plugin threw"));
  }
}

// As if the doc of fields had come with a later minor.
TEST(Extensions, FieldsOfAnOlderPluginAreReadAndWhatTheyLackIsZero) {
  Offer offer;
  constexpr std::uint32_t size = 24;
  alignas(suture_field) char bytes[2 * size];
  for (int i = 0; i < 2; ++i) {
    offer.fields[i].size = size;
    std::memcpy(bytes + i * size, &offer.fields[i], size);
  }
  offer.output.fields = reinterpret_cast<const suture_field*>(bytes);
  const std::vector<suture_field> fields = output_fields(offer.functors[0]);
  ASSERT_EQ(fields.size(), 2u);
  EXPECT_STREQ(fields[1].name, "strain");
  EXPECT_STREQ(fields[1].unit, "1");
  EXPECT_EQ(fields[1].doc, nullptr);
  TableSizes older;
  older.field = size;
  EXPECT_THAT(
      extension_problems(offer.plugin, older),
      ElementsAre(OUTPUT ", field 'stress': doc is NULL", OUTPUT ", field 'strain': doc is NULL"));
}

}  // namespace
}  // namespace suture
