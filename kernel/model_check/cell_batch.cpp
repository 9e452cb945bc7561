// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/model_check/cell_batch.hpp"

#include "kernel/base/error.hpp"
#include "kernel/base/reset_error.hpp"
#include "kernel/forces/checked_force.hpp"
#include "kernel/plugin_host/part_functors.hpp"
#include "suture/single.h"

namespace suture {
namespace {

constexpr std::size_t lanes = SUTURE_LANES, single_lanes = SUTURE_SINGLE_LANES;
using Floats = AlignedVector<float>;

std::vector<const double*> pointers_to(const std::vector<AlignedVector<double>>& columns) {
  std::vector<const double*> pointers;
  for (const auto& column : columns) pointers.push_back(column.data());
  return pointers;
}

/// Rows of lanes in single precision, every cell twice; vectors relative to those of `origin`.
Floats in_single(const AlignedVector<double>& values, bool relative = false) {
  Floats out(values.size() / lanes * single_lanes);
  for (std::size_t row = 0; row < values.size() / lanes; ++row)
    for (std::size_t l = 0; l < single_lanes; ++l) {
      const double origin = relative ? values[row % 3 * lanes + l % lanes] : 0;
      out[row * single_lanes + l] = static_cast<float>(values[row * lanes + l % lanes] - origin);
    }
  return out;
}

AlignedVector<double> in_double(const Floats& values) {
  AlignedVector<double> out(values.size() / single_lanes * lanes);
  for (std::size_t row = 0; row < values.size() / single_lanes; ++row)
    for (std::size_t l = 0; l < lanes; ++l)
      out[row * lanes + l] = static_cast<double>(values[row * single_lanes + l]);
  return out;
}

/// A batch of suture.tangent-single/1.
class SingleView {
 public:
  SingleView(const CellBatch& in, const suture_tangent_single_1& table)
      : rest_(in_single(in.rest, true)),
        position_(in_single(in.position, true)),
        velocity_(in_single(in.velocity)) {
    for (std::size_t l = 0; l < single_lanes; ++l) ids_[l] = in.ids[l % lanes];
    for (std::size_t i = 0; i < in.cell_columns.size() && i < table.columns; ++i)
      cells_.push_back(in_single(in.cell_columns[i]));
    if (table.columns == UINT32_MAX)
      for (const auto& column : in.vertex_columns) vertices_.push_back(in_single(column));
    for (const Floats& column : cells_) cell_pointers_.push_back(column.data());
    for (const Floats& column : vertices_) vertex_pointers_.push_back(column.data());
    batch_ = {sizeof batch_,
              single_lanes,
              static_cast<std::uint32_t>(in.nodes()),
              0,
              in.time,
              in.dt,
              rest_.data(),
              position_.data(),
              velocity_.data(),
              cells_.empty() ? nullptr : cell_pointers_.data(),
              vertices_.empty() ? nullptr : vertex_pointers_.data(),
              ids_.data()};
  }
  SingleView(const SingleView&) = delete;
  const suture_single_batch& batch() const { return batch_; }

 private:
  Floats rest_, position_, velocity_;
  std::vector<Floats> cells_, vertices_;
  std::vector<const float*> cell_pointers_, vertex_pointers_;
  std::array<std::uint32_t, single_lanes> ids_{};
  suture_single_batch batch_{};
};

}  // namespace

BatchView::BatchView(const CellBatch& in)
    : cell_columns_(pointers_to(in.cell_columns)), vertex_columns_(pointers_to(in.vertex_columns)) {
  batch_.size = sizeof batch_;
  batch_.lanes = lanes;
  batch_.valid = in.valid;
  batch_.nodes = static_cast<std::uint32_t>(in.nodes());
  batch_.time = in.time;
  batch_.dt = in.dt;
  batch_.rest = in.rest.data();
  batch_.position = in.position.data();
  batch_.velocity = in.velocity.data();
  batch_.cell_columns = cell_columns_.empty() ? nullptr : cell_columns_.data();
  batch_.vertex_columns = vertex_columns_.empty() ? nullptr : vertex_columns_.data();
  batch_.cell_ids = in.ids.data();
}

void BatchView::write_to(CellForces& out) {
  batch_.force = out.force.data();
  trial_columns_.clear();
  for (auto& column : out.trial) trial_columns_.push_back(column.empty() ? nullptr : column.data());
  batch_.trial_columns = trial_columns_.empty() ? nullptr : trial_columns_.data();
}

CellForces outputs_of(const CellBatch& in, const suture_model& model, double value) {
  CellForces out;
  out.force.assign(in.vector_size(), value);
  for (std::size_t i = 0; i < in.cell_columns.size(); ++i) {
    const suture_attribute& a = cell_attribute(model, in.functor->cell_columns[i]);
    const bool has_trial = (a.flags & SUTURE_TRIAL) != 0;
    out.trial.emplace_back(has_trial ? in.cell_columns[i].size() : 0, value);
  }
  return out;
}

PluginCall BatchCaller::describe_call(const char* name, const CellBatch& in,
                                      const suture_batch& batch) const {
  PluginCall asked = instance_.call(name);
  asked.functor = in.functor;
  asked.batch = &batch;
  return asked;
}

void BatchCaller::reset_error() { reset(*instance_.context(worker_).error); }

void BatchCaller::require_no_warning() {
  Diagnostics found;
  deliver_plugin_warnings(found);
  if (!found.warnings().empty()) throw PluginError(found.warnings().front());
}

void BatchCaller::refused(const char* name, const CellBatch& in, const suture_batch& batch) {
  throw NumericalError(
      describe(describe_call(name, in, batch)) +
      ": the model refuses this state: " + text_of(*instance_.context(worker_).error));
}

CellForces BatchCaller::force(const CellBatch& in, double poison) {
  CellForces out = outputs_of(in, instance_.model(), poison);
  BatchView view(in);
  view.write_to(out);
  call("force", in, view.batch(), in.functor->force);
  return out;
}

suture_status BatchCaller::try_force(const CellBatch& in, CellForces& out) {
  out = outputs_of(in, instance_.model(), 0);
  BatchView view(in);
  view.write_to(out);
  return try_call("force", in, view.batch(), in.functor->force);
}

CellForces BatchCaller::checked_force(const CellBatch& in) {
  CellForces out = outputs_of(in, instance_.model(), 0);
  BatchView view(in);
  view.write_to(out);
  call("force", in, view.batch(), &suture::checked_force);
  return out;
}

std::array<double, lanes> BatchCaller::energy(const CellBatch& in) {
  return numbers("energy", in, extension_of<suture_energy_1>(*in.functor, SUTURE_ENERGY_1)->energy);
}

std::array<double, lanes> BatchCaller::dissipation(const CellBatch& in) {
  return numbers("dissipation", in,
                 extension_of<suture_dissipation_1>(*in.functor, SUTURE_DISSIPATION_1)->power);
}

std::array<double, lanes> BatchCaller::numbers(const char* name, const CellBatch& in,
                                               NumberFunction* function) {
  alignas(SUTURE_ALIGNMENT) std::array<double, lanes> out{};
  BatchView view(in);
  call(name, in, view.batch(), [&](const suture_context* context, const suture_batch* batch) {
    return function(context, batch, out.data());
  });
  return out;
}

AlignedVector<double> BatchCaller::tangent(const CellBatch& in, const AlignedVector<double>& dx,
                                           const AlignedVector<double>& dv) {
  AlignedVector<double> out(in.vector_size());
  const auto* table = extension_of<suture_tangent_1>(*in.functor, SUTURE_TANGENT_1);
  BatchView view(in);
  call("tangent", in, view.batch(), [&](const suture_context* context, const suture_batch* batch) {
    return table->apply(context, batch, dx.data(), dv.data(), out.data());
  });
  return out;
}

AlignedVector<double> BatchCaller::single_tangent(const CellBatch& in,
                                                  const AlignedVector<double>& dx,
                                                  const AlignedVector<double>& dv) {
  const auto* table = extension_of<suture_tangent_single_1>(*in.functor, SUTURE_TANGENT_SINGLE_1);
  const SingleView single(in, *table);
  const Floats x = in_single(dx), v = in_single(dv);
  Floats out(x.size());
  BatchView view(in);
  call("tangent in single precision", in, view.batch(),
       [&](const suture_context* context, const suture_batch*) {
         return table->apply(context, &single.batch(), x.data(), v.data(), out.data());
       });
  return in_double(out);
}

}  // namespace suture
