// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/column.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <cstdint>
#include <random>

#include "kernel/attributes/table.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/out_of_memory.hpp"
#include "tests/base/sanitizer.hpp"

namespace suture {
namespace {

ColumnSpec spec(int components, double initial = 0, std::uint32_t flags = 0) {
  ColumnSpec s;
  s.name = "c";
  s.components = components;
  s.initial = initial;
  s.flags = flags;
  return s;
}

TEST(Column, VertexVectorsLieInAlignedRowsOfFour) {
  Column column(spec(3, 2.5), 0);
  column.resize(5);
  ASSERT_EQ(column.stride(), 4);
  EXPECT_FALSE(column.is_constant());
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(column.rows()) % SUTURE_ALIGNMENT, 0u);
  column.set(3, 1, 7);
  EXPECT_EQ(column.rows()[3 * 4 + 1], 7);
  EXPECT_EQ(column.rows()[3 * 4 + 0], 2.5);
  EXPECT_EQ(column.rows()[3 * 4 + 3], 0);
  EXPECT_EQ(Column(spec(1), 0).stride(), 1);
  EXPECT_EQ(Column(spec(6), 0).stride(), 6);
}

TEST(Column, RowsThatComeBackHaveTheInitialValue) {
  for (const double initial : {0.0, -0.0, 2.5}) {
    Column column(spec(3, initial), 0);
    column.resize(9);
    column.fill(7);
    column.resize(4);
    column.resize(9);
    for (Index row = 0; row < 9; ++row) {
      EXPECT_EQ(column.get(row, 1), row < 4 ? 7 : initial);
      EXPECT_EQ(std::signbit(column.get(row, 1)), row >= 4 && std::signbit(initial));
    }
  }
}

TEST(Column, RoomIsMadeWithoutRowsAndKeepsAllValues) {
  for (const int dimension : {0, 1}) {
    Column column(spec(3, 2.5, SUTURE_TRIAL), dimension);
    column.resize(11);
    for (Index row = 0; row < 11; ++row)
      for (int c = 0; c < 3; ++c) column.set(row, c, 10 * row + c);
    column.make_room(5000);
    ASSERT_EQ(column.size(), 11u);
    const double* const before = dimension == 0 ? column.rows() : column.block(0);
    column.resize(5011);
    EXPECT_EQ(dimension == 0 ? column.rows() : column.block(0), before);
    for (Index row = 0; row < 11; ++row)
      for (int c = 0; c < 3; ++c) ASSERT_EQ(column.get(row, c), 10 * row + c);
    for (Index row = 11; row < 5011; ++row) {
      ASSERT_EQ(column.get(row, 2), 2.5);
      ASSERT_EQ(column.trial(row, 2), 2.5);
    }
  }
  Column constant(spec(1, 4), 1);
  constant.resize(3);
  constant.make_room(100);
  EXPECT_TRUE(constant.is_constant());
}

TEST(Column, CellsLieInBlocksOfEightLanesFastest) {
  Column column(spec(2), 1);
  column.resize(19);
  for (Index row = 0; row < 19; ++row)
    for (int c = 0; c < 2; ++c) column.set(row, c, 100 * row + c + 1.0);
  for (Index row = 0; row < 19; ++row)
    for (int c = 0; c < 2; ++c) {
      const Column& read = column;
      EXPECT_EQ(read.block(row / 8)[c * 8 + static_cast<int>(row % 8)], 100 * row + c + 1.0);
      EXPECT_EQ(read.get(row, c), 100 * row + c + 1.0);
    }
}

/// The law of padding: lanes behind the last row repeat it, whatever was done.
void expect_padded(Column& column, const double* first_block) {
  if (column.size() == 0) return;
  const Index last = column.size() - 1;
  for (Index lane = last % 8; lane < 8; ++lane)
    for (int c = 0; c < column.spec().components; ++c)
      EXPECT_EQ(first_block[column.offset(last) - last % 8 + static_cast<Index>(c) * 8 + lane],
                first_block[column.offset(last) + static_cast<Index>(c) * 8])
          << "row " << last << " lane " << lane;
}

TEST(Column, MirrorsAPlainArrayUnderRandomOperationsAndStaysPadded) {
  const std::uint64_t seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  for (const int dimension : {0, 1, 3})
    for (const std::uint32_t flags : {0u, static_cast<std::uint32_t>(SUTURE_TRIAL)}) {
      Column column(spec(3, 4, flags), dimension);
      std::vector<std::array<double, 3>> oracle;
      for (int step = 0; step < 3000; ++step) {
        const auto any = [&] { return static_cast<Index>(random() % oracle.size()); };
        switch (oracle.empty() ? 0 : random() % 6) {
          case 0: {
            const std::array<double, 3> next = {column.is_constant() && !oracle.empty()
                                                    ? oracle[0]
                                                    : std::array<double, 3>{4, 4, 4}};
            oracle.resize(oracle.size() + random() % 3, next);
            column.resize(static_cast<Index>(oracle.size()));
            break;
          }
          case 1: {
            const Index row = any();
            const int c = static_cast<int>(random() % 3);
            const double value = static_cast<double>(random() % 3);
            column.set(row, c, value);
            oracle[row][static_cast<std::size_t>(c)] = value;
            break;
          }
          case 2: {
            std::vector<RowSplit> splits;
            for (std::size_t left = random() % 20 == 0 ? 300 : 1; left != 0; --left)
              splits.push_back({any(), static_cast<Index>(oracle.size() + splits.size())});
            column.append_copies(splits);
            for (const RowSplit& split : splits) oracle.push_back(oracle[split.old_row]);
            break;
          }
          case 3: {
            const Index row = any();
            column.scale_row(row, 0.5);
            for (double& v : oracle[row]) v *= 0.5;
            break;
          }
          case 4:
            column.compress(0);
            break;
          default:
            if (random() % 20 == 0) {
              column.fill(4);
              for (auto& v : oracle) v = {4, 4, 4};
            }
        }
        ASSERT_EQ(column.size(), oracle.size());
        if (dimension != 0 && !column.is_constant()) {
          expect_padded(column, column.block(0));
          if (column.has_trial()) expect_padded(column, column.trial_block(0));
        }
      }
      for (Index row = 0; row < column.size(); ++row)
        for (int c = 0; c < 3; ++c)
          ASSERT_EQ(column.get(row, c), oracle[row][static_cast<std::size_t>(c)]);
    }
}

TEST(Column, ConstantColumnStoresOneBlockUntilAValueDiffers) {
  Column column(spec(2, 3), 3);
  column.resize(1000);
  const Column& read = column;
  EXPECT_TRUE(column.is_constant());
  EXPECT_EQ(read.block(0), read.block(100));
  column.set(500, 1, 3);
  EXPECT_TRUE(column.is_constant());
  column.set(500, 1, 4);
  EXPECT_FALSE(column.is_constant());
  EXPECT_NE(read.block(0), read.block(100));
  EXPECT_EQ(column.get(500, 1), 4);
  EXPECT_EQ(column.get(500, 0), 3);
  EXPECT_EQ(column.get(999, 1), 3);
  EXPECT_FALSE(column.compress(1e-13));
  column.set(500, 1, 3);
  EXPECT_TRUE(column.compress(0));
}

TEST(Column, CompressKeepsEveryValueWithinItsBound) {
  const double bound = 1e-13;
  for (const double deviation : {0.9e-13, 1.1e-13}) {
    Column column(spec(2), 3);
    column.resize(20);
    for (Index row = 0; row < 20; ++row) {
      column.set(row, 0, 1e3);
      column.set(row, 1, -5);
    }
    column.set(13, 1, -5 + deviation * 1e3);  // relative to the column, not to the row
    EXPECT_EQ(column.compress(bound), deviation < bound);
    for (Index row = 0; row < 20; ++row) {
      EXPECT_EQ(column.get(row, 0), 1e3);
      EXPECT_NEAR(column.get(row, 1), -5 + (row == 13 ? deviation * 1e3 : 0), bound * 1e3);
    }
  }
  Column nan(spec(1), 3);
  nan.resize(9);
  nan.set(0, 0, std::nan(""));
  EXPECT_FALSE(nan.compress(1e-13));
}

TEST(Column, TrialValuesBecomeTheValuesWhenAccepted) {
  Column column(spec(1, 1, SUTURE_TRIAL), 2);
  column.resize(11);
  EXPECT_FALSE(column.is_constant());
  for (Index b = 0; b < column.block_count(); ++b)
    for (Index lane = 0; lane < 8; ++lane) column.trial_block(b)[lane] = 10.0 * b + lane;
  EXPECT_EQ(column.get(9, 0), 1);
  column.accept();
  EXPECT_EQ(column.get(9, 0), 11);
  const RowSplit split{9, 11};
  column.append_copies({&split, 1});
  EXPECT_EQ(column.get(11, 0), 11);
  EXPECT_EQ(column.trial_block(1)[3], 1);  // the trial copy follows too
}

TEST(Column, HandsItsMemoryOverAndGoesOnWithACopy) {
  Column column(spec(3), 0);
  column.resize(5);
  column.set(4, 2, 7);
  const double* before = column.rows();
  const auto kept = column.hand_over();
  EXPECT_EQ(kept.data(), before);
  EXPECT_NE(column.rows(), before);
  column.set(4, 2, 8);
  EXPECT_EQ(kept[4 * 4 + 2], 7);
  EXPECT_EQ(column.get(4, 2), 8);
  const double* after = column.rows();
  column.resize(8);  // in the reserve
  EXPECT_EQ(column.rows(), after);
}

TEST(CellSet, RowsOfARegionAppendAndRename) {
  CellSet set = CellSet::of({4, 2, 7}, 9);
  EXPECT_FALSE(set.is_all());
  EXPECT_EQ(set.row(2), 1u);
  EXPECT_EQ(set.row(3), none);
  set.append(9);
  EXPECT_EQ(set.row(9), 3u);
  EXPECT_EQ(set.cell(3), 9u);
  set.rename(2, 10);
  EXPECT_EQ(set.row(2), none);
  EXPECT_EQ(set.row(10), 1u);
  EXPECT_EQ(set.cell(1), 10u);
  EXPECT_EQ(set.size(), 4u);
  EXPECT_EQ(set.row(1000), none);

  CellSet all = CellSet::all(5);
  all.append_all(1);
  EXPECT_EQ(all.row(5), 5u);
  EXPECT_EQ(all.size(), 6u);
}

TEST(Column, SaysWhatItNeedsWhenMemoryIsShort) {
  if (!test::sanitizer.empty()) return;  // they reserve more addresses than any limit leaves
  Column column(spec(3), 0);
  column.resize(5);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  const rlimit two_gigabytes{rlim_t{2} << 30, before.rlim_max};
  std::string said;
  ASSERT_EQ(setrlimit(RLIMIT_AS, &two_gigabytes), 0);
  try {
    column.resize(100'000'000);
  } catch (const OutOfMemory& error) {
    said = error.what();
  }
  ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
  EXPECT_EQ(said, "column 'c' needs 6400 MB");
  EXPECT_EQ(column.size(), 5u);
}

TEST(Table, RefusesTwoColumnsOfOneName) {
  Table table;
  table.cells = CellSet::all(3);
  EXPECT_EQ(table.add(spec(1)).size(), 3u);
  EXPECT_THROW(table.add(spec(2)), InputError);
  EXPECT_EQ(table.find("nothing"), nullptr);
}

}  // namespace
}  // namespace suture
