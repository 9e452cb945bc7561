// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/frame_pieces.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "kernel/mesh/box.hpp"
#include "kernel/output/frame_writer.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/output/output.hpp"
#include "tests/output/vtu_oracle.hpp"

namespace suture {
namespace {

namespace fs = std::filesystem;

/// Hexahedra, behind them tetrahedra, and a point without a cell.
Frame mixed_frame() {
  const Mesh mesh = make_box({.cells = {3, 2, 2}});
  Frame frame;
  frame.number = 4;
  frame.time = 0.5;
  frame.points = mesh.points;
  frame.points.push_back({7, 8, 9});
  frame.hexahedra = mesh.hexahedra;
  frame.tetrahedra = {{0, 1, 4, 12}, {5, 1, 4, 12}, {5, 1, 9, 13}};
  frame.point_fields.push_back({"height & width", 3});
  frame.point_fields.push_back({"id", 1, {}, {}, true});
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    const double x = 0.1 * static_cast<double>(i);
    frame.point_fields[0].values.insert(frame.point_fields[0].values.end(), {x, x * x, -x});
    frame.point_fields[1].ids.push_back(static_cast<std::int64_t>(1000 + i));
  }
  frame.cell_fields.push_back({"cauchy stress", 6});
  frame.cell_fields.push_back({.name = "element"});
  for (std::size_t c = 0; c < 15; ++c) {
    frame.cell_fields[0].values.insert(frame.cell_fields[0].values.end(), 6, 1.0 / double(c + 1));
    frame.cell_fields[1].ids.push_back(static_cast<std::int64_t>(c));
  }
  return frame;
}

Frame surface_frame() {
  Frame frame;
  frame.number = 4;
  frame.points = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {1, 2, 0}};
  frame.cells = {{0, 1, 2, none}, {2, 1, 3, none}};
  frame.is_surface = true;
  frame.cell_fields.push_back({.name = "cut", .ids = {0, 1}});
  frame.point_fields.push_back({"height", 1, {0.5, 1, 2, 3}});
  return frame;
}

/// Written by so many processes, one after the other: process 0 is the first one, and the others
/// find the folder that it has made.
void write_in_pieces(const fs::path& folder, const Frame& frame, unsigned processes) {
  for (unsigned p = 0; p < processes; ++p) {
    const OutputFolder::Writers writers{processes, p};
    FrameWriter writer(
        {.folder = std::make_shared<OutputFolder>(folder, fs::path(), writers), .in_pieces = true});
    writer.submit(Frame(frame));
    if (p > 0) writer.finish();
  }
}

/// The numbers of every cell, and of its points, in order.
std::vector<std::vector<double>> by_cell(const VtuContents& contents) {
  std::vector<std::vector<double>> cells;
  const auto add = [&](const auto& arrays, std::size_t row) {
    for (const auto& [name, array] : arrays)
      for (std::size_t c = 0; c < static_cast<std::size_t>(array.components); ++c)
        cells.back().push_back(
            array.values.at(row * static_cast<std::size_t>(array.components) + c));
  };
  for (std::size_t c = 0; c < contents.cells.size(); ++c) {
    cells.push_back({double(contents.types[c])});
    add(contents.cell_arrays, c);
    for (const long point : contents.cells[c]) {
      const auto v = static_cast<std::size_t>(point);
      cells.back().insert(cells.back().end(), contents.points[v].begin(), contents.points[v].end());
      add(contents.point_arrays, v);
    }
  }
  return cells;
}

TEST(FramePieces, VtkOpensThemAsOneFrame) {
  for (const Frame& frame : {mixed_frame(), surface_frame()})
    for (const unsigned processes : {1u, 2u, 3u, 20u}) {
      SCOPED_TRACE(processes);
      const TemporaryFolder folder;
      FrameWriter whole({.folder = output(folder / "whole")});
      whole.submit(Frame(frame));
      whole.finish();
      write_in_pieces(folder / "pieces", frame, processes);
      const std::string end = frame.is_surface ? "vtp" : "vtu";
      const VtuContents expected = read_with_vtk(folder / "whole" / ("frame_0004." + end));
      VtuContents found = read_with_vtk(folder / "pieces" / ("frame_0004.p" + end));
      const std::vector<double> numbers = found.point_arrays.at(point_in_frame).values;
      found.point_arrays.erase(point_in_frame);
      for (std::size_t point = 0; point < numbers.size(); ++point)
        EXPECT_EQ(found.points.at(point),
                  expected.points.at(static_cast<std::size_t>(numbers[point])));
      EXPECT_EQ(by_cell(found), by_cell(expected));
      EXPECT_EQ(found.global_point_ids, expected.global_point_ids);
      EXPECT_EQ(frames_in(folder / "pieces" / "run.pvd"),
                (std::vector<std::string>{"frame_0004.p" + end}));
      if (processes == 1) {
        EXPECT_EQ(found.points, expected.points);
      }
      for (const auto& [name, array] : expected.cell_arrays)
        EXPECT_EQ(found.cell_arrays.at(name).component_names, array.component_names);
    }
}

StateTree saved(Frame frame) {
  StateTree tree;
  save_state(tree, frame);
  return tree;
}

void expect_same(const StateTree& found, const StateTree& expected) {
  ASSERT_EQ(found.arrays.size(), expected.arrays.size());
  for (const auto& [name, array] : expected.arrays) {
    const StateTree::Array& other = found.arrays.at(name);
    ASSERT_EQ(other.size(), array.size()) << name;
    EXPECT_EQ(std::memcmp(other.bytes.get(), array.bytes.get(), array.size()), 0) << name;
  }
  ASSERT_EQ(found.groups.size(), expected.groups.size());
  for (const auto& [name, group] : expected.groups) expect_same(found.groups.at(name), group);
}

TEST(FramePieces, TogetherAreTheFrame) {
  for (const Frame& frame : {mixed_frame(), surface_frame(), Frame()})
    for (const unsigned processes : {1u, 2u, 3u, 20u}) {
      SCOPED_TRACE(processes);
      Frame joined;
      for (unsigned p = 0; p < processes; ++p) add_piece(joined, piece_of(frame, p, processes));
      expect_same(saved(joined), saved(frame));
    }
}

TEST(FramePieces, NoCellIsAPiece) {
  Frame frame;
  frame.cell_fields.push_back({"opened", 1});
  const TemporaryFolder folder;
  write_in_pieces(folder.path(), frame, 3);
  EXPECT_TRUE(read_with_vtk(folder / "frame_0000.pvtu").cells.empty());
  EXPECT_FALSE(fs::exists(folder / "frame_0000_1.vtu"));
}

TEST(FramePieces, PiecesOfAnEarlierRunGo) {
  const TemporaryFolder folder;
  write_in_pieces(folder.path(), mixed_frame(), 3);
  EXPECT_TRUE(fs::exists(folder / "frame_0004_2.vtu"));
  write_in_pieces(folder.path(), mixed_frame(), 2);
  EXPECT_FALSE(fs::exists(folder / "frame_0004_2.vtu"));
  EXPECT_EQ(pieces_in(read_text(folder / "frame_0004.pvtu")),
            (std::vector<std::string>{"frame_0004_0.vtu", "frame_0004_1.vtu"}));
}

}  // namespace
}  // namespace suture
