// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/results/side_series.hpp"

#include <algorithm>
#include <limits>
#include <span>

#include "kernel/attributes/inspection.hpp"
#include "kernel/forces/contact_law.hpp"
#include "kernel/geometry/shape_mesh.hpp"
#include "kernel/results/displayed_ids.hpp"
#include "kernel/results/frame_parts.hpp"
#include "kernel/results/part_frames.hpp"

namespace suture {
namespace {

/// The cells refer to vertices of the body; makes those that are used the points of the frame.
void take_points(Frame& frame, BuiltScene& built) {
  const Column& x = built.body().attributes().position();
  std::vector<Index> point_of(x.size(), none);
  for (const SmallCell& cell : frame.cells)
    for (const Index v : cell)
      if (v != none) point_of[v] = 0;
  frame.points.clear();
  for (Index v = 0; v < x.size(); ++v) {
    if (point_of[v] == none) continue;
    point_of[v] = static_cast<Index>(frame.points.size());
    frame.points.push_back(built.frame().in_scene({x.get(v, 0), x.get(v, 1), x.get(v, 2)}));
  }
  for (SmallCell& cell : frame.cells)
    for (Index& v : cell)
      if (v != none) v = point_of[v];
}

/// The vertices of an edge or a face, from one of its darts.
SmallCell cell_at(const CellComplex& complex, Dart d, int dimension) {
  SmallCell cell{none, none, none, none};
  for (std::size_t i = 0; i < (dimension == 1 ? 2u : 4u); ++i, d = CellComplex::beta1(d))
    cell[i] = complex.origin(d);
  return cell;
}

/// Whether a functor visits the cell: not, for example, an interior face if the model's functors
/// are for the boundary.
bool has_functor(const Instance& instance, int dimension, Index row, const CellComplex& complex) {
  const suture_model& model = instance.model();
  return std::ranges::any_of(
      std::span(model.functors, model.functor_count), [&](const suture_functor& f) {
        return static_cast<int>(f.dimension) == dimension && admits(instance, f, complex, row);
      });
}

void fill_model_cells(Frame& frame, int dimension, BuiltScene& built) {
  const CellComplex& complex = built.body().complex();
  std::vector<Index> left;  // rows, counted over all instances
  Index first = 0;
  frame.cells.clear();
  for (const auto& instance : built.body().attributes().instances()) {
    const Table& table = instance->table(dimension);
    for (Index row = 0; row < table.cells.size(); ++row) {
      if (!has_cell(complex, table, row) || !has_functor(*instance, dimension, row, complex))
        continue;
      left.push_back(first + row);
      frame.cells.push_back(
          cell_at(complex, complex.dart_of(dimension, table.cells.cell(row)), dimension));
    }
    first += table.cells.size();
  }
  if (left.size() < first) keep(frame.cell_fields, left);
  take_points(frame, built);
}

/// The fields of a cut series: one value per cell.
struct CutFields {
  FrameField event{.name = "event"}, blade{.name = "blade"}, opened{.name = "opened"};

  void add(std::uint32_t number, bool is_blade, double time) {
    event.ids.push_back(number == none ? -1 : std::int64_t{number});
    blade.ids.push_back(is_blade ? 1 : 0);
    opened.values.push_back(time);
  }
};

void add_blade(Frame& frame, CutFields& fields, const BladeShape& blade, BuiltScene& built) {
  const auto first = static_cast<Index>(frame.points.size());
  const auto add = [&](const SmallCell& cell) {
    frame.cells.push_back(cell);
    fields.add(blade.event, true, std::numeric_limits<double>::quiet_NaN());
  };
  for (const Vec3& p : blade.points) frame.points.push_back(built.frame().in_scene(p));
  for (const auto& t : blade.triangles) add({first + t[0], first + t[1], first + t[2], none});
  if (!blade.triangles.empty()) return;
  for (Index i = 0; i + 1 < blade.points.size(); ++i) add({first + i, first + i + 1, none, none});
}

void add_opened(Frame& frame, CutFields& fields, BuiltScene& built, const EventRunner& events) {
  const CellComplex& complex = built.body().complex();
  for (const OpenedFace& face : events.opened()) {
    if (!complex.exists(3, element_of(face.side)) || complex.beta3(face.side) != none) continue;
    frame.cells.push_back(cell_at(complex, face.side, 2));
    fields.add(face.event, false, face.time);
  }
  take_points(frame, built);
}

/// Faces of elements reach out of an embedded surface, so its triangles are shown.
void add_lips(Frame& frame, CutFields& fields, BuiltScene& built) {
  const Embedding& all = built.embedding();
  Embedding lips;
  lips.points = all.points;
  const std::vector<Index> cuts = built.embedded_parts().cuts(built.body().complex());
  std::vector<Index> cut_of_lip;
  for (std::size_t t = 0; t < all.triangles.size(); ++t) {
    if (all.is_laid_open[t] == 0) continue;
    lips.triangles.push_back(all.triangles[t]);
    cut_of_lip.push_back(cuts[t]);
  }
  frame.point_fields.clear();
  frame.cell_fields.clear();
  set_geometry(frame, built);
  show_surface(frame, lips);
  for (const Index cut : cut_of_lip)
    fields.add(cut, false, std::numeric_limits<double>::quiet_NaN());
}

void fill_cuts(Frame& frame, double time, BuiltScene& built, const EventRunner& events) {
  CutFields fields;
  frame.cells.clear();
  if (built.is_embedded())
    add_lips(frame, fields, built);
  else
    add_opened(frame, fields, built, events);
  for (const BladeShape& blade : events.blades(time)) add_blade(frame, fields, blade, built);
  frame.cell_fields = {std::move(fields.event), std::move(fields.blade), std::move(fields.opened)};
}

void fill_obstacles(Frame& frame, double time, const ContactLaw& contact, BuiltScene& built) {
  FrameField numbers{.name = "obstacle"};
  frame.points.clear();
  frame.cells.clear();
  Vec3 middle;
  for (std::size_t c = 0; c < 3; ++c)
    middle[c] = (contact.box().low[c] + contact.box().high[c]) / 2;
  for (std::size_t i = 0; i < contact.obstacles().size(); ++i) {
    const Obstacle& obstacle = contact.obstacles()[i];
    const Pose pose = contact.pose(i, time);
    const auto first = static_cast<Index>(frame.points.size());
    const ShapeMesh mesh = mesh_of(obstacle.shape, middle, contact.size());
    for (const Vec3& point : mesh.points)
      frame.points.push_back(built.frame().in_scene(pose.place(point)));
    for (SmallCell cell : mesh.faces) {
      for (Index& corner : cell)
        if (corner != none) corner += first;
      frame.cells.push_back(cell);
      numbers.ids.push_back(static_cast<std::int64_t>(i));
    }
  }
  frame.cell_fields = {std::move(numbers)};
}

}  // namespace

std::vector<SideSeries> side_series(const OutputOptions& options,
                                    const std::vector<FieldChoice>& fields, BuiltScene& built,
                                    const EventRunner& events) {
  std::vector<SideSeries> series;
  const auto of_models = [&](const char* name, int dimension, FieldChoice::On on) {
    const auto fill = [&fields, &built, dimension, on](Frame& frame, double time,
                                                       const Vec3& gravity) {
      fill_fields(fields, on, {built, gravity, time}, frame.cell_fields);
      fill_model_cells(frame, dimension, built);
    };
    series.push_back({name, fill, nullptr});
  };
  if (options.springs) of_models("springs", 1, FieldChoice::On::springs);
  if (options.faces) of_models("faces", 2, FieldChoice::On::faces);
  const auto cuts = [&built, &events](Frame& frame, double time, const Vec3&) {
    fill_cuts(frame, time, built, events);
  };
  if (options.obstacles) {
    const auto obstacles = [&built](Frame& frame, double time, const Vec3&) {
      fill_obstacles(frame, time, *built.body().contact(), built);
    };
    series.push_back({"obstacles", obstacles, nullptr});
  }
  if (options.surface) {
    const auto surface = [&fields, &built](Frame& frame, double time, const Vec3& gravity) {
      set_geometry(frame, built);
      fill_fields(fields, FieldChoice::On::points, {built, gravity, time}, frame.point_fields);
      fill_fields(fields, FieldChoice::On::cells, {built, gravity, time}, frame.cell_fields);
      show_surface(frame, built.embedding());
      frame.is_surface = true;
    };
    series.push_back({"surface", surface, nullptr});
  }
  if (options.cuts) series.push_back({"cuts", cuts, nullptr});
  return series;
}

}  // namespace suture
