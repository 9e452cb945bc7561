// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/frame_file.hpp"

#include <algorithm>
#include <stdexcept>

#include "kernel/base/error.hpp"
#include "kernel/base/file.hpp"
#include "kernel/mesh/vtk_order.hpp"
#include "kernel/vtk/vtk_module.hpp"

namespace suture {
namespace {

void check_field(const FrameField& field, std::size_t tuples) {
  const std::size_t size = field.ids.empty() ? field.values.size() : field.ids.size();
  if (field.components < 1 || size != tuples * static_cast<std::size_t>(field.components)) {
    throw std::invalid_argument("frame field '" + field.name + "' has " + std::to_string(size) +
                                " values for " + std::to_string(tuples) + " cells");
  }
}

std::vector<VtuArray> arrays_of(const std::vector<FrameField>& fields) {
  std::vector<VtuArray> arrays;
  for (const FrameField& field : fields) {
    VtuArray array;
    array.name = field.name;
    array.components = field.components;
    if (field.ids.empty())
      array.values = field.values.data();
    else
      array.ids = field.ids.data();
    array.global_ids = field.global_ids;
    array.component_names = names_of_components(field);
    arrays.push_back(std::move(array));
  }
  return arrays;
}

VtuCompression compression_of(FrameWriterOptions::Compression compression) {
  switch (compression) {
    case FrameWriterOptions::Compression::raw:
      return VtuCompression::raw;
    case FrameWriterOptions::Compression::zlib:
      return VtuCompression::zlib;
    case FrameWriterOptions::Compression::lz4:
      break;
  }
  return VtuCompression::lz4;
}

/// Cells as VTK wants them: the points of all, and their types; nothing for hexahedra only, which a
/// frame has in this form.
struct PackedCells {
  std::vector<Index> points;
  std::vector<VtuCell> types;

  explicit PackedCells(const Frame& frame) {
    if (frame.cells.empty() && frame.tetrahedra.empty()) return;
    points.reserve(8 * frame.hexahedra.size() + 4 * (frame.tetrahedra.size() + frame.cells.size()));
    types.reserve(cell_count(frame));
    if (frame.cells.empty()) {
      for (const Hexahedron& nodes : frame.hexahedra) add(nodes, VtuCell::hexahedron);
      for (const auto& corners : frame.tetrahedra) add(corners, VtuCell::tetrahedron);
    }
    for (const SmallCell& cell : frame.cells) {
      constexpr VtuCell by_size[] = {VtuCell::line, VtuCell::triangle, VtuCell::quad};
      const std::span used(cell.begin(), std::ranges::find(cell, none));
      add(used, by_size[used.size() - 2]);
    }
  }
  void add(std::span<const Index> corners, VtuCell type) {
    points.insert(points.end(), corners.begin(), corners.end());
    types.push_back(type);
  }
};

}  // namespace

std::size_t cell_count(const Frame& frame) {
  return frame.cells.empty() ? frame.hexahedra.size() + frame.tetrahedra.size()
                             : frame.cells.size();
}

std::span<const char* const> names_of_components(const FrameField& field) {
  static constexpr const char* tensor[] = {"XX", "YY", "ZZ", "XY", "YZ", "XZ"};
  static constexpr const char* principal[] = {"1", "2", "3"};
  if (field.principal) return principal;
  if (field.components == 6) return tensor;
  return {};
}

void check_frame(const Frame& frame) {
  for (const FrameField& field : frame.point_fields) check_field(field, frame.points.size());
  for (const FrameField& field : frame.cell_fields) check_field(field, cell_count(frame));
}

void write_frame(OutputFile& file, Frame& frame, FrameWriterOptions::Compression compression) {
  for (Hexahedron& nodes : frame.hexahedra) nodes = swap_vtk_order(nodes);
  VtuImage image;
  image.points = frame.points.data();
  image.point_count = frame.points.size();
  image.cell_count = cell_count(frame);
  const PackedCells packed(frame);
  const bool is_plain = packed.types.empty();
  image.connectivity =
      is_plain ? reinterpret_cast<const Index*>(frame.hexahedra.data()) : packed.points.data();
  image.connectivity_size = is_plain ? 8 * frame.hexahedra.size() : packed.points.size();
  image.cell_types = packed.types;
  image.is_surface = frame.is_surface;
  image.point_arrays = arrays_of(frame.point_fields);
  image.cell_arrays = arrays_of(frame.cell_fields);
  image.time = frame.time;
  image.provenance = frame.field_data_provenance;
  image.compression = compression_of(compression);

  const VtuOutcome outcome = vtk_module().write_vtu(file.descriptor(), image);
  if (outcome.error != 0) fail_io(file.path(), "written", outcome.error);
  if (!outcome.text.empty())
    throw IoError(file.path().string() + ": cannot be written: " + outcome.text);
}

}  // namespace suture
