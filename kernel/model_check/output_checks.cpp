// SPDX-License-Identifier: GPL-3.0-or-later
//
// What functions write: every output, nothing else, and each lane for itself.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernel/model_check/checks.hpp"

namespace suture::checks {
namespace {

constexpr std::size_t lane_count = SUTURE_LANES;
using Values = AlignedVector<double>;

/// An output array between guards; `rows` of 8 lanes.
class GuardedOutput {
 public:
  GuardedOutput(std::string name, std::size_t rows)
      : name_(std::move(name)), size_(rows * lane_count) {}

  void fill(double poison) {
    memory_.assign(size_ + 2 * guard_size, guard);
    std::fill_n(data(), size_, poison);
    poison_ = poison;
  }
  double* data() { return memory_.data() + guard_size; }
  /// A value that is never set keeps the poison, whatever that is.
  void require_written(const Values& other, std::uint32_t valid) {
    for (std::size_t i = 0; i < guard_size; ++i)
      if (memory_[i] != guard || memory_[guard_size + size_ + i] != guard)
        throw BrokenLaw(name_ + " has " + std::to_string(size_ / lane_count) +
                        " rows of 8 lanes, but the function also writes outside them");
    for (std::size_t i = 0; i < size_; ++i) {
      if (i % lane_count >= valid) continue;
      if (data()[i] == poison_)
        throw BrokenLaw("row " + std::to_string(i / lane_count) + " of " + name_ +
                        " is never set; set all rows, to zero where there is nothing");
      if (!std::isfinite(data()[i]))
        throw BrokenLaw("row " + std::to_string(i / lane_count) + " of " + name_ +
                        " is not finite");
      if (data()[i] != other[i])
        throw BrokenLaw("row " + std::to_string(i / lane_count) + " of " + name_ +
                        " depends on what the array held before the call");
    }
  }
  Values values() { return {data(), data() + size_}; }

 private:
  static constexpr std::size_t guard_size = 16 * lane_count;
  static constexpr double guard = 0x1.2345678p+200;
  std::string name_;
  std::size_t size_;
  double poison_ = 0;
  Values memory_;
};

/// Runs `call` twice on differently poisoned outputs.
template <class Call>
void examine(std::vector<GuardedOutput> outputs, std::uint32_t valid, Call call) {
  std::vector<Values> first;
  for (const double poison : {0x1.5afe5afe5afe5p-800, 0x1.bad0bad0bad0bp+300}) {
    for (GuardedOutput& output : outputs) output.fill(poison);
    call(outputs);
    if (first.empty())
      for (GuardedOutput& output : outputs) first.push_back(output.values());
  }
  for (std::size_t i = 0; i < outputs.size(); ++i) outputs[i].require_written(first[i], valid);
}

class Outputs {
 public:
  explicit Outputs(const BatchCase& of)
      : batch_(of.batch), functor_(*of.batch.functor), caller_(of.instance), view_(of.batch) {}

  void energy() {
    const auto* table = extension_of<suture_energy_1>(functor_, SUTURE_ENERGY_1);
    if (table == nullptr) return;
    with({{"the energies", 1}}, "energy", [&](auto* context, auto* batch, auto& outputs) {
      return table->energy(context, batch, outputs[0].data());
    });
  }
  void dissipation() {
    const auto* table = extension_of<suture_dissipation_1>(functor_, SUTURE_DISSIPATION_1);
    if (table == nullptr) return;
    with({{"the power dissipated", 1}}, "dissipation",
         [&](auto* context, auto* batch, auto& outputs) {
           return table->power(context, batch, outputs[0].data());
         });
  }
  void bounds() {
    const auto* table = extension_of<suture_stable_dt_1>(functor_, SUTURE_STABLE_DT_1);
    if (table == nullptr) return;
    const std::size_t rows = 6 * batch_.nodes();
    with({{"the bounds of the stiffness", rows}, {"the bounds of the damping", rows}}, "bounds",
         [&](auto* context, auto* batch, auto& outputs) {
           return table->bounds(context, batch, outputs[0].data(), outputs[1].data());
         });
  }
  void tangent() {
    const auto* table = extension_of<suture_tangent_1>(functor_, SUTURE_TANGENT_1);
    if (table == nullptr) return;
    with({{"the derivative of the force", 3 * batch_.nodes()}}, "tangent",
         [&](auto* context, auto* batch, auto& outputs) {
           return table->apply(context, batch, batch_.position.data(), batch_.velocity.data(),
                               outputs[0].data());
         });
  }
  void fields() {
    const auto* table = extension_of<suture_output_1>(functor_, SUTURE_OUTPUT_1);
    if (table == nullptr) return;
    std::vector<GuardedOutput> fields;
    for (const suture_field& field : std::span(table->fields, table->field_count))
      fields.emplace_back(std::string("field '") + field.name + "'", field.components);
    with(std::move(fields), "output", [&](auto* context, auto* batch, auto& outputs) {
      std::vector<double*> out;
      for (GuardedOutput& output : outputs) out.push_back(output.data());
      return table->compute(context, batch, out.data());
    });
  }

 private:
  template <class Function>
  void with(std::vector<GuardedOutput> arrays, const char* name, Function function) {
    examine(std::move(arrays), batch_.valid, [&](std::vector<GuardedOutput>& outputs) {
      caller_.call(name, batch_, view_.batch(),
                   [&](const suture_context* context, const suture_batch* batch) {
                     return function(context, batch, outputs);
                   });
    });
  }

  const CellBatch& batch_;
  const suture_functor& functor_;
  BatchCaller caller_;
  BatchView view_;
};

using Order = std::array<std::size_t, lane_count>;

Values permuted(const Values& values, const Order& order) {
  Values out(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    out[i] = values[i - i % lane_count + order[i % lane_count]];
  return out;
}

CellBatch permuted(const CellBatch& batch, const Order& order) {
  CellBatch out = batch;
  for (auto vectors : {&CellBatch::rest, &CellBatch::position, &CellBatch::velocity})
    out.*vectors = permuted(batch.*vectors, order);
  for (auto& column : out.cell_columns) column = permuted(column, order);
  for (auto& column : out.vertex_columns) column = permuted(column, order);
  for (std::size_t l = 0; l < lane_count; ++l) out.ids[l] = batch.ids[order[l]];
  return out;
}

}  // namespace

Result outputs(const BatchCase& of) {
  BatchCaller(of.instance).checked_force(of.batch);
  Outputs outputs(of);
  outputs.energy();
  outputs.dissipation();
  outputs.bounds();
  outputs.tangent();
  outputs.fields();
  return Measured{};
}

// The cells in another order, and the first one alone with seven copies.
Result lanes(const BatchCase& of) {
  BatchCaller caller(of.instance);
  std::mt19937_64 random(of.seed);
  Order order{}, alone{};
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::shuffle(order, random);
  const Values expected = caller.force(of.batch).force;
  CellBatch single = permuted(of.batch, alone), other = permuted(of.batch, order);
  single.valid = 1;
  other.valid = lane_count;
  const Values reordered = caller.force(other).force, padded = caller.force(single).force;
  const double scale = largest(expected);
  const Measured of_order =
      compare(other, reordered, permuted(expected, order), scale, "in another lane, the force");
  const Measured of_padding =
      compare(single, padded, permuted(expected, alone), scale, "without other cells, the force");
  return of_order.figure >= of_padding.figure ? of_order : of_padding;
}

}  // namespace suture::checks
