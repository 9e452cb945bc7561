// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the program reports about a run is true: docs/stability.md.
//   SUTURE_FULL=1                 all trials; otherwise every eighth under loads and every 32nd
//                                 under stresses, fewer where checks are slow
//   SUTURE_STABILITY_SEED=N       other trials
//   SUTURE_STABILITY_CASE=NAME    this one alone
//   SUTURE_STABILITY_OUT=FOLDER   a row per trial in FAMILY.csv, and the scenes of those that
//                                 fail, as files that `suture run` takes (random motions at the
//                                 start of `tangle`, `fall-cut`, `crumble` and `cuts-1000` are
//                                 not in them)
//   SUTURE_STABILITY_ALL=1        the scenes of all
#include <gtest/gtest.h>

#include <fstream>
#include <iostream>
#include <map>
#include <optional>

#include "kernel/base/error.hpp"
#include "tests/base/sanitizer.hpp"
#include "tests/base/variable.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/stability/known_limits.hpp"
#include "tests/stability/runner.hpp"

namespace suture::test {
namespace {

#ifdef NDEBUG
constexpr bool is_slow = !sanitizer.empty();
constexpr unsigned sample = is_slow ? 64 : 8;
#else
constexpr bool is_slow = true;
constexpr unsigned sample = sanitizer.empty() ? 32 : 64;
#endif
constexpr unsigned compared = 4;  ///< each of so many is compared with a smaller step

bool is_chosen(const Family& family, unsigned number, unsigned index) {
  if (const std::string only = value_of_variable("SUTURE_STABILITY_CASE"); !only.empty())
    return only == trial_name(family, index);
  if (!is_slow && !value_of_variable("SUTURE_FULL").empty()) return true;
  if (family.is_stress()) return !family.is_long && (index + number) % (4 * sample) == 0;
  return index % sample == family.name.size() % sample;
}

std::string csv_text(std::string text) {
  text = text.substr(0, 2000);
  for (char& c : text)
    if (c == '"' || c == '\n') c = '\'';
  return '"' + text + '"';
}

class Report {
 public:
  explicit Report(const std::string& family) : folder_(value_of_variable("SUTURE_STABILITY_OUT")) {
    if (folder_.empty()) return;
    std::filesystem::create_directories(folder_);
    csv_.open(folder_ / (family + ".csv"));
    csv_ << "case,verdict,limit,outcome,steps,back,balance,growth,difference,s,model,solver,law,"
            "title,reason,messages\n";
  }

  void add(const Trial& trial, const Result& result, const char* limit) {
    if (folder_.empty()) return;
    std::string messages;
    for (const std::string& message : result.messages) messages += message + " | ";
    csv_ << trial.name << ',' << name_of(result.verdict) << ',' << csv_text(limit ? limit : "")
         << ',' << result.outcome << ',' << result.steps << ',' << result.rollbacks << ','
         << result.balance << ',' << result.growth << ',' << result.difference << ','
         << result.seconds << ',' << trial.model << ',' << trial.solver << ','
         << csv_text(trial.law) << ',' << csv_text(trial.title) << ',' << csv_text(result.reason)
         << ',' << csv_text(messages) << std::endl;
    if (!is_good(result.verdict) || !value_of_variable("SUTURE_STABILITY_ALL").empty()) save(trial);
  }

 private:
  void save(const Trial& trial) {
    Json scene = trial.scene;
    if (!trial.mesh.empty()) {
      scene["mesh"]["file"] = trial.name + ".mesh";
      std::ofstream(folder_ / (trial.name + ".mesh")) << trial.mesh;
    }
    std::ofstream(folder_ / (trial.name + ".json")) << scene.dump(1) << '\n';
  }

  std::filesystem::path folder_;
  std::ofstream csv_;
};

class Stability : public testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Family, Stability, testing::Range(0u, unsigned(families().size())),
                         [](const auto& family) {
                           std::string name = families()[family.param].name;
                           std::erase_if(name, [](char c) { return c == '-' || c == '.'; });
                           return name;
                         });

TEST_P(Stability, SaysWhatIsTrue) {
  const Family& family = families()[GetParam()];
  const std::string given = value_of_variable("SUTURE_STABILITY_SEED");
  const std::uint64_t seed = given.empty() ? 1 : std::stoull(given);
  std::cout << "seed " << seed << '\n';
  std::map<std::string, unsigned> counts;
  std::uint64_t long_runs = 0;
  Report report(family.name);
  for (unsigned index = 0; index < family.size; ++index) {
    if (!is_chosen(family, GetParam(), index)) continue;
    const TemporaryFolder folder;
    Trial trial;
    Result result;
    try {
      trial = make_trial(family, index, seed);
      result = run_trial(trial, folder.path(), index % compared == 0);
    } catch (const Error& error) {
      trial.name = trial_name(family, index);
      result.verdict = Verdict::not_run;
      result.reason = error.what();
    }
    const char* limit = seed == 1 ? known_limit(trial.name) : nullptr;
    report.add(trial, result, limit);
    long_runs += result.steps >= 10'000;
    ++counts[limit && !is_good(result.verdict) ? "known limit" : name_of(result.verdict)];
    if (is_good(result.verdict) || limit) continue;
    ADD_FAILURE() << trial.name << ": " << name_of(result.verdict) << ": " << result.reason
                  << "\n  " << trial.title;
  }
  for (const auto& [verdict, count] : counts)
    std::cout << family.name << ": " << count << ' ' << verdict << '\n';
  std::cout << family.name << ": " << long_runs << " of 10,000 steps or more\n";
}

}  // namespace
}  // namespace suture::test
