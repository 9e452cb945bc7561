// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/results/frame_parts.hpp"

#include "kernel/base/zeroed_vector.hpp"
#include "kernel/results/displayed_ids.hpp"
#include "kernel/results/part_frames.hpp"

namespace suture {

FrameWriterOptions frame_options(const OutputOptions& options,
                                 const std::shared_ptr<OutputFolder>& folder) {
  FrameWriterOptions result;
  result.folder = folder;
  result.in_pieces = options.pieces;
  switch (options.compression) {
    case OutputOptions::Compression::off:
      result.compression = FrameWriterOptions::Compression::raw;
      break;
    case OutputOptions::Compression::lz4:
      result.compression = FrameWriterOptions::Compression::lz4;
      break;
    case OutputOptions::Compression::zlib:
      result.compression = FrameWriterOptions::Compression::zlib;
      break;
  }
  return result;
}

void set_geometry(Frame& frame, BuiltScene& built) {
  const Column& x = built.body().attributes().position();
  const double* row = x.rows();
  frame.points.resize(x.size());
  for (Vec3& p : frame.points) {
    p = built.frame().in_scene({row[0], row[1], row[2]});
    row += x.stride();
  }
  const auto hexahedra = built.body().complex().vertices();
  frame.hexahedra.assign(hexahedra.begin(), hexahedra.end());
  frame.tetrahedra.clear();
}

void set_geometry(Frame& frame, BuiltScene& built, const PieceCells& piece) {
  const Column& x = built.body().attributes().position();
  const CellComplex& complex = built.body().complex();
  ZeroedVector<Index> point_of(complex.count(0));
  frame.points.clear();
  for (const Index v : piece.vertices) {
    point_of[v] = static_cast<Index>(frame.points.size());
    frame.points.push_back(built.frame().in_scene({x.get(v, 0), x.get(v, 1), x.get(v, 2)}));
  }
  frame.hexahedra.clear();
  for (const Index e : piece.elements) {
    Hexahedron& nodes = frame.hexahedra.emplace_back(complex.vertices_of(e));
    for (Index& v : nodes) v = point_of[v];
  }
  frame.tetrahedra.clear();
}

void leave_out(Frame& frame, BuiltScene& built) {
  const CellComplex& complex = built.body().complex();
  if (!built.parts().empty()) return show_parts(frame, built.parts(), built.embedding(), complex);
  if (complex.existing(0) < complex.count(0) || complex.existing(3) < complex.count(3))
    leave_out_holes(frame, DisplayedIds::of(complex));
}

}  // namespace suture
