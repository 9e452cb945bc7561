// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/archive.hpp"

#include <gtest/gtest.h>

#include "kernel/base/aligned.hpp"
#include "kernel/base/archive_lists.hpp"
#include "kernel/base/error.hpp"
#include "tests/base/same_state.hpp"

namespace suture {
namespace {

enum class Colour { red, blue };

struct Inner {
  double length = 0;
  std::vector<bool> marks;
  void state(Archive& archive) {
    archive("length", length);
    archive("marks", marks);
  }
  bool operator==(const Inner&) const = default;
};

/// One member of every kind.
struct Holder {
  bool flag = false;
  std::uint32_t count = 0;
  std::int64_t big = 0;
  float single = 0;
  Colour colour = Colour::red;
  std::string name;
  std::array<double, 3> place{};
  std::vector<std::array<std::uint32_t, 2>> pairs;
  AlignedVector<double> column;
  std::optional<Inner> maybe;
  std::vector<Inner> many;
  std::vector<std::vector<int>> lists;
  struct Sums {
    double a, b;
    bool operator==(const Sums&) const = default;
  };
  std::vector<Sums> sums;
  std::vector<std::uint32_t> cells;

  void state(Archive& archive) {
    archive("flag", flag);
    archive("count", count);
    archive("big", big);
    archive("single", single);
    archive("colour", colour);
    archive("name", name);
    archive("place", place);
    archive("pairs", pairs);
    archive("column", column);
    archive("maybe", maybe);
    archive("many", many);
    archive("lists", lists);
    archive.rows<double>("sums", sums);
    if (archive.has_cells()) archive("cells", cells);
  }
  bool operator==(const Holder&) const = default;
};

Holder filled() {
  return {true,
          7,
          -(std::int64_t{1} << 40),
          0.5F,
          Colour::blue,
          "a name",
          {1, 2, 3},
          {{1, 2}, {3, 4}},
          AlignedVector<double>{0.1, 0.2},
          Inner{3.5, {true, false, true}},
          {{1, {}}, {2, {true}}},
          {{1, 2}, {}, {3}},
          {{1, 2}, {3, 4}, {5, 6}},
          {9, 8}};
}

TEST(Archive, ATreeGivesBackEveryKindOfValue) {
  Holder given = filled(), found;
  StateTree tree;
  save_state(tree, given);
  load_state(tree, found);
  EXPECT_EQ(found, given);
}

TEST(Archive, ATreeUsesTheMemoryOfASpareOne) {
  Holder given = filled(), found;
  given.column.resize(100, 0.5);
  StateTree first, second;
  save_state(first, given);
  const std::byte* memory = first.arrays.at("column").bytes.get();
  given.column.push_back(1);  // needs a little more
  given.many.resize(3);
  given.name = "a much longer name";
  save_state(second, given, &first);
  load_state(second, found);
  EXPECT_EQ(found, given);
  EXPECT_EQ(second.arrays.at("column").bytes.get(), memory);
}

TEST(Archive, ABufferGivesBackWhatStepsChangeAndLeavesTheCells) {
  Holder given = filled(), found;
  found.cells = {1};
  StateBuffer buffer;
  buffer.save(given);
  buffer.load(found);
  EXPECT_EQ(found.cells, std::vector<std::uint32_t>{1});
  found.cells = given.cells;
  EXPECT_EQ(found, given);
  given = {};
  buffer.save(given);  // again, of another size
  buffer.load(found);
  found.cells.clear();
  EXPECT_EQ(found, given);
}

std::string refusal(const StateTree& tree) {
  Holder holder;
  try {
    load_state(tree, holder);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Archive, WhatIsMissingOrOfAnotherKindIsNamed) {
  Holder given = filled();
  StateTree tree;
  save_state(tree, given);
  StateTree& second = tree.groups.at("many").groups.at("1");
  const auto length = second.arrays.extract("length");
  EXPECT_EQ(refusal(tree), "/many/1: missing entry length");
  second.arrays.emplace("length", StateTree::Array{Archive::Scalar::f32, 1, 1, nullptr});
  EXPECT_EQ(refusal(tree), "/many/1: length has 1 floats per row, expected 1 doubles");
  tree.groups.erase("maybe");
  EXPECT_EQ(refusal(tree), "/: missing entry maybe");
}

TEST(Archive, ACountOfMoreItemsThanThereAreIsRefusedBeforeThereIsMemoryForThem) {
  Holder given = filled();
  StateTree tree;
  save_state(tree, given);
  overwrite(tree.groups.at("many"), "count", 0, std::uint64_t{1} << 40);
  EXPECT_EQ(refusal(tree), "/many: missing entry 2");
  overwrite(tree.groups.at("many"), "count", 0, std::uint64_t{1});
  EXPECT_EQ(refusal(tree), "");
}

TEST(Archive, ListsWhoseEndsDoNotAscendAreRefused) {
  struct Lists {
    std::vector<std::vector<Index>> lists{{1, 2}, {3}, {4, 5}};
    void state(Archive& archive) { archive_lists(archive, "lists", lists); }
  } given, found;
  StateTree tree;
  save_state(tree, given);
  load_state(tree, found);
  EXPECT_EQ(found.lists, given.lists);
  for (const std::uint64_t end : {1, 1000}) {
    overwrite(tree.groups.at("lists"), "ends", 1, end);
    EXPECT_THROW(load_state(tree, found), InputError) << end;
  }
}

TEST(Archive, TwoStatesOfOneNameAreAMistakeOfOurs) {
  struct Twice {
    int a = 0;
    void state(Archive& archive) {
      archive("a", a);
      archive("a", a);
    }
  } twice;
  StateTree tree;
  EXPECT_THROW(save_state(tree, twice), std::logic_error);
}

}  // namespace
}  // namespace suture
