// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/model_check/gather_cells.hpp"

#include <algorithm>

#include "kernel/attributes/lips.hpp"
#include "kernel/plugin_host/part_functors.hpp"

namespace suture {
namespace {

class Gathering {
 public:
  Gathering(Body& body, Instance& instance, const suture_functor& functor)
      : body_(body),
        instance_(instance),
        functor_(functor),
        dimension_(static_cast<int>(functor.dimension)),
        places_(body.attributes().rest_places(body.complex())) {
    batch.functor = &functor;
    batch.dt = 0.01;
    for (auto* vectors : {&batch.rest, &batch.position, &batch.velocity})
      vectors->assign(batch.vector_size(), 0);
    for (std::uint32_t i = 0; i < functor.cell_column_count; ++i)
      batch.cell_columns.emplace_back(components_of(functor.cell_columns[i]) * SUTURE_LANES);
    for (std::uint32_t i = 0; i < functor.vertex_column_count; ++i)
      batch.vertex_columns.emplace_back(batch.nodes() * components_of(functor.vertex_columns[i]) *
                                        SUTURE_LANES);
  }

  void add(std::size_t lane, Index cell) {
    corners_ = corners_of(instance_, functor_, body_.complex(), cell);
    for (std::size_t n = 0; n < batch.nodes(); ++n)
      nodes_[n] = body_.complex().vertices_of(corners_[n].element)[corners_[n].corner];
    batch.ids[lane] = cell;
    add_vectors(lane);
    for (std::size_t i = 0; i < batch.cell_columns.size(); ++i) add_cell_column(i, lane, cell);
    for (std::size_t i = 0; i < batch.vertex_columns.size(); ++i) add_vertex_column(i, lane);
  }

  CellBatch batch;

 private:
  std::size_t components_of(std::uint32_t attribute) const {
    return attribute == UINT32_MAX ? 1 : cell_attribute(instance_.model(), attribute).components;
  }
  /// A functor on parts reads what the functor reads that it replaces.
  bool reads_velocity() const {
    for (std::size_t i = 0; i < instance_.model().functor_count; ++i)
      if (&functor_ == &instance_.model().functors[i] || &functor_ == instance_.part_functor(i))
        return (instance_.functor(i).reads & SUTURE_READ_VELOCITY) != 0;
    return false;
  }

  void add_vectors(std::size_t lane) {
    Attributes& attributes = body_.attributes();
    for (std::size_t n = 0; n < batch.nodes(); ++n)
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t to = CellBatch::place(n, c, lane);
        const int component = static_cast<int>(c);
        batch.rest[to] = places_.corner(corners_[n].element, corners_[n].corner)[c];
        batch.position[to] = attributes.position().get(nodes_[n], component);
        if (reads_velocity()) batch.velocity[to] = attributes.velocity().get(nodes_[n], component);
      }
  }
  void add_cell_column(std::size_t i, std::size_t lane, Index cell) {
    const std::uint32_t place = functor_.cell_columns[i];
    const Index row = instance_.table(dimension_).cells.row(cell);
    for (std::size_t c = 0; c < components_of(place); ++c)
      batch.cell_columns[i][c * SUTURE_LANES + lane] =
          is_part_column(place) ? instance_.part_column(place).get(row, c)
                                : instance_.column(place)->get(row, static_cast<int>(c));
  }
  void add_vertex_column(std::size_t i, std::size_t lane) {
    const std::uint32_t a = functor_.vertex_columns[i];
    const Column* const shared =
        a == UINT32_MAX ? &body_.attributes().mass() : instance_.shared_column(a);
    const Column& column = shared ? *shared : *instance_.column(a);
    const auto components = static_cast<std::size_t>(column.spec().components);
    for (std::size_t n = 0; n < batch.nodes(); ++n) {
      const Index row = shared ? nodes_[n] : instance_.table(0).cells.row(nodes_[n]);
      for (std::size_t c = 0; c < components; ++c)
        batch.vertex_columns[i][(n * components + c) * SUTURE_LANES + lane] =
            column.get(row, static_cast<int>(c));
    }
  }

  Body& body_;
  Instance& instance_;
  const suture_functor& functor_;
  int dimension_;
  RestPlaces places_;
  FunctorCorners corners_{};
  Index nodes_[hexahedron::vertices]{};
};

}  // namespace

CellBatch gather_cells(Body& body, Instance& instance, const suture_functor& functor,
                       std::span<const Index> cells) {
  Gathering gathering(body, instance, functor);
  const std::size_t valid = std::min<std::size_t>(SUTURE_LANES, cells.size());
  gathering.batch.valid = static_cast<std::uint32_t>(valid);
  for (std::size_t lane = 0; lane < SUTURE_LANES; ++lane)
    gathering.add(lane, cells[std::min(lane, valid - 1)]);
  return std::move(gathering.batch);
}

}  // namespace suture
