// SPDX-License-Identifier: GPL-3.0-or-later
//
// The step after an operation: at most the previous stable step and at most the bound around the
// changed cells, it must stay below the stable step of the whole body as found by a search from a
// random start. Cuts, tears, holes and sutures on bodies in random states.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <random>

#include "kernel/build/built_scene.hpp"
#include "kernel/spectrum/step_search.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

struct Case {
  const char* name;
  const char* model;
  std::map<std::string, double> values;
};

/// A run of operations on one random body.
class Surgery {
 public:
  Surgery(const Case& model, unsigned seed)
      : random_(seed),
        scene_(beam(host(), model.model, 3 + random_() % 5, 2 + random_() % 3, 10, model.values)),
        built_(scene_, diagnostics_) {
    built_.dynamics().start();
    Column& position = built_.body().attributes().position();
    const double stretch = 1 + 0.3 * number(), amount = 0.01 * std::abs(number());
    for (Index v = 0; v < built_.body().attributes().vertex_count(); ++v) {
      position.set(v, 0, stretch * position.get(v, 0));
      for (int c = 0; c < 3; ++c) {
        position.set(v, c, position.get(v, c) + amount * number());
        built_.body().attributes().velocity().set(v, c, 0.1 * number());
      }
    }
    built_.dynamics().start(built_.dynamics().time());
    known_ = built_.limits().stable_step(built_.dynamics().time());
  }

  /// One operation. Returns what is taken for stable over what is.
  double operate() {
    const char* const kinds[] = {"cut", "tear", "pierce", "sew"};
    kind_ = kinds[random_() % 4];
    bool done = false;
    if (kind_ == std::string("pierce")) {
      done = pierce();
    } else if (kind_ == std::string("sew")) {
      done = sew();
    } else {
      done = open(kind_ == std::string("tear"));
    }
    const double local = built_.limits().bounds_of_changes(0).dt;
    if (!done) return 0;
    lowered_ += local < known_;
    const double taken = std::min(known_, local);
    followed_ =
        built_.limits().stable_step(built_.dynamics().time());  // continues from the previous mode
    known_ = StepSearch(built_.body()).largest(0);
    return taken / known_;
  }
  const std::string& kind() const { return kind_; }
  /// The search that followed the operation over the one from random.
  double followed() const { return known_ > 0 ? followed_ / known_ : 0; }
  int lowered() const { return lowered_; }  ///< operations that lowered the step

 private:
  double number() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  CellComplex& complex() { return built_.body().complex(); }
  Index element() { return random_() % complex().element_count(); }

  bool open(bool around_a_vertex) {
    std::vector<Dart> faces;
    for (unsigned tries = 0; tries < 40 && faces.size() < 1 + random_() % 6; ++tries) {
      const Dart dart = 24 * element() + random_() % 24;
      if (complex().exists(3, dart / 24) && complex().can_cut(dart)) faces.push_back(dart);
    }
    if (around_a_vertex && !faces.empty()) {
      const Dart at = faces[0];
      faces.clear();
      std::vector<Dart> star;
      complex().star(0, complex().origin(at), star);
      for (const Dart d : star)
        for (Dart f = 0; f < 6; ++f)
          if (const Dart face = d / 24 * 24 + 4 * f; complex().can_cut(face)) faces.push_back(face);
    }
    if (faces.empty()) return false;
    for (const Dart d : faces) cut_.push_back({d / 4 * 4, complex().beta3(d / 4 * 4)});
    built_.body().cut(faces);
    return true;
  }
  bool pierce() {
    std::vector<Index> gone;
    for (unsigned i = 0; i < 1 + random_() % 3; ++i)
      if (const Index e = element(); complex().exists(3, e)) gone.push_back(e);
    if (gone.empty() || complex().existing(3) < 12) return false;
    built_.body().pierce(gone);
    return true;
  }
  bool sew() {
    std::vector<Seam> seams;
    while (!cut_.empty() && seams.empty()) {
      const Seam seam = cut_.back();
      cut_.pop_back();
      const bool there = complex().exists(3, seam.one / 24) && complex().exists(3, seam.other / 24);
      if (there && complex().can_sew(seam.one, seam.other)) seams.push_back(seam);
    }
    if (seams.empty()) return false;
    built_.body().sew(seams);
    return true;
  }

  std::mt19937 random_;
  Scene scene_;
  Diagnostics diagnostics_;
  BuiltScene built_;
  std::vector<Seam> cut_;
  double known_ = 0, followed_ = 0;
  int lowered_ = 0;
  std::string kind_;
};

class LocalBound : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Models, LocalBound,
                         testing::Values(Case{"tm", "tm-faure", {}}, Case{"ms", "mss-baudet", {}},
                                         Case{"viscous", "mss-baudet", {{"viscosity", 1}}}),
                         [](const auto& model) { return std::string(model.param.name); });

TEST_P(LocalBound, StaysBelowTheStableStepAfterAnyOperation) {
  const int bodies = std::getenv("SUTURE_FULL") != nullptr ? 60 : 6;
  const char* given = std::getenv("SUTURE_SEED");
  const unsigned seed = given ? static_cast<unsigned>(std::atoi(given)) : std::random_device{}();
  const testing::ScopedTrace trace(__FILE__, __LINE__, "seed " + std::to_string(seed));
  std::map<std::string, int> made;
  std::map<std::string, double> largest;
  int lowered = 0;
  for (int body = 0; body < bodies; ++body) {
    Surgery surgery(GetParam(), seed + static_cast<unsigned>(body));
    for (int i = 0; i < 10; ++i) {
      const double ratio = surgery.operate();
      // What the default safety of 0.8 leaves, for a search that is not from random.
      ASSERT_LT(surgery.followed(), 1.25) << surgery.kind();
      made[surgery.kind()] += ratio > 0;
      largest[surgery.kind()] = std::max(largest[surgery.kind()], ratio);
      // The searches before and after are right to 1.5 %, where viscosity limits the step
      // to 3 %. Of about 12,000 operations one came to 1.031, and there the
      // search before was too long, by a dense solver.
      ASSERT_LT(ratio, 1.05) << surgery.kind() << ", body " << body << ", operation " << i;
    }
    lowered += surgery.lowered();
  }
  EXPECT_GT(lowered, bodies);
  for (const auto& [kind, count] : made) {
    RecordProperty(kind, std::to_string(largest[kind]));
    EXPECT_GT(count, 0) << kind;
  }
}

}  // namespace
}  // namespace suture::test
