// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/csv_writer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <sstream>

#include "kernel/base/error.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/output/output.hpp"
#include "tests/output/small_files.hpp"

namespace suture {
namespace {

std::vector<std::vector<std::string>> rows_of(const std::filesystem::path& path) {
  std::istringstream text(read_text(path));
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(text, line);) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

TEST(CsvWriter, DoublesMakeTheRoundTripToTheBit) {
  const TemporaryFolder folder;
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  std::vector<std::array<double, 2>> written{{0.1, -0.0},
                                             {std::numeric_limits<double>::denorm_min(), 1e308}};
  while (written.size() < 5000) {
    const double value = std::bit_cast<double>(random());
    if (std::isfinite(value)) written.push_back({value, double(random() % 1000) / 1000});
  }
  {
    CsvWriter table(output(folder / "deeper"), "energies.csv", {"time [s]", "kinetic energy [J]"});
    for (std::size_t i = 0; i < written.size(); ++i) table.row(100000 * i, written[i]);
    table.finish();
  }
  const auto rows = rows_of(folder / "deeper" / "energies.csv");
  ASSERT_EQ(rows.size(), written.size() + 1);
  EXPECT_EQ(rows[0], (std::vector<std::string>{"step", "time [s]", "kinetic energy [J]"}));
  for (std::size_t i = 0; i < written.size(); ++i) {
    ASSERT_EQ(rows[i + 1].size(), 3u);
    EXPECT_EQ(rows[i + 1][0], std::to_string(100000 * i));
    for (int c = 0; c < 2; ++c) {
      const double back = std::strtod(rows[i + 1][c + 1].c_str(), nullptr);
      EXPECT_EQ(std::bit_cast<std::uint64_t>(back), std::bit_cast<std::uint64_t>(written[i][c]));
    }
  }
}

TEST(CsvWriter, QuotesNamesWithCommasAndRefusesRowsOfAnotherLength) {
  const TemporaryFolder folder;
  CsvWriter table(output(folder.path()), "t.csv", {"tip, \"upper\" [m]"});
  EXPECT_THROW(table.row(0, std::array<double, 2>{1, 2}), std::invalid_argument);
  table.row(0, std::array<double, 1>{2});
  table.finish();
  EXPECT_EQ(read_text(folder / "t.csv"), "step,\"tip, \"\"upper\"\" [m]\"\n0,2\n");
}

TEST(CsvWriter, WithoutRowsAnOlderTableStays) {
  const TemporaryFolder folder;
  CsvWriter(output(folder.path()), "t.csv", {"a"}).row(7, std::array<double, 1>{0.5});
  { CsvWriter unused(output(folder.path()), "t.csv", {"b"}); }
  EXPECT_EQ(read_text(folder / "t.csv"), "step,a\n7,0.5\n");
}

TEST(CsvWriter, NothingIsLostWithoutFinish) {
  const TemporaryFolder folder;
  { CsvWriter(output(folder.path()), "t.csv", {"a"}).row(7, std::array<double, 1>{0.5}); }
  EXPECT_EQ(read_text(folder / "t.csv"), "step,a\n7,0.5\n");
}

TEST(CsvWriter, AFullDiskIsReported) {
  const TemporaryFolder folder;
  CsvWriter table(output(folder.path()), "t.csv", {"a"});
  for (int step = 0; step < 1000; ++step) table.row(step, std::array<double, 1>{1});
  const SmallFiles limit(1000);
  try {
    table.finish();
    FAIL() << "no error";
  } catch (const IoError& error) {
    EXPECT_EQ(std::string(error.what()),
              (folder / "t.csv").string() + ": cannot be written: " + too_large);
  }
}

TEST(CsvWriter, AFileInPlaceOfTheFolderIsReported) {
  const TemporaryFolder folder;
  folder.write("out", "x");
  CsvWriter table(output(folder / "out"), "t.csv", {"a"});
  table.row(0, std::array<double, 1>{1});
  EXPECT_THROW(table.finish(), IoError);
}

StateTree state_of(CsvWriter& table) {
  StateTree tree;
  save_state(tree, table);
  return tree;
}

/// Rows of steps [first, last).
void rows(CsvWriter& table, std::uint64_t first, std::uint64_t last) {
  for (std::uint64_t step = first; step < last; ++step)
    table.row(step, std::array<double, 2>{0.1 * double(step), 1 / (1 + double(step))});
}

TEST(CsvWriter, GoesOnWhereTheCheckpointWas) {
  const TemporaryFolder folder;
  const std::vector<std::string> columns{"a", "b, c"};
  std::string expected;
  {
    CsvWriter table(output(folder.path()), "t.csv", columns);
    rows(table, 0, 9000);
    table.finish();
    expected = read_text(folder / "t.csv");
  }
  for (const std::uint64_t at : {0, 1, 100, 5000, 9000}) {
    StateTree state;
    {
      CsvWriter table(output(folder.path()), "t.csv", columns);
      rows(table, 0, at);
      state = state_of(table);
      if (at != 0) {
        EXPECT_EQ(read_text(folder / "t.csv"),
                  expected.substr(0, read_text(folder / "t.csv").size()))
            << "the rows are on the disk";
      }
      rows(table, at, 8000);
      table.row(77, std::array<double, 2>{7, 7});
    }
    const std::string before = read_text(folder / "t.csv");
    for (int round = 0; round < 2; ++round) {
      CsvWriter table(output(folder.path()), "t.csv", columns);
      load_state(state, table);
      if (round == 0) {
        EXPECT_EQ(read_text(folder / "t.csv"), before) << "not before there are rows";
      }
      rows(table, at, 9000);
      table.finish();
      EXPECT_EQ(read_text(folder / "t.csv"), expected) << at << ", round " << round;
    }
  }
}

TEST(CsvWriter, ResumedWithoutRowsItCutsAtTheEndOnly) {
  const TemporaryFolder folder;
  StateTree state;
  {
    CsvWriter table(output(folder.path()), "t.csv", {"a", "b"});
    rows(table, 0, 3);
    state = state_of(table);
    rows(table, 3, 5);
  }
  const std::string before = read_text(folder / "t.csv");
  {
    CsvWriter table(output(folder.path()), "t.csv", {"a", "b"});
    load_state(state, table);
  }
  EXPECT_EQ(read_text(folder / "t.csv"), before) << "a run that failed before it went on";
  {
    CsvWriter table(output(folder.path()), "t.csv", {"a", "b"});
    load_state(state, table);
    const StateTree again = state_of(table);
    EXPECT_EQ(again.arrays.size(), state.arrays.size());
    table.finish();
  }
  EXPECT_EQ(rows_of(folder / "t.csv").size(), 4u);
}

TEST(CsvWriter, ATableThatIsNotTheOneIsRefused) {
  const TemporaryFolder folder;
  StateTree state;
  {
    CsvWriter table(output(folder.path()), "t.csv", {"a", "b"});
    rows(table, 0, 3);
    state = state_of(table);
  }
  const std::string whole = read_text(folder / "t.csv"), name = (folder / "t.csv").string();
  const std::string end = ", but the checkpoint continues after byte " +
                          std::to_string(whole.size()) +
                          " of it; restore the file, or start the run again from the beginning";
  const auto refusal = [&] {
    CsvWriter table(output(folder.path()), "t.csv", {"a", "b"});
    try {
      load_state(state, table);
      return std::string();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
  };
  EXPECT_EQ(refusal(), "");
  folder.write("t.csv", whole.substr(0, 12));
  EXPECT_EQ(refusal(), name + ": has 12 bytes" + end);
  folder.write("t.csv", "step,a,c\n" + whole.substr(9));
  EXPECT_EQ(refusal(), name + ": is not the table of this run" + end);
  folder.write("t.csv", whole.substr(0, whole.size() - 1) + "0\n");
  EXPECT_EQ(refusal(), name + ": is not the table of this run" + end);
  EXPECT_EQ(read_text(folder / "t.csv"), whole.substr(0, whole.size() - 1) + "0\n");
  std::filesystem::remove(folder / "t.csv");
  EXPECT_EQ(refusal(), name + ": is missing" + end);
  EXPECT_FALSE(std::filesystem::exists(folder / "t.csv"));
}

}  // namespace
}  // namespace suture
