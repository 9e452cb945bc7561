// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/frame_writer.hpp"

#include <gtest/gtest.h>

#include <random>

#include "kernel/base/error.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/output/output.hpp"
#include "tests/output/small_files.hpp"
#include "tests/output/vtu_oracle.hpp"

namespace suture {
namespace {

namespace fs = std::filesystem;
using Compression = FrameWriterOptions::Compression;

std::vector<double> random_values(std::size_t n, std::mt19937_64& random) {
  std::normal_distribution<double> normal(0, 1e-3);
  std::vector<double> values(n);
  for (double& value : values) value = normal(random);
  return values;
}

Frame box_frame(std::uint64_t number, std::array<Index, 3> cells = {3, 4, 5}) {
  const Mesh mesh = make_box({.cells = cells});
  std::mt19937_64 random(number);
  Frame frame;
  frame.number = number;
  frame.time = 0.1 * double(number);
  frame.points = mesh.points;
  frame.hexahedra = mesh.hexahedra;
  frame.point_fields.push_back({"displacement", 3, random_values(3 * mesh.points.size(), random)});
  frame.point_fields.push_back({"id", 1, {}, {}, true});
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    frame.point_fields[1].ids.push_back(std::int64_t(1'000'000'000'000 + i));
  }
  frame.cell_fields.push_back(
      {"cauchy stress", 6, random_values(6 * mesh.hexahedra.size(), random)});
  frame.field_data_provenance = "scene 1234, suture 0.1.0, 2 threads; a <tag> & \"quotes\"";
  return frame;
}

void expect_same(const VtuContents& contents, const Frame& frame) {
  EXPECT_EQ(contents.points, frame.points);
  ASSERT_EQ(contents.cells.size(), frame.hexahedra.size());
  for (std::size_t e = 0; e < frame.hexahedra.size(); ++e) {
    const Hexahedron& x = frame.hexahedra[e];
    EXPECT_EQ(contents.types[e], 12);
    EXPECT_EQ(contents.cells[e],
              (std::vector<long>{x[0], x[1], x[3], x[2], x[4], x[5], x[7], x[6]}));
  }
  EXPECT_EQ(contents.point_arrays.at("displacement").values, frame.point_fields[0].values);
  EXPECT_EQ(contents.cell_arrays.at("cauchy stress").values, frame.cell_fields[0].values);
  const std::vector<double> ids(frame.point_fields[1].ids.begin(), frame.point_fields[1].ids.end());
  EXPECT_EQ(contents.point_arrays.at("id").values, ids);
  EXPECT_EQ(contents.field_arrays.at("TimeValue").values, (std::vector<double>{frame.time}));
  EXPECT_EQ(contents.provenance, frame.field_data_provenance);
  EXPECT_EQ(contents.global_point_ids, "id");
}

class EveryCompression : public testing::TestWithParam<Compression> {};

TEST_P(EveryCompression, VtkReadsBackTheSameBits) {
  const TemporaryFolder folder;
  FrameWriter writer({.folder = output(folder.path()), .compression = GetParam()});
  writer.submit(box_frame(7));
  writer.finish();
  const VtuContents contents = read_with_vtk(folder / "frame_0007.vtu");
  expect_same(contents, box_frame(7));
  EXPECT_EQ(contents.cell_arrays.at("cauchy stress").component_names,
            (std::vector<std::string>{"XX", "YY", "ZZ", "XY", "YZ", "XZ"}));
  const std::string text = read_text(folder / "frame_0007.vtu");
  EXPECT_NE(text.find("<AppendedData encoding=\"raw\">"), text.npos);
  EXPECT_EQ(text.find("vtkLZ4DataCompressor") != text.npos, GetParam() == Compression::lz4);
  EXPECT_EQ(text.find("vtkZLibDataCompressor") != text.npos, GetParam() == Compression::zlib);
}

TEST_P(EveryCompression, ReadMeshFindsTheBodyAndItsIds) {
  const TemporaryFolder folder;
  FrameWriter writer({.folder = output(folder.path()), .compression = GetParam()});
  writer.submit(box_frame(0));
  writer.finish();
  Diagnostics diagnostics;
  const Mesh mesh = read_mesh(folder / "frame_0000.vtu", 1, diagnostics);
  const Frame frame = box_frame(0);
  EXPECT_EQ(mesh.points, frame.points);
  EXPECT_EQ(mesh.hexahedra, frame.hexahedra);
  ASSERT_EQ(mesh.point_ids.size(), mesh.points.size());
  EXPECT_EQ(mesh.point_ids[5], 1'000'000'000'005u);
  EXPECT_TRUE(diagnostics.warnings().empty());
}

std::string name_of(const testing::TestParamInfo<Compression>& tested) {
  switch (tested.param) {
    case Compression::raw:
      return "Raw";
    case Compression::lz4:
      return "Lz4";
    case Compression::zlib:
      return "Zlib";
  }
  return "";
}

INSTANTIATE_TEST_SUITE_P(FrameWriter, EveryCompression,
                         testing::Values(Compression::raw, Compression::lz4, Compression::zlib),
                         name_of);

TEST(FrameWriter, WritesSurfacesAsPolygons) {
  const TemporaryFolder folder;
  Frame frame;
  frame.points = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {1, 2, 0}};
  frame.cells = {{0, 1, 2, none}, {2, 1, 3, none}};
  frame.is_surface = true;
  frame.cell_fields.push_back({.name = "cut", .ids = {0, 1}});
  frame.point_fields.push_back({"height", 1, {0.5, 1, 2, 3}});
  FrameWriter writer(
      {.folder = output(folder.path()), .prefix = "surface", .collection = "surface"});
  writer.submit(std::move(frame));
  writer.finish();
  EXPECT_EQ(frames_in(folder / "surface.pvd"), (std::vector<std::string>{"surface_0000.vtp"}));
  EXPECT_NE(read_text(folder / "surface_0000.vtp").find("type=\"PolyData\""), std::string::npos);
  const VtuContents contents = read_with_vtk(folder / "surface_0000.vtp");
  EXPECT_EQ(contents.cells, (std::vector<std::vector<long>>{{0, 1, 2}, {2, 1, 3}}));
  EXPECT_EQ(contents.cell_arrays.at("cut").values, (std::vector<double>{0, 1}));
  EXPECT_EQ(contents.point_arrays.at("height").values, (std::vector<double>{0.5, 1, 2, 3}));
}

TEST(FrameWriter, WritesLinesTrianglesAndQuadrilaterals) {
  const TemporaryFolder folder;
  Frame frame;
  frame.points = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {1, 2, 0}};
  frame.cells = {{0, 1, none, none}, {2, 0, 1, none}, {0, 1, 3, 2}};
  frame.cell_fields.push_back({"strain", 1, {0.25, -0.5, 1}});
  FrameWriter writer(
      {.folder = output(folder.path()), .prefix = "springs", .collection = "springs"});
  writer.submit(std::move(frame));
  writer.finish();
  const VtuContents contents = read_with_vtk(folder / "springs_0000.vtu");
  EXPECT_EQ(contents.types, (std::vector<int>{3, 5, 9}));
  EXPECT_EQ(contents.cells, (std::vector<std::vector<long>>{{0, 1}, {2, 0, 1}, {0, 1, 3, 2}}));
  EXPECT_EQ(contents.cell_arrays.at("strain").values, (std::vector<double>{0.25, -0.5, 1}));
  EXPECT_TRUE(fs::exists(folder / "springs.pvd"));
}

TEST(FrameWriter, LosesNoFrameAndKeepsTheOrder) {
  for (const bool background : {true, false}) {
    const TemporaryFolder folder;
    {
      FrameWriter writer({.folder = output(folder / "a" / "b"), .background = background});
      for (std::uint64_t n = 0; n < 20; ++n) {
        Frame frame = writer.take_frame();
        frame = box_frame(n);
        writer.submit(std::move(frame));
      }
    }  // the end of the writer waits for what is queued
    const fs::path out = folder / "a" / "b";
    std::vector<std::string> expected;
    for (std::uint64_t n = 0; n < 20; ++n) {
      char name[32];
      std::snprintf(name, sizeof name, "frame_%04d.vtu", int(n));
      expected.emplace_back(name);
      expect_same(read_with_vtk(out / name), box_frame(n));
    }
    EXPECT_EQ(frames_in(out / "run.pvd"), expected);
    for (const auto& entry : fs::directory_iterator(out))
      EXPECT_NE(entry.path().extension(), ".part");
  }
}

TEST(FrameWriter, ReusesTheMemoryOfWrittenFrames) {
  const TemporaryFolder folder;
  FrameWriter writer({.folder = output(folder.path())});
  Frame frame = box_frame(0);
  const Vec3* memory = frame.points.data();
  writer.submit(std::move(frame));
  writer.finish();
  EXPECT_EQ(writer.take_frame().points.data(), memory);
  EXPECT_EQ(writer.written(), 1u);
}

TEST(FrameWriter, TheCollectionIsTheFormatOfParaView) {
  const TemporaryFolder folder;
  FrameWriter writer({.folder = output(folder.path())});
  writer.submit(box_frame(1));
  writer.submit(box_frame(2));
  writer.finish();
  EXPECT_EQ(writer.collection(), folder / "run.pvd");
  EXPECT_EQ(read_text(folder / "run.pvd"),
            "<?xml version=\"1.0\"?>\n"
            "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
            "  <Collection>\n"
            "    <DataSet timestep=\"0.1\" part=\"0\" file=\"frame_0001.vtu\"/>\n"
            "    <DataSet timestep=\"0.2\" part=\"0\" file=\"frame_0002.vtu\"/>\n"
            "  </Collection>\n"
            "</VTKFile>\n");
}

TEST(FrameWriter, OldResultsGoWhenTheFirstNewFrameIsThere) {
  const TemporaryFolder folder;
  {
    FrameWriter old_run({.folder = output(folder.path())});
    for (std::uint64_t n = 0; n < 5; ++n) old_run.submit(box_frame(n));
  }
  folder.write("frame_mine.vtu", "mine");
  folder.write("frame_9999.vtu", "not listed");
  FrameWriter run({.folder = output(folder.path())});
  run.finish();
  EXPECT_TRUE(fs::exists(folder / "frame_0004.vtu")) << "removed before there is anything new";
  run.submit(box_frame(0, {1, 1, 1}));
  run.finish();
  EXPECT_FALSE(fs::exists(folder / "frame_0004.vtu"));
  EXPECT_EQ(read_with_vtk(folder / "frame_0000.vtu").cells.size(), 1u);
  EXPECT_TRUE(fs::exists(folder / "frame_mine.vtu"));
  EXPECT_TRUE(fs::exists(folder / "frame_9999.vtu"));
  EXPECT_EQ(frames_in(folder / "run.pvd"), (std::vector<std::string>{"frame_0000.vtu"}));
}

TEST(FrameWriter, RefusesFieldsOfTheWrongLength) {
  const TemporaryFolder folder;
  FrameWriter writer({.folder = output(folder.path())});
  Frame frame = box_frame(0);
  frame.point_fields[0].values.pop_back();
  EXPECT_THROW(writer.submit(std::move(frame)), std::invalid_argument);
}

TEST(FrameWriter, AFileInPlaceOfTheFolderIsReported) {
  const TemporaryFolder folder;
  folder.write("out", "x");
  try {
    FrameWriter({.folder = output(folder / "out" / "deeper")}).submit(box_frame(0));
    FAIL();
  } catch (const IoError& error) {
    EXPECT_NE(std::string(error.what()).find("Not a directory"), std::string::npos) << error.what();
    EXPECT_EQ(error.exit_code(), 6);
  }
}

TEST(FrameWriter, AWriteThatFailsInTheBackgroundIsReported) {
  for (const bool background : {true, false}) {
    const TemporaryFolder folder;
    FrameWriter writer({.folder = output(folder.path()), .background = background});
    writer.submit(box_frame(0));
    writer.finish();
    {
      const SmallFiles limit(1 << 14);
      try {
        writer.submit(box_frame(1, {20, 20, 20}));
        writer.finish();
        FAIL() << "no error";
      } catch (const IoError& error) {
        EXPECT_EQ(std::string(error.what()),
                  (folder / "frame_0001.vtu").string() + ": cannot be written: " + too_large);
      }
    }
    // What was good before stays, nothing half-written remains, and the writer continues.
    expect_same(read_with_vtk(folder / "frame_0000.vtu"), box_frame(0));
    EXPECT_FALSE(fs::exists(folder / "frame_0001.vtu"));
    EXPECT_FALSE(fs::exists(folder / "frame_0001.vtu.part"));
    writer.submit(box_frame(2));
    writer.finish();
    EXPECT_EQ(frames_in(folder / "run.pvd"),
              (std::vector<std::string>{"frame_0000.vtu", "frame_0002.vtu"}));
  }
}

std::string name_of(std::uint64_t number) {
  char name[32];
  std::snprintf(name, sizeof name, "frame_%04d.vtu", int(number));
  return name;
}

std::vector<std::string> names(std::uint64_t first, std::uint64_t last) {
  std::vector<std::string> all;
  for (std::uint64_t n = first; n < last; ++n) all.push_back(name_of(n));
  return all;
}

/// Frames [first, last), given to a writer.
void submit(FrameWriter& writer, std::uint64_t first, std::uint64_t last) {
  for (std::uint64_t n = first; n < last; ++n) writer.submit(box_frame(n, {1, 1, 1}));
}

TEST(FrameWriter, GoesOnWhereTheCheckpointWas) {
  for (const std::uint64_t at : {0, 1, 4, 8}) {
    const TemporaryFolder folder;
    StateTree state;
    {
      FrameWriter writer({.folder = output(folder.path())});
      submit(writer, 0, at);
      save_state(state, writer);
      EXPECT_EQ(frames_in(folder / "run.pvd"), names(0, at)) << "all are on disk";
      submit(writer, at, 8);
    }
    folder.write("frame_0020.vtu", "not listed");
    const std::string whole = read_text(folder / "run.pvd");
    for (int round = 0; round < 2; ++round) {
      FrameWriter writer({.folder = output(folder.path())});
      load_state(state, writer);
      EXPECT_EQ(writer.written(), at);
      EXPECT_EQ(writer.missing(), 0u);
      EXPECT_EQ(read_text(folder / "run.pvd"), whole) << "nothing new, nothing lost";
      submit(writer, at, at + 1);
      writer.finish();
      EXPECT_EQ(frames_in(folder / "run.pvd"), names(0, at + 1));
      for (std::uint64_t n = 0; n < 8; ++n)
        EXPECT_EQ(fs::exists(folder / name_of(n)), n < at + 1) << n;
      EXPECT_TRUE(fs::exists(folder / "frame_0020.vtu"));
      submit(writer, at + 1, 8);
      writer.finish();
      EXPECT_EQ(writer.written(), std::max<std::uint64_t>(8, at + 1));
      if (at == 8) break;
      EXPECT_EQ(read_text(folder / "run.pvd"), whole);
    }
  }
}

TEST(FrameWriter, FramesThatWereRemovedLeaveTheListOfAResumedRun) {
  const TemporaryFolder folder;
  StateTree state;
  {
    FrameWriter writer({.folder = output(folder.path())});
    submit(writer, 0, 4);
    save_state(state, writer);
  }
  fs::remove(folder / name_of(1));
  FrameWriter writer({.folder = output(folder.path())});
  load_state(state, writer);
  EXPECT_EQ(writer.missing(), 1u);
  submit(writer, 4, 5);
  writer.finish();
  EXPECT_EQ(frames_in(folder / "run.pvd"),
            (std::vector<std::string>{name_of(0), name_of(2), name_of(3), name_of(4)}));
}

TEST(Frame, IsSavedWhole) {
  Frame frame = box_frame(3), back;
  frame.cells = {{1, 2, none, none}, {3, 4, 5, 6}};
  StateTree tree;
  save_state(tree, frame);
  load_state(tree, back);
  EXPECT_EQ(back.number, 3u);
  EXPECT_EQ(back.time, frame.time);
  EXPECT_EQ(back.points, frame.points);
  EXPECT_EQ(back.hexahedra, frame.hexahedra);
  EXPECT_EQ(back.cells, frame.cells);
  EXPECT_EQ(back.field_data_provenance, frame.field_data_provenance);
  ASSERT_EQ(back.point_fields.size(), 2u);
  ASSERT_EQ(back.cell_fields.size(), 1u);
  EXPECT_EQ(back.point_fields[0].name, "displacement");
  EXPECT_EQ(back.point_fields[0].components, 3);
  EXPECT_EQ(back.point_fields[0].values, frame.point_fields[0].values);
  EXPECT_EQ(back.point_fields[1].ids, frame.point_fields[1].ids);
  EXPECT_TRUE(back.point_fields[1].global_ids);
  EXPECT_FALSE(back.cell_fields[0].global_ids);
}

}  // namespace
}  // namespace suture
