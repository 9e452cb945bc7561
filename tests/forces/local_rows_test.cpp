// SPDX-License-Identifier: GPL-3.0-or-later
//
// Evaluations around a few cells, compared with those of the whole body.
#include "kernel/forces/local_rows.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "kernel/forces/force_loop.hpp"
#include "tests/forces/spring_model.hpp"

namespace {

using namespace suture;
using namespace spring_model;

TEST(LocalRows, TheEnergyOfAllElementsIsTheEnergy) {
  Worn worn;
  std::vector<Index> all(worn.complex().element_count());
  for (Index e = 0; e < all.size(); ++e) all[e] = e;
  const double energy = worn.models().energy(0);
  ASSERT_GT(energy, 1e-3);
  EXPECT_NEAR(worn.models().energy_around(all, 0), energy, 1e-13 * energy);
  EXPECT_EQ(worn.models().energy_around({}, 0), 0);
}

TEST(LocalRows, AnOperationChangesTheEnergyByTheDifferenceAroundIt) {
  Worn worn;
  for (const Index e : {Index{1}, Index{50}, Index{90}}) {
    const auto& corners = worn.complex().vertices_of(e);
    const auto around = worn.models().elements_around(corners);
    const double energy = worn.models().energy(0), part = worn.models().energy_around(around, 0);
    ASSERT_LT(part, energy);
    worn.pierce({e});
    const double lost = energy - worn.models().energy(0);
    ASSERT_GT(lost, 1e-6);
    EXPECT_NEAR(part - worn.models().energy_around(around, 0), lost, 1e-13 * energy);
  }
}

}  // namespace
