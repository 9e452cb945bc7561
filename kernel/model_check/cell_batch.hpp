// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "kernel/attributes/lips.hpp"
#include "kernel/base/aligned.hpp"

namespace suture {

/// The inputs of one batch of a functor, as a copy that can be changed and kept. Arrays have the
/// layout of suture_batch.
struct CellBatch {
  const suture_functor* functor = nullptr;
  std::uint32_t valid = SUTURE_LANES;
  double time = 0, dt = 0;
  std::array<std::uint32_t, SUTURE_LANES> ids{};
  AlignedVector<double> rest, position, velocity;
  std::vector<AlignedVector<double>> cell_columns, vertex_columns;

  std::size_t nodes() const { return static_cast<std::size_t>(nodes_of(*functor)); }
  /// Values of a vector per node, such as the forces.
  std::size_t vector_size() const { return 3 * nodes() * SUTURE_LANES; }
  static std::size_t place(std::size_t node, std::size_t component, std::size_t lane) {
    return (3 * node + component) * SUTURE_LANES + lane;
  }
};

/// What a force function writes.
struct CellForces {
  AlignedVector<double> force;
  std::vector<AlignedVector<double>> trial;  ///< by cell column; empty without a trial copy
};

/// Calls the functions of an instance's model on batches. A status other than SUTURE_OK throws
/// NumericalError with the model's message, a fault or a warning about the call PluginError.
class BatchCaller {
 public:
  explicit BatchCaller(Instance& instance, unsigned worker = 0)
      : instance_(instance), worker_(worker) {}

  Instance& instance() const { return instance_; }

  /// Outputs hold `poison` before the call.
  CellForces force(const CellBatch& in, double poison = 0);
  /// The same without an exception for a status of the model.
  suture_status try_force(const CellBatch& in, CellForces& out);
  /// The same with the checks of `suture run --check-plugins`.
  CellForces checked_force(const CellBatch& in);
  /// J, by lane. The functor has an energy.
  std::array<double, SUTURE_LANES> energy(const CellBatch& in);
  /// W, by lane. The functor has suture.dissipation/1.
  std::array<double, SUTURE_LANES> dissipation(const CellBatch& in);
  /// The derivative in the direction (dx, dv). The functor has a tangent.
  AlignedVector<double> tangent(const CellBatch& in, const AlignedVector<double>& dx,
                                const AlignedVector<double>& dv);
  /// The same in single precision. The functor offers it.
  AlignedVector<double> single_tangent(const CellBatch& in, const AlignedVector<double>& dx,
                                       const AlignedVector<double>& dv);

  /// Calls `function(context, batch)` of the functor under its name.
  template <class Function>
  void call(const char* name, const CellBatch& in, suture_batch& batch, Function&& function) {
    const suture_status status = try_call(name, in, batch, std::forward<Function>(function));
    if (status != SUTURE_OK) refused(name, in, batch);
  }
  template <class Function>
  suture_status try_call(const char* name, const CellBatch& in, suture_batch& batch,
                         Function&& function) {
    const PluginCall asked = describe_call(name, in, batch);
    suture_context& context = instance_.context(worker_);
    reset_error();
    const suture_status status =
        call_plugin(asked, *context.error, [&] { return function(&context, &batch); });
    require_no_warning();
    return status;
  }

 private:
  using NumberFunction = suture_status(const suture_context*, const suture_batch*, double*);
  std::array<double, SUTURE_LANES> numbers(const char* name, const CellBatch& in,
                                           NumberFunction* function);
  PluginCall describe_call(const char* name, const CellBatch& in, const suture_batch& batch) const;
  void reset_error();
  static void require_no_warning();
  [[noreturn]] void refused(const char* name, const CellBatch& in, const suture_batch& batch);

  Instance& instance_;
  unsigned worker_;
};

/// A suture_batch of a CellBatch, which it refers to.
class BatchView {
 public:
  explicit BatchView(const CellBatch& in);
  BatchView(const BatchView&) = delete;
  suture_batch& batch() { return batch_; }
  /// Forces and trial columns go there.
  void write_to(CellForces& out);

 private:
  std::vector<const double*> cell_columns_, vertex_columns_;
  std::vector<double*> trial_columns_;
  suture_batch batch_{};
};

/// Space for what the functor writes, filled with `value`.
CellForces outputs_of(const CellBatch& in, const suture_model& model, double value);

}  // namespace suture
