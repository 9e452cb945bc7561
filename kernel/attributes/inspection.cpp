// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/inspection.hpp"

#include <limits>
#include <optional>
#include <vector>

#include "kernel/attributes/lips.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/lanes.hpp"
#include "kernel/base/reset_error.hpp"

namespace suture {
namespace {

/// A functor's batch at rest, gathered lane by lane: this runs once.
class InspectionBatch {
 public:
  InspectionBatch(const Instance& instance, const suture_functor& functor, const RestPlaces& rest,
                  const Column& mass, std::span<const Index> user_element)
      : instance_(instance),
        functor_(functor),
        rest_(rest),
        user_element_(user_element),
        dimension_(static_cast<int>(functor.dimension)),
        node_count_(nodes_of(functor)) {
    positions_.resize(static_cast<std::size_t>(node_count_) * 3 * lanes);
    at_rest_.resize(positions_.size(), 0.0);
    // Columns of whole elements are left out where all elements are parts: they are NaN, of which
    // inspect() reports nothing.
    for (const std::uint32_t a : std::span(functor.cell_columns, functor.cell_column_count)) {
      cell_sources_.push_back(instance.column(a));
      cell_values_.emplace_back(instance.model().attributes[a].components * lanes,
                                std::numeric_limits<double>::quiet_NaN());
      cell_pointers_.push_back(cell_values_.back().data());
    }
    for (const std::uint32_t a : std::span(functor.vertex_columns, functor.vertex_column_count)) {
      const Column* const shared = a == UINT32_MAX ? &mass : instance.shared_column(a);
      vertex_sources_.push_back(shared ? shared : instance.column(a));
      const std::size_t components =
          a == UINT32_MAX ? 1 : instance.model().attributes[a].components;
      vertex_values_.emplace_back(static_cast<std::size_t>(node_count_) * components * lanes,
                                  std::numeric_limits<double>::quiet_NaN());
      vertex_pointers_.push_back(vertex_values_.back().data());
    }
  }

  const suture_batch& gather(std::span<const Index> rows) {
    for (Index lane = 0; lane < lanes; ++lane)
      gather_lane(rows[lane < rows.size() ? lane : rows.size() - 1], lane);
    batch_.size = sizeof(suture_batch);
    batch_.lanes = lanes;
    batch_.valid = static_cast<std::uint32_t>(rows.size());
    batch_.nodes = static_cast<std::uint32_t>(node_count_);
    batch_.rest = batch_.position = positions_.data();
    batch_.velocity = at_rest_.data();
    batch_.cell_columns = cell_pointers_.empty() ? nullptr : cell_pointers_.data();
    batch_.vertex_columns = vertex_pointers_.empty() ? nullptr : vertex_pointers_.data();
    batch_.cell_ids = ids_.data();
    return batch_;
  }

 private:
  void gather_lane(Index row, Index lane) {
    const Index cell = instance_.table(dimension_).cells.cell(row);
    ids_[lane] = dimension_ == 3 && !user_element_.empty() ? user_element_[cell] : cell;
    for (std::size_t i = 0; i < cell_sources_.size(); ++i)
      for (int c = 0; cell_sources_[i] && c < cell_sources_[i]->spec().components; ++c)
        cell_values_[i][static_cast<std::size_t>(c) * lanes + lane] = cell_sources_[i]->get(row, c);
    const FunctorCorners corners = corners_of(instance_, functor_, rest_.complex(), cell);
    for (std::size_t n = 0; n < static_cast<std::size_t>(node_count_); ++n) {
      const auto [element, corner] = corners[n];
      for (std::size_t c = 0; c < 3; ++c)
        positions_[(n * 3 + c) * lanes + lane] = rest_.corner(element, corner)[c];
      const Index node = rest_.complex().vertices_of(element)[corner];
      for (std::size_t i = 0; i < vertex_sources_.size(); ++i) gather_vertex(i, n, node, lane);
    }
  }

  void gather_vertex(std::size_t i, std::size_t n, Index vertex, Index lane) {
    if (!vertex_sources_[i]) return;
    const Column& source = *vertex_sources_[i];
    const bool is_shared = source.size() != instance_.table(0).cells.size();
    const Index row = is_shared ? vertex : instance_.table(0).cells.row(vertex);
    const auto components = static_cast<std::size_t>(source.spec().components);
    for (std::size_t c = 0; c < components; ++c)
      vertex_values_[i][(n * components + c) * lanes + lane] = source.get(row, static_cast<int>(c));
  }

  const Instance& instance_;
  const suture_functor& functor_;
  RestPlaces rest_;
  std::span<const Index> user_element_;
  int dimension_, node_count_;
  AlignedVector<double> positions_, at_rest_;
  std::vector<const Column*> cell_sources_, vertex_sources_;
  std::vector<AlignedVector<double>> cell_values_, vertex_values_;
  std::vector<const double*> cell_pointers_, vertex_pointers_;
  std::array<std::uint32_t, lanes> ids_{};
  suture_batch batch_{};
};

const suture_inspect_1* inspection_of(const Instance& instance, const suture_functor& functor) {
  const auto number = static_cast<std::size_t>(&functor - instance.model().functors);
  if (!instance.functor(number).runs) return nullptr;
  return extension_of<suture_inspect_1>(functor, SUTURE_INSPECT_1);
}

void inspect_batch(Instance& instance, const suture_functor& functor,
                   const suture_inspect_1& extension, const suture_batch& batch) {
  suture_context& context = instance.context(0);
  reset(*context.error);
  PluginCall call = instance.call("inspect");
  call.functor = &functor;
  call.batch = &batch;
  const auto ask = [&] { return extension.inspect(&context, &batch); };
  if (call_plugin(call, *context.error, ask) != SUTURE_OK)
    throw PluginError(describe(call) + ": " + text_of(*context.error));
}

}  // namespace

bool admits(const Instance& instance, const suture_functor& functor, const CellComplex& complex,
            Index row) {
  if (!instance.table(static_cast<int>(functor.dimension)).cells.is_live(row)) return false;
  if (functor.dimension == 3 && functor.shape != SUTURE_ANY_SHAPE)
    return instance.is_general(row) == (functor.shape == SUTURE_GENERAL);
  if (functor.dimension != 2) return true;
  const Index face = instance.table(2).cells.cell(row);
  if (acts_on_lips(functor)) return lips_at(instance, complex, face) != nullptr;
  if (functor.faces != SUTURE_ALL_FACES) {
    const bool boundary = complex.beta3(complex.dart_of(2, face)) == none;
    return boundary == (functor.faces == SUTURE_BOUNDARY_FACES);
  }
  return true;
}

void inspect(Instance& instance, const RestPlaces& rest, const Column& mass,
             std::span<const Index> user_element, Diagnostics& diagnostics) {
  const suture_model& model = instance.model();
  for (const suture_functor& functor : std::span(model.functors, model.functor_count)) {
    const suture_inspect_1* extension = inspection_of(instance, functor);
    if (!extension) continue;
    std::optional<InspectionBatch> batch;  // without cells, there may be no columns
    const Index rows = instance.table(static_cast<int>(functor.dimension)).cells.size();
    std::array<Index, lanes> admitted;
    Index filled = 0;
    for (Index row = 0; row < rows; ++row) {
      if (admits(instance, functor, rest.complex(), row)) admitted[filled++] = row;
      if (filled == 0 || (filled < lanes && row + 1 < rows)) continue;
      if (!batch) batch.emplace(instance, functor, rest, mass, user_element);
      inspect_batch(instance, functor, *extension, batch->gather({admitted.data(), filled}));
      filled = 0;
    }
  }
  instance.deliver_findings(diagnostics);
}

}  // namespace suture
