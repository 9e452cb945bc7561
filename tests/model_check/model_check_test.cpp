// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cstdlib>

#include "kernel/base/error.hpp"
#include "kernel/model_check/check_list.hpp"
#include "kernel/plugin_host/plugin_host.hpp"
#include "kernel/plugin_host/plugin_library.hpp"
#include "tests/base/sanitizer.hpp"

namespace suture::test {
namespace {

/// All builds of the plugin with a model, the best first.
std::vector<const suture_model*> builds_of(const std::string& id) {
  static PluginHost host;
  static const bool added = (host.add_file(TEST_PLUGINS "/planted-faults.so"),
                             host.add_file(TEST_PLUGINS "/active-laws.so"),
                             host.add_file(TEST_PLUGINS "/faulty-rates.so"),
                             host.add_file(SDK_PLUGINS "/neo-hooke.so"), true);
  EXPECT_TRUE(added);
  std::vector<const suture_model*> models;
  for (const PluginFile& build : host.builds(id)) {
    const suture_plugin& plugin = load_plugin(build.file, build.note);
    for (const suture_model& model : std::span(plugin.models, plugin.model_count))
      if (model.id == id) models.push_back(&model);
  }
  return models;
}

/// "gradient: the force on ...", for each law that is broken.
std::vector<std::string> broken_laws(const std::string& id, std::uint64_t seed) {
  const auto builds = builds_of(id);
  const auto sets = parameter_sets(*builds.front(), {});
  std::vector<std::string> broken;
  for (const ModelCheck& check : model_checks()) {
    const CheckOutcome outcome = make_check(check, builds, sets, seed);
    if (outcome.status == CheckOutcome::Status::failed)
      broken.push_back(std::string(check.name) + ": " + outcome.text);
  }
  return broken;
}

struct Planted {
  const char *fault, *law;
};
void PrintTo(const Planted& planted, std::ostream* out) { *out << planted.fault; }

class PlantedFaults : public testing::TestWithParam<Planted> {};

INSTANTIATE_TEST_SUITE_P(
    ModelCheck, PlantedFaults,
    testing::Values(Planted{"wrong-sign", "gradient"}, Planted{"twice", "gradient"},
                    Planted{"half-energy", "gradient"}, Planted{"unset-node", "outputs"},
                    Planted{"same-force", "balance"}, Planted{"out-of-range", "outputs"},
                    Planted{"writes-input", "outputs"}, Planted{"adds", "outputs"},
                    Planted{"mixed-lanes", "lanes"}, Planted{"padding", "lanes"},
                    Planted{"undeclared", "inputs"}, Planted{"reads-ids", "inputs"},
                    Planted{"memory", "repetition"}, Planted{"race", "repetition"},
                    Planted{"nan-accepted", "bad-states"}, Planted{"no-geometric", "tangent"},
                    Planted{"no-damping", "tangent"}, Planted{"single-zero", "single-tangent"},
                    Planted{"small-bounds", "step-bounds"}, Planted{"absolute", "translation"},
                    Planted{"linear-strain", "objectivity"}, Planted{"axis", "orientation"},
                    Planted{"shape", "shapes"}, Planted{"prestress", "rest"},
                    Planted{"negative", "stiffness"}, Planted{"mass-constant", "mass"},
                    Planted{"mass-negative", "mass"}, Planted{"copied", "cut"},
                    Planted{"global", "instances"}, Planted{"ignored", "parameters"},
                    Planted{"rounded", "slopes"}, Planted{"step-counter", "state"},
                    Planted{"part-per-step", "state"}, Planted{"state-in-place", "outputs"},
                    Planted{"state-unset", "outputs"}, Planted{"energy-unset", "outputs"},
                    Planted{"bounds-outside", "outputs"}, Planted{"field-unset", "outputs"},
                    Planted{"isa", "builds"}, Planted{"one-node-off", "gradient"},
                    Planted{"velocity-drag", "balance"}, Planted{"allocates", "allocations"},
                    Planted{"active-ignores-end", "parameters"},
                    Planted{"active-fixed-axis", "objectivity"}, Planted{"rate-upwind", "rates"},
                    Planted{"rate-source", "rates"}, Planted{"rate-reading-source", "rates"},
                    Planted{"rate-blind", "rates"}, Planted{"rate-empty", "field-cut"},
                    Planted{"rate-no-capacity", "field-cut"}, Planted{"rate-one-way", "coupling"},
                    Planted{"rate-followed", "rates"}, Planted{"rate-half-loss", "rates"}),
    [](const auto& test) {
      std::string name = test.param.fault;
      std::erase(name, '-');
      return name;
    });

/// Allocations are not counted under ThreadSanitizer.
bool is_blind_to(const Planted& planted) {
  return test::sanitizer == "thread" && std::string(planted.law) == "allocations";
}

TEST_P(PlantedFaults, IsCaughtByTheLawThatItBreaks) {
  if (is_blind_to(GetParam())) return;
  const auto builds = builds_of(GetParam().fault);
  if (std::string(GetParam().law) == "builds" && builds.size() == 1) return;
  const CheckOutcome outcome =
      make_check(find_check(GetParam().law), builds, parameter_sets(*builds.front(), {}), 1);
  EXPECT_EQ(outcome.status, CheckOutcome::Status::failed) << outcome.figure << ' ' << outcome.text;
}

// With the sample and the batch of the failure alone, too.
TEST_P(PlantedFaults, IsFoundAgainWhereItWasFound) {
  if (is_blind_to(GetParam())) return;
  const std::string law = GetParam().law;
  const auto builds = builds_of(GetParam().fault);
  if (law == "builds" && builds.size() == 1) return;
  const ModelCheck& check = find_check(law);
  const CheckOutcome first = make_check(check, builds, parameter_sets(*builds.front(), {}), 1);
  ASSERT_TRUE(first.sample);
  EXPECT_EQ(first.batch.has_value(), check.of_batch != nullptr);
  const CheckOutcome again = repeat_check(check, builds, *first.sample, first.batch);
  EXPECT_EQ(again.status, CheckOutcome::Status::failed);
  if (law != "repetition") {
    EXPECT_EQ(again.text, first.text);
  }
}

class GoodModels : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(ModelCheck, GoodModels,
                         testing::Values("none", "neo-hooke", "active-muscle", "active-tone",
                                         "cohesive", "corotational", "damage", "damage-springs",
                                         "fibres", "gradient-damage", "heat", "hooke",
                                         "mooney-rivlin", "mss-baudet", "mss-golec", "neo-hookean",
                                         "porous", "thermoelastic", "tie", "tm-faure", "visco",
                                         "volume"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::erase(name, '-');
                           return name;
                         });

// Seeds 1 and 3, of 1 to 20 in the full test: with both, eigenvalues of `mooney-rivlin` are so
// close that power iteration misses the largest.
TEST_P(GoodModels, BreakNoLaw) {
  const bool full = std::getenv("SUTURE_FULL") != nullptr;
  for (std::uint64_t seed = 1; seed <= (full ? 20 : 3); seed += full ? 1 : 2)
    EXPECT_EQ(broken_laws(GetParam(), seed), std::vector<std::string>{}) << "seed " << seed;
}

TEST(ModelCheck, ChecksThatDoNotExistAreRefusedWithTheNearestName) {
  try {
    find_check("gradeint");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean 'gradient'"), std::string::npos);
  }
}

// Their torques vanish at rest only.
TEST(ModelCheck, ModelsThatDeclareThemselvesLinearNeedNotBeObjective) {
  const auto builds = builds_of("hooke");
  const auto sets = parameter_sets(*builds.front(), {});
  const CheckOutcome outcome = make_check(find_check("objectivity"), builds, sets, 1);
  EXPECT_EQ(outcome.status, CheckOutcome::Status::not_applicable);
  EXPECT_EQ(outcome.text, "declared linear");
  suture_model undeclared = *builds.front();
  undeclared.flags = SUTURE_CONTINUUM;
  const suture_model* const only[] = {&undeclared};
  for (const char* law : {"objectivity", "balance"})
    EXPECT_EQ(make_check(find_check(law), only, sets, 1).status, CheckOutcome::Status::failed);
}

// What acts at all times leaves no rest state, and may pull a stretched body together.
TEST(ModelCheck, ModelsThatDeclareThemselvesActiveNeedNoRestState) {
  const auto builds = builds_of("active-tone");
  const auto sets = parameter_sets(*builds.front(), {});
  for (const char* law : {"rest", "stiffness"})
    EXPECT_EQ(make_check(find_check(law), builds, sets, 1).text, "declared active");
  suture_model undeclared = *builds.front();
  undeclared.flags = SUTURE_CONTINUUM;
  const suture_model* const only[] = {&undeclared};
  EXPECT_EQ(make_check(find_check("rest"), only, sets, 1).status, CheckOutcome::Status::failed);
}

TEST(ModelCheck, TimesAreSampledInEveryIntervalThatParametersName) {
  const auto builds = builds_of("active-muscle");
  ParameterSet set = parameter_sets(*builds.front(), {{"from", "0.5"}, {"to", "2"}}).front();
  EXPECT_EQ(sample_times(*builds.front(), set), (std::vector<double>{0.3, 1.4, 2.8, 0}));
  set.values[3] = set.values[4] = 0;
  EXPECT_EQ(sample_times(*builds.front(), set), (std::vector<double>{1, 0}));
}

TEST(ModelCheck, ValuesOfParametersCanBeGiven) {
  const auto builds = builds_of("tm-faure");
  const auto sets = parameter_sets(*builds.front(), {{"nu", "0.45"}, {"element", "mean-gradient"}});
  for (const ParameterSet& set : sets) EXPECT_EQ(set.values[1], 0.45) << set.name;
  EXPECT_THROW(parameter_sets(*builds.front(), {{"nu", "0.5"}}), UsageError);
  EXPECT_THROW(parameter_sets(*builds.front(), {{"mu", "0.1"}}), UsageError);
}

}  // namespace
}  // namespace suture::test
