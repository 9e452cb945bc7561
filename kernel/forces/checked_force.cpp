// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/checked_force.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <deque>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "kernel/base/aligned.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/lanes.hpp"
#include "kernel/base/types.hpp"
#include "kernel/plugin_host/guarded_array.hpp"
#include "kernel/plugin_host/part_functors.hpp"
#include "kernel/plugin_host/plugin_call.hpp"

namespace suture {
namespace {

// Values between two arrays: one half belongs to each.
constexpr std::size_t margin = 8 * lanes, guard_length = 2 * margin;

// What outputs hold before a call: finite, or the C++ layer would take a value that was never set
// for one that is not finite; nothing that a law gives by chance.
constexpr double first_poison = 0x1.5afe5afe5afe5p-800, second_poison = 0x1.bad0bad0bad0bp+300;
// Around arrays: what is read there spoils the results.
const double guard = std::numeric_limits<double>::quiet_NaN();

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// An array of the batch: `source` of an input, `target` of an output.
struct Array {
  std::string name;
  std::uint32_t components;
  std::size_t size;
  const double* source = nullptr;
  double* target = nullptr;
};

std::string size_of(const Array& array) {
  return array.name + " has " + std::to_string(array.size / lanes) + " rows of " +
         std::to_string(lanes) + " lanes: (node*" + std::to_string(array.components) +
         " + component)*lanes + lane";
}

/// The arrays of the present call's batch, as the tables of its model describe them.
class Arrays {
 public:
  Arrays(const PluginCall& call, const suture_batch& batch) : batch_(batch) {
    add("rest", 3, batch.nodes, batch.rest, nullptr);
    add("position", 3, batch.nodes, batch.position, nullptr);
    add("velocity", 3, batch.nodes, batch.velocity, nullptr);
    const suture_functor& f = *call.functor;
    const suture_model& model = *call.model;
    for (std::uint32_t i = 0; batch.cell_columns != nullptr && i < f.cell_column_count; ++i) {
      const suture_attribute& a = cell_attribute(model, f.cell_columns[i]);
      add(a.name, a.components, 1, batch.cell_columns[i], nullptr);
      cell_columns.push_back(list.size() - 1);
    }
    for (std::uint32_t i = 0; batch.vertex_columns != nullptr && i < f.vertex_column_count; ++i) {
      const bool mass = f.vertex_columns[i] == UINT32_MAX;
      const suture_attribute* a = mass ? nullptr : &model.attributes[f.vertex_columns[i]];
      add(mass ? "mass" : a->name, mass ? 1 : a->components, batch.nodes, batch.vertex_columns[i],
          nullptr);
      vertex_columns.push_back(list.size() - 1);
    }
    add("force", 3, batch.nodes, nullptr, batch.force);
    add_trials(f, model);
  }

  std::vector<Array> list;
  std::vector<std::size_t> cell_columns, vertex_columns, trial_columns;  ///< places in the list

 private:
  void add(const char* name, std::uint32_t components, std::uint32_t nodes, const double* source,
           double* target) {
    list.push_back({name, components, components * nodes * lanes, source, target});
  }
  void add_trials(const suture_functor& f, const suture_model& model) {
    for (std::uint32_t i = 0; batch_.trial_columns != nullptr && i < f.cell_column_count; ++i) {
      const suture_attribute& a = cell_attribute(model, f.cell_columns[i]);
      add(a.name, a.components, 1, nullptr, batch_.trial_columns[i]);
      list.back().name += " (trial)";
      trial_columns.push_back(list.size() - 1);
    }
  }
  const suture_batch& batch_;
};

/// The memory in which a functor's arrays are passed to it, between pages that cannot be accessed:
/// a write far outside of an array is stopped where it happens. Kept, because making it is slow.
std::vector<GuardedArray>& memory_for(const suture_functor* functor, const Arrays& arrays) {
  struct Memory {
    std::deque<std::string> texts;
    std::vector<GuardedArray> arrays;
  };
  static thread_local std::map<const suture_functor*, Memory> all;
  Memory& memory = all[functor];
  if (memory.arrays.empty())
    for (const Array& array : arrays.list) {
      const std::string& name = memory.texts.emplace_back(array.name);
      const std::string& advice = memory.texts.emplace_back(size_of(array));
      memory.arrays.emplace_back(name.c_str(), advice.c_str(), array.size, margin);
    }
  return memory.arrays;
}

/// One call on copies of the arrays, each between two guards.
class Trial {
 public:
  Trial(const PluginCall& call, const suture_batch& batch, const Arrays& arrays, double poison,
        bool mirrored)
      : call_(call),
        batch_(batch),
        arrays_(arrays),
        guarded_(memory_for(call.functor, arrays)),
        poison_(poison),
        mirrored_(mirrored) {
    std::size_t size = guard_length;
    for (const Array& array : arrays.list) {
      places_.push_back(size);
      size += array.size + guard_length;
    }
    memory_.assign(size, guard);
    for (std::size_t i = 0; i < arrays.list.size(); ++i) fill(i);
    for (std::size_t l = 0; l < lanes; ++l) ids_[l] = batch.cell_ids[source_lane(l)];
  }

  suture_status run(const suture_context* context) {
    suture_batch copy = batch_;
    copy.rest = input(0);
    copy.position = input(1);
    copy.velocity = input(2);
    const auto cells = pointers(arrays_.cell_columns), vertices = pointers(arrays_.vertex_columns),
               trials = pointers(arrays_.trial_columns);
    copy.cell_columns = cells.empty() ? nullptr : cells.data();
    copy.vertex_columns = vertices.empty() ? nullptr : vertices.data();
    copy.trial_columns = trials.empty() ? nullptr : trials.data();
    copy.force = guarded_[3 + cells.size() + vertices.size()].data();
    const auto ids = ids_;
    copy.cell_ids = ids_.data();
    if (mirrored_) copy.valid = lanes;  // every lane holds a cell
    for_each_memory(
        [](double* own, double* passed, std::size_t n) { std::copy_n(own, n, passed); });
    const suture_status status = call_.functor->force(context, &copy);
    for_each_memory(
        [](double* own, double* passed, std::size_t n) { std::copy_n(passed, n, own); });
    if (ids != ids_) fail("it wrote into cell_ids, an input", "write outputs only");
    require_guards();
    require_inputs();
    return status;
  }

  void require_outputs() const {
    for_each_output([&](const Array& array, std::size_t i, std::size_t place) {
      const double value = memory_[place];
      if (same_bits(value, poison_))
        fail(at(array, i) + " is never set", "set it for every node, to zero where there is none");
      if (!std::isfinite(value))
        fail(at(array, i) + " is " + std::to_string(value),
             "see that no division, root or logarithm leaves its range, and that no array is read "
             "past its end");
    });
  }

  /// `relative` to the largest value of the batch.
  void require_same(const Trial& other, double relative, const char* what, const char* cure) const {
    double largest = 0;
    for_each_output([&](const Array&, std::size_t, std::size_t place) {
      largest = std::max(largest, std::abs(memory_[place]));
    });
    for_each_output([&](const Array& array, std::size_t i, std::size_t place) {
      const std::size_t mirror = place - i % lanes + other.source_lane(i % lanes);
      if (!(std::abs(memory_[place] - other.memory_[mirror]) <= relative * largest))
        fail(at(array, i) + what, cure);
    });
  }

  void hand_over() const {
    for_each_output([&](const Array& array, std::size_t i, std::size_t place) {
      array.target[i] = memory_[place];
    });
  }

 private:
  std::size_t source_lane(std::size_t lane) const { return mirrored_ ? lanes - 1 - lane : lane; }

  void fill(std::size_t number) {
    const Array& array = arrays_.list[number];
    for (std::size_t i = 0; i < array.size; ++i) memory_[places_[number] + i] = expected(array, i);
  }
  double expected(const Array& array, std::size_t i) const {
    if (array.target != nullptr) return poison_;
    return array.source != nullptr ? array.source[i - i % lanes + source_lane(i % lanes)] : guard;
  }

  /// visit(values of this trial, those that are passed, their number), with margins.
  template <class Visit>
  void for_each_memory(Visit visit) {
    for (std::size_t n = 0; n < arrays_.list.size(); ++n)
      visit(memory_.data() + places_[n] - margin, guarded_[n].data() - margin,
            arrays_.list[n].size + 2 * margin);
  }

  const double* input(std::size_t number) const {
    return arrays_.list[number].source != nullptr ? guarded_[number].data() : nullptr;
  }
  std::vector<double*> pointers(const std::vector<std::size_t>& numbers) {
    std::vector<double*> out;
    for (const std::size_t n : numbers) {
      const bool is_there = arrays_.list[n].source != nullptr || arrays_.list[n].target != nullptr;
      out.push_back(is_there ? guarded_[n].data() : nullptr);
    }
    return out;
  }

  /// visit(array, index in it, place in the memory) for the values of valid lanes.
  template <class Visit>
  void for_each_output(Visit visit) const {
    for (std::size_t n = 0; n < arrays_.list.size(); ++n) {
      const Array& array = arrays_.list[n];
      for (std::size_t i = 0; array.target != nullptr && i < array.size; ++i)
        if (i % lanes < batch_.valid) visit(array, i, places_[n] + i);
    }
  }

  void require_guards() const {
    for (std::size_t n = 0; n < arrays_.list.size(); ++n) {
      const Array& array = arrays_.list[n];
      const std::size_t begin = places_[n], end = begin + array.size;
      for (std::size_t k = 0; k < margin; ++k) {
        const std::string far = std::to_string(k + 1) + (k == 0 ? " double " : " doubles ");
        if (!same_bits(memory_[end + k], guard))
          fail("it wrote " + far + "past the end of " + array.name, size_of(array));
        if (!same_bits(memory_[begin - 1 - k], guard))
          fail("it wrote " + far + "before the beginning of " + array.name, size_of(array));
      }
    }
  }

  void require_inputs() const {
    for (std::size_t n = 0; n < arrays_.list.size(); ++n) {
      const Array& array = arrays_.list[n];
      for (std::size_t i = 0; array.target == nullptr && i < array.size; ++i)
        if (!same_bits(memory_[places_[n] + i], expected(array, i)))
          fail("it wrote into an input: " + at(array, i), "write outputs only");
    }
  }

  std::string at(const Array& array, std::size_t i) const {
    const std::size_t row = i / lanes, node = row / array.components;
    return array.name + " of node " + std::to_string(node) + ", component " +
           std::to_string(row % array.components) + ", of cell " + std::to_string(ids_[i % lanes]);
  }
  [[noreturn]] void fail(const std::string& what, const std::string& cure) const {
    throw PluginError(describe(call_) + ": " + what + "; " + cure);
  }

  const PluginCall& call_;
  const suture_batch& batch_;
  const Arrays& arrays_;
  std::vector<GuardedArray>& guarded_;
  double poison_;
  bool mirrored_;
  std::vector<std::size_t> places_;
  AlignedVector<double> memory_;
  std::array<std::uint32_t, lanes> ids_{};
};

}  // namespace

suture_status checked_force(const suture_context* context, const suture_batch* batch) {
  const PluginCall& call = *present_call();
  const Arrays arrays(call, *batch);
  Trial first(call, *batch, arrays, first_poison, false);
  const suture_status status = first.run(context);
  if (status != SUTURE_OK) return status;
  first.require_outputs();
  Trial second(call, *batch, arrays, second_poison, false);
  if (second.run(context) == SUTURE_OK)
    first.require_same(second, 0, " depends on what it held before the call",
                       "set outputs, do not add to what is there; keep no memory between calls");
  Trial mirrored(call, *batch, arrays, first_poison, true);
  if (mirrored.run(context) == SUTURE_OK)
    first.require_same(mirrored, 1e-9, " depends on the other cells of the batch",
                       "compute each lane from the values of that lane only");
  first.hand_over();
  return status;
}

}  // namespace suture
