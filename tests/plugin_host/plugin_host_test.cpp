// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/plugin_host.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <set>
#include <thread>

#include "kernel/base/error.hpp"
#include "tests/plugin_host/test_plugins.hpp"

namespace suture {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;

/// Folders of plugins of its own and an environment that hides the machine's.
class PluginHostTest : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(root);
    fs::create_directories(root / "a");
    fs::create_directories(root / "b");
    setenv("XDG_DATA_HOME", (root / "data").c_str(), 1);
    setenv("SUTURE_PLUGIN_PATH", ((root / "a").string() + ":" + (root / "b").string()).c_str(), 1);
    unsetenv("SUTURE_ISA");
    unsetenv("TEST_PLUGIN_LOADED");
  }
  void TearDown() override {
    fs::remove_all(root);
    unsetenv("SUTURE_PLUGIN_PATH");
    unsetenv("XDG_DATA_HOME");
  }

  /// Puts a test plugin into a folder under a name.
  fs::path put(const std::string& plugin, const fs::path& folder, const std::string& name) {
    fs::create_directories(root / folder);
    fs::copy_file(plugins / (plugin + ".so"), root / folder / name);
    return root / folder / name;
  }

  template <class Action>
  static std::string message_of(Action action) {
    try {
      action();
    } catch (const PluginError& error) {
      EXPECT_EQ(error.exit_code(), 4);
      return error.what();
    }
    return "no error";
  }

  /// The message with which a file is refused, when named and when its model is used.
  static std::string refusal(const std::string& plugin) {
    return message_of([&] {
      PluginHost host;
      host.add_file(plugins / (plugin + ".so"));
      host.model(plugin);
    });
  }

  const fs::path root = fs::temp_directory_path() / ("suture-plugins-" + std::to_string(getpid()));
};

// A program that makes many simulations, on several threads.
TEST_F(PluginHostTest, AllHostsShareTheTablesOfAPlugin) {
  std::vector<const suture_model*> models(8);
  std::vector<std::thread> threads;
  for (const suture_model*& model : models)
    threads.emplace_back([&] {
      PluginHost host;
      host.add_file(plugins / "good.so");
      model = &host.model("good");
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(std::set(models.begin(), models.end()).size(), 1u);
}

TEST_F(PluginHostTest, LoadsAModelFromANamedFile) {
  PluginHost host;
  host.add_file(plugins / "good.so");
  const suture_model& model = host.model("good");
  EXPECT_STREQ(model.id, "good");
  EXPECT_STREQ(host.plugin_of(model).license, "MIT");
  EXPECT_EQ(host.file_of(model), plugins / "good.so");
  EXPECT_EQ(&host.model("good"), &model);
  suture_model stranger = model;
  EXPECT_THROW(host.plugin_of(stranger), PluginError);
}

// A damaged build of another instruction set, and one of another plugin, are not among them.
TEST_F(PluginHostTest, NamesTheBuildsThatTheProcessorRunsAndLoadsNone) {
  const fs::path base = put("good", "a", "mine.so");
  std::ofstream(root / "a" / "mine.avx2.so") << "no plugin";
  put("good", "b", "good.so");
  PluginHost host;
  host.add_file(base);
  EXPECT_EQ(host.models_of_files(), std::vector<std::string>{"good"});
  const std::vector<PluginFile> builds = host.builds("good");
  ASSERT_EQ(builds.size(), 1u);
  EXPECT_EQ(builds[0].file, base);
  EXPECT_EQ(std::getenv("TEST_PLUGIN_LOADED"), nullptr);
  EXPECT_THROW(host.builds("godo"), PluginError);
}

TEST_F(PluginHostTest, ModelsOutliveTheHostThatLoadedThem) {
  const suture_model* model = nullptr;
  {
    PluginHost host;
    host.add_file(plugins / "good");  // ".so" may be left out
    model = &host.model("good");
  }
  EXPECT_STREQ(model->functors[0].name, "nothing");
}

// ------------------------------------------------------------- refused files --

TEST_F(PluginHostTest, RefusesByNoteWithoutRunningTheFile) {
  EXPECT_THAT(refusal("other-major"),
              AllOf(HasSubstr("other-major.so: it is built for plugin ABI 7.0"),
                    HasSubstr("this Suture has ABI 1.0")));
  EXPECT_THAT(refusal("newer-minor"), HasSubstr("newer than this Suture's ABI 1.0"));
  EXPECT_THAT(refusal("no-note"), HasSubstr("it has no Suture note"));
  EXPECT_EQ(std::getenv("TEST_PLUGIN_LOADED"), nullptr);
  EXPECT_THAT(refusal("no-symbol"), HasSubstr("it exports no function suture_plugin_v1"));
  EXPECT_STREQ(std::getenv("TEST_PLUGIN_LOADED"), "no-symbol");  // so the check above can fail
}

TEST_F(PluginHostTest, AnUndefinedSymbolIsFoundAtLoadingWithTheLoadersText) {
  EXPECT_THAT(refusal("undefined-symbol"),
              AllOf(HasSubstr("message of the loader: "),
                    HasSubstr("undefined symbol: nobody_defines_this"),
                    HasSubstr("Hint: a library is missing from the plugin's link line")));
}

TEST_F(PluginHostTest, RefusesTablesThatCannotBeUsed) {
  EXPECT_THAT(refusal("null-table"), HasSubstr("\n  models is NULL, but its count is 1"));
  EXPECT_THAT(refusal("two-models"), HasSubstr("\n  model 'two-models': the id occurs twice"));
  EXPECT_THAT(refusal("missing-extension"),
              HasSubstr("requires the host's extension 'suture.energi/1', which this Suture does "
                        "not have (did you mean 'suture.energy/1'?)"));
  EXPECT_THAT(refusal("returns-null"), HasSubstr("suture_plugin_v1 returned NULL"));
  EXPECT_THAT(refusal("other-ids"), HasSubstr("name different ids; rebuild it"));
  EXPECT_THAT(refusal("throwing"),
              HasSubstr("suture_plugin_v1: the plugin threw an exception of type "
                        "std::runtime_error (no tables today)"));
}

TEST_F(PluginHostTest, RefusesFilesThatAreNoLibraries) {
  std::ofstream(root / "a" / "text.so") << "hello";
  PluginHost host;
  EXPECT_THAT(message_of([&] { host.add_file(root / "a" / "text.so"); }),
              EndsWith("text.so: it is not a shared library (not an ELF file)"));
  EXPECT_THAT(message_of([&] { host.add_file(root / "a" / "txt.so"); }),
              HasSubstr("no such file (did you mean 'text.so'?)"));
  // Found on the search path under the model's name: the same reason, not "not found".
  EXPECT_THAT(message_of([&] { host.model("text"); }),
              EndsWith("text.so: it is not a shared library (not an ELF file)"));
}

TEST_F(PluginHostTest, AMissingModelNamesTheNearestAndThePlacesSearched) {
  put("good", "a", "good.so");
  PluginHost host;
  EXPECT_THAT(
      message_of([&] { host.model("goood"); }),
      AllOf(HasSubstr("no plugin provides the model 'goood' (did you mean 'good'?)"),
            HasSubstr((root / "a").string() + " (SUTURE_PLUGIN_PATH)"),
            HasSubstr((root / "data/suture/plugins").string() + " (user folder, no such folder)"),
            HasSubstr("lib/suture/plugins (beside the program"), HasSubstr("`suture models`")));
  EXPECT_EQ(std::getenv("TEST_PLUGIN_LOADED"), nullptr);
}

// --------------------------------------------------------------- search order --

TEST_F(PluginHostTest, FindsModelsByNoteWhateverTheFileIsCalled) {
  const auto file = put("good", "b", "renamed.so");
  PluginHost host;
  EXPECT_EQ(host.file_of(host.model("good")), file);
}

TEST_F(PluginHostTest, TheFirstFolderWinsWithAWarning) {
  put("good", "data/suture/plugins", "good.so");
  put("good", "b", "good.so");
  const auto first = put("good", "a", "zzz.so");
  Diagnostics diagnostics;
  PluginHost host(&diagnostics);
  EXPECT_EQ(host.file_of(host.model("good")), first);
  ASSERT_EQ(diagnostics.warnings().size(), 2u);
  EXPECT_THAT(
      diagnostics.warnings()[0],
      AllOf(HasSubstr("model 'good' is provided by more than one plugin: " + first.string()),
            HasSubstr((root / "b" / "good.so").string() + " is ignored")));
}

TEST_F(PluginHostTest, InAFolderThePluginNamedLikeTheModelWins) {
  put("good", "a", "another.so");
  const auto named = put("good", "a", "good.so");
  PluginHost host;
  EXPECT_EQ(host.file_of(host.model("good")), named);
}

TEST_F(PluginHostTest, AFileNamedInTheSceneWinsOverTheFolders) {
  put("good", "a", "good.so");
  const auto named = put("good", "scene", "good.so");
  PluginHost host;
  host.add_file(named);
  EXPECT_EQ(host.file_of(host.model("good")), named);
}

TEST_F(PluginHostTest, OneFileOnTwoWaysIsNoConflict) {
  const auto file = put("good", "a", "good.so");
  fs::create_symlink(file, root / "b" / "good.so");
  Diagnostics diagnostics;
  PluginHost host(&diagnostics);
  host.add_file(file);
  host.model("good");
  EXPECT_TRUE(diagnostics.warnings().empty());
}

// ------------------------------------------------------------ instruction sets --

// The notes of the builds differ; their code is the baseline's, which runs anywhere.
TEST_F(PluginHostTest, TakesTheBestBuildThatRuns) {
  put("good", "a", "good.so");
  put("good-avx2", "a", "good.avx2.so");
  put("good-avx512", "a", "good.avx512.so");
  for (const std::string isa : {"base", "avx2", "avx512"}) {
    setenv("SUTURE_ISA", isa.c_str(), 1);
    const std::string best(best_isa());  // less than asked for on an older processor
    const fs::path file = root / "a" / (best.empty() ? "good.so" : "good." + best + ".so");
    PluginHost found, named;
    EXPECT_EQ(found.file_of(found.model("good")), file);
    named.add_file(root / "a" / "good.so");
    EXPECT_EQ(named.file_of(named.model("good")), file);
  }
}

TEST_F(PluginHostTest, ABuildThatDoesNotRunIsRefused) {
  const auto file = put("good-avx512", "a", "good.avx512.so");
  setenv("SUTURE_ISA", "avx2", 1);
  PluginHost host;
  const auto why = HasSubstr("it is built for avx512, which this processor does not support");
  EXPECT_THAT(message_of([&] { host.model("good"); }), why);
  EXPECT_THAT(message_of([&] { host.add_file(file); }), why);
}

TEST_F(PluginHostTest, AnotherPluginsBuildIsNotTakenForABetterOne) {
  const auto file = put("good", "a", "good.so");
  put("other-avx512", "a", "good.avx512.so");
  PluginHost host;
  host.add_file(file);
  EXPECT_EQ(host.file_of(host.model("good")), file);
}

TEST_F(PluginHostTest, TheEnvironmentLowersTheInstructionSet) {
  setenv("SUTURE_ISA", "base", 1);
  EXPECT_EQ(best_isa(), "");
  setenv("SUTURE_ISA", "avx9", 1);
  EXPECT_THROW(best_isa(), UsageError);
}

// --------------------------------------------------------------------- listing --

TEST_F(PluginHostTest, ListsEveryFileWithoutLoadingAny) {
  put("good", "a", "good.so");
  put("good", "b", "copy.so");
  put("other-major", "b", "other-major.so");
  put("no-note", "b", "no-note.so");
  const PluginHost host;
  const auto list = host.list();
  ASSERT_GE(list.size(), 4u);  // then those of the build tree
  EXPECT_EQ(list[0].plugin, "good");
  EXPECT_EQ(list[0].models, std::vector<std::string>{"good"});
  EXPECT_EQ(list[0].isa, "base");
  EXPECT_EQ(list[0].problem, "");
  EXPECT_THAT(list[1].problem, AllOf(HasSubstr("its model 'good' is hidden by "),
                                     HasSubstr((root / "a" / "good.so").string())));
  EXPECT_THAT(list[2].problem, HasSubstr("it has no Suture note"));
  EXPECT_EQ(list[3].plugin, "other-major");
  EXPECT_THAT(list[3].problem, HasSubstr("built for plugin ABI 7.0"));
  EXPECT_EQ(std::getenv("TEST_PLUGIN_LOADED"), nullptr);
}

}  // namespace
}  // namespace suture
