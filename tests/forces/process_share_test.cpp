// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which process of several sums the forces on a vertex, and which steps it.
#include "kernel/processes/process_share.hpp"

#include <gtest/gtest.h>

#include "kernel/base/zeroed_vector.hpp"
#include "kernel/topology/import.hpp"
#include "tests/topology/meshes.hpp"

namespace suture::test {
namespace {

/// One of three processes that hear nothing of each other.
class Alone final : public Communicator {
 public:
  explicit Alone(unsigned rank) : rank_(rank) {}
  unsigned rank() const override { return rank_; }
  unsigned size() const override { return 3; }
  void gather(std::span<const double>, std::span<const int>, double*) override {}
  void complete(double*, std::span<const int>) override {}
  void collect(std::span<const double>, std::span<const int>, double*) override {}
  std::vector<std::string> gather(const std::string& mine) override { return {mine, mine, mine}; }
  std::vector<std::vector<std::uint32_t>> swap(
      const std::vector<std::vector<std::uint32_t>>&) override {
    return std::vector<std::vector<std::uint32_t>>(3);
  }
  void swap(std::span<const Parcel>, std::span<Parcel>) override {}
  const Traffic& traffic() const override { return traffic_; }
  int largest(int mine) override { return mine; }
  void meet_error() override {}
  bool all_meet_error() override { return true; }
  [[noreturn]] void abort(int code) override { std::exit(code); }

 private:
  unsigned rank_;
  Traffic traffic_;
};

constexpr Index block = 4 * BodyShare::block;

class ProcessShares : public ::testing::Test {
 protected:
  ProcessShares() { expect_division(); }

  /// Every vertex has one process that sums its forces. Those of whole blocks have one that steps
  /// them, and all have as many elements, and about as many blocks.
  void expect_division() {
    std::vector<int> sums(complex_.count(0)), steps(complex_.count(0));
    for (ProcessShare& share : shares_) {
      const std::vector<bool> others = share.others(complex_);
      Index own = 0;
      for (Index v = 0; v < others.size(); ++v) sums[v] += !others[v];
      for (const auto& [begin, end] : share.own())
        for (Index v = begin; v < end; ++v, ++own) ++steps[v];
      EXPECT_EQ(share.common_begin(), complex_.count(0) / block * block);
      EXPECT_NEAR(own, share.common_begin() / 3., 1.5 * block);
      int elements = 0;
      const auto [first, end] = share.elements();
      for (Index e = first; e < std::min(end, complex_.count(3)); ++e)
        elements += complex_.exists(3, e);
      EXPECT_NEAR(elements, complex_.existing(3) / 3, 1);
    }
    for (Index v = 0; v < complex_.count(0); ++v) {
      ASSERT_EQ(sums[v] == 1 || !complex_.exists(0, v), true) << v;
      ASSERT_EQ(steps[v], v < shares_[0].common_begin() ? 1 : 0) << v;
    }
  }

  void follow() {
    for (ProcessShare& share : shares_) share.follow(complex_);
    expect_division();
  }

  Diagnostics diagnostics_;
  CellComplex complex_ = import_mesh(meshes::grid(30, 30, 30), {}, diagnostics_).complex;
  std::array<Alone, 3> processes_{Alone(0), Alone(1), Alone(2)};
  std::array<ProcessShare, 3> shares_{ProcessShare(processes_[0], 1, complex_),
                                      ProcessShare(processes_[1], 1, complex_),
                                      ProcessShare(processes_[2], 1, complex_)};
};

TEST_F(ProcessShares, TakeTheVerticesOfCuts) {
  for (const int face : {0, 2}) {
    std::vector<Dart> faces;
    for (Index e = 0; e < complex_.count(3); ++e)
      if (complex_.can_cut(face_dart(e, face))) faces.push_back(face_dart(e, face));
    complex_.cut(faces);
    follow();
  }
}

TEST_F(ProcessShares, AreEqualAfterARemoval) {
  std::vector<Index> elements;
  for (Index e = 0; e < 8000; ++e) elements.push_back(e);
  complex_.pierce(elements);
  follow();
}

/// Rows that a process does not read take no memory; all others keep their values.
TEST_F(ProcessShares, ReleaseTheRowsOfOthers) {
  const Index vertices = complex_.count(0);
  for (ProcessShare& share : shares_) {
    std::vector<bool> read(vertices);
    for (Index v = 0; v < vertices; v += v % 2 == 0 ? 1 : 4095) read[v] = true;
    share.read(read);
    std::vector<bool> is_known = read;
    for (const auto& [begin, end] : share.own())
      std::fill(is_known.begin() + begin, is_known.begin() + end, true);
    for (Index v = share.common_begin(); v < vertices; ++v) is_known[v] = true;
    std::vector<bool> said(vertices);
    for (const auto& [begin, end] : share.known())
      std::fill(said.begin() + begin, said.begin() + end, true);
    EXPECT_EQ(said, is_known);
    for (const std::size_t width : {3, 4}) {
      ZeroedVector<double> rows(width * vertices, 1);
      share.release({rows.data(), width});
      for (Index v = 0; v < vertices; ++v)
        for (std::size_t c = 0; c < width && is_known[v]; ++c) ASSERT_EQ(rows[width * v + c], 1);
      const auto zeros = std::ranges::count(rows, 0);
      EXPECT_GT(zeros, 0.5 * width * std::ranges::count(is_known, false));
    }
  }
}

}  // namespace
}  // namespace suture::test
