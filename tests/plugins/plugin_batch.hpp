// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dlfcn.h>

#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/base/aligned.hpp"
#include "suture/plugin.h"
#include "tests/plugins/parameter_columns.hpp"

/// What a test needs of the host: loads one file, makes an instance, and fills
/// batches by hand, so that a failure here is the plugin's and nobody else's.
namespace suture::test {

using Point = std::array<double, 3>;
using Hexahedron = std::array<Point, 8>;

/// What plugins are built for and this processor runs: "base", "avx2", "avx512".
inline std::vector<std::string> runnable_isas() {
  std::vector<std::string> isas{"base"};
#if defined(__x86_64__)
  const std::string_view built = INSTRUCTION_SETS;
  const auto add = [&](const char* isa, bool runs) {
    if (runs && built.find(isa) != built.npos) isas.push_back(isa);
  };
  add("avx2", __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"));
  add("avx512", __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"));
#endif
  return isas;
}

inline const suture_plugin& load_plugin(const std::string& folder, const std::string& name,
                                        const std::string& isa) {
  const std::string file = folder + "/" + name + (isa == "base" ? "" : "." + isa) + ".so";
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) throw std::runtime_error(dlerror());
  const auto entry = reinterpret_cast<suture_plugin_fn>(dlsym(library, SUTURE_PLUGIN_SYMBOL));
  if (!entry) throw std::runtime_error(file + " exports no " SUTURE_PLUGIN_SYMBOL);
  return *entry();
}

struct Report {
  int severity;
  std::uint32_t cell;
  std::string key, text;
};

/// One use of a model with given parameters (defaults for those left out at the end);
/// keeps what it reports.
class ModelInstance {
 public:
  ModelInstance(const suture_model& model, std::vector<double> parameters)
      : model_(model), parameters_(std::move(parameters)) {
    for (std::size_t i = parameters_.size(); i < model.parameter_count; ++i)
      parameters_.push_back(model.parameters[i].default_value);
    host_ = {sizeof(suture_host), SUTURE_ABI_MINOR, &ModelInstance::keep,
             [](const char*) { return 0; }};
    error.size = sizeof error;
    memory_.assign(model.instance_bytes / sizeof(double) + 1, 0.0);
    context_ = {sizeof context_,
                std::uint32_t(parameters_.size()),
                parameters_.data(),
                nullptr,
                &host_,
                &error,
                this};
    if (model.prepare) {
      if (model.prepare(&context_, memory_.data()) != SUTURE_OK)
        throw std::runtime_error(error.text);
      context_.instance = memory_.data();
    }
    derive();
  }
  ModelInstance(const ModelInstance&) = delete;

  const suture_context* context() const { return &context_; }
  const suture_model& model() const { return model_; }
  const suture_functor& functor(const std::string& name) const {
    for (std::uint32_t i = 0; i < model_.functor_count; ++i)
      if (model_.functors[i].name == name) return model_.functors[i];
    throw std::runtime_error("no functor " + name);
  }
  template <class Extension>
  static const Extension& extension(const suture_functor& f, const char* id) {
    const void* table = f.extension ? f.extension(id) : nullptr;
    if (!table) throw std::runtime_error(std::string(f.name) + " has no " + id);
    return *static_cast<const Extension*>(table);
  }

  suture_error error{};
  std::vector<Report> reports;

 private:
  /// What is derived from parameters that may differ, for the sake of its reports.
  void derive() {
    const ParameterColumns uniform(model_, parameters_.data());
    const std::array<std::uint32_t, SUTURE_LANES> ids{};
    AlignedVector<double> out(std::size_t{9} * SUTURE_LANES);
    suture_batch batch{};
    batch.size = sizeof batch;
    batch.lanes = batch.valid = SUTURE_LANES;
    batch.nodes = 8;
    batch.cell_ids = ids.data();
    batch.cell_columns = uniform.all();
    for (std::uint32_t a = 0; a < model_.attribute_count; ++a)
      if ((model_.attributes[a].flags & SUTURE_FROM_PARAMETERS) != 0)
        model_.attributes[a].contributions[0].function(&context_, &batch, out.data());
  }
  static void keep(const suture_context* c, int32_t severity, uint32_t cell, const char* key,
                   const char* text) {
    static_cast<ModelInstance*>(c->host_data)->reports.push_back({severity, cell, key, text});
  }

  const suture_model& model_;
  std::vector<double> parameters_;
  suture_host host_{};
  AlignedVector<double> memory_;
  suture_context context_{};
};

/// Eight hexahedra, gathered; columns of a functor filled from the model's
/// contributions as the kernel would (attributes of dimension 3).
class HexahedronBatch {
 public:
  HexahedronBatch(ModelInstance& instance, const suture_functor& functor,
                  const std::array<Hexahedron, 8>& rest)
      : instance_(instance),
        functor_(functor),
        parameters_(instance.model(), instance.context()->parameters) {
    for (int lane = 0; lane < 8; ++lane) set(rest_, lane, rest[lane]);
    position_ = rest_;
    batch.size = sizeof batch;
    batch.lanes = SUTURE_LANES;
    batch.valid = SUTURE_LANES;
    batch.nodes = 8;
    batch.cell_ids = ids_.data();
    batch.rest = rest_.data();  // as contributions get it
    batch.cell_columns = parameters_.all();
    for (std::uint32_t k = 0; k < functor.cell_column_count; ++k) {
      const suture_attribute& a = instance.model().attributes[functor.cell_columns[k]];
      columns_.emplace_back(a.components * 8, a.initial);
      trials_.emplace_back((a.flags & SUTURE_TRIAL) != 0 ? a.components * 8 : 0);
      if (const auto* given = parameters_.find(functor.cell_columns[k]))
        columns_.back() = *given;
      else if (a.contribution_count != 0)
        check(a.contributions[0].function(instance.context(), &batch, columns_.back().data()));
    }
    point_to_columns();
    batch.rest = functor.reads & SUTURE_READ_REST ? rest_.data() : nullptr;
    batch.position = functor.reads & SUTURE_READ_POSITION ? position_.data() : nullptr;
    batch.force = force_.data();
  }
  HexahedronBatch(const HexahedronBatch&) = delete;

  void move(int lane, const Hexahedron& x) { set(position_, lane, x); }
  double& position(int lane, int node, int c) { return position_[(node * 3 + c) * 8 + lane]; }

  suture_status force() { return functor_.force(instance_.context(), &batch); }
  double force_at(int lane, int node, int c) const { return force_[(node * 3 + c) * 8 + lane]; }

  std::array<double, 8> energy() {
    alignas(64) std::array<double, 8> out;
    check(ModelInstance::extension<suture_energy_1>(functor_, SUTURE_ENERGY_1)
              .energy(instance_.context(), &batch, out.data()));
    return out;
  }
  /// df for the direction dx, laid out as a batch's force.
  AlignedVector<double> tangent(const AlignedVector<double>& dx) {
    AlignedVector<double> dv(192, 0.0), df(192);
    check(ModelInstance::extension<suture_tangent_1>(functor_, SUTURE_TANGENT_1)
              .apply(instance_.context(), &batch, dx.data(), dv.data(), df.data()));
    return df;
  }
  /// The bound matrices: stiffness[(node*6 + c)*8 + lane].
  AlignedVector<double> stiffness_bounds() {
    AlignedVector<double> k(384), c(384);
    check(ModelInstance::extension<suture_stable_dt_1>(functor_, SUTURE_STABLE_DT_1)
              .bounds(instance_.context(), &batch, k.data(), c.data()));
    return k;
  }
  /// What the elements contribute to an attribute.
  suture_status contribute(const suture_attribute& attribute, AlignedVector<double>& out) {
    suture_batch rest = batch;
    rest.rest = rest_.data();
    rest.cell_columns = parameters_.all();
    return attribute.contributions[0].function(instance_.context(), &rest, out.data());
  }
  /// An output field: value[component*8 + lane].
  AlignedVector<double> field(const std::string& name) {
    const auto& table = ModelInstance::extension<suture_output_1>(functor_, SUTURE_OUTPUT_1);
    std::vector<double*> out(table.field_count, nullptr);
    AlignedVector<double> values;
    for (std::uint32_t i = 0; i < table.field_count; ++i)
      if (table.fields[i].name == name) {
        values.resize(table.fields[i].components * 8);
        out[i] = values.data();
      }
    check(table.compute(instance_.context(), &batch, out.data()));
    return values;
  }

  /// The states that the last call of force() found become those from which the next one starts.
  void accept() {
    for (std::size_t k = 0; k < columns_.size(); ++k)
      if (!trials_[k].empty()) columns_[k].swap(trials_[k]);
    point_to_columns();
  }
  const std::vector<AlignedVector<double>>& columns() const { return columns_; }
  const double* rest() const { return rest_.data(); }

  suture_batch batch{};

 private:
  void point_to_columns() {
    pointers_.clear();
    trial_pointers_.clear();
    for (auto& c : columns_) pointers_.push_back(c.data());
    for (auto& t : trials_) trial_pointers_.push_back(t.empty() ? nullptr : t.data());
    batch.cell_columns = pointers_.data();
    batch.trial_columns = trial_pointers_.data();
  }
  static void set(AlignedVector<double>& v, int lane, const Hexahedron& x) {
    for (int n = 0; n < 8; ++n)
      for (int c = 0; c < 3; ++c) v[(n * 3 + c) * 8 + lane] = x[n][c];
  }
  void check(suture_status status) {
    if (status != SUTURE_OK) throw std::runtime_error(instance_.error.text);
  }

  ModelInstance& instance_;
  const suture_functor& functor_;
  ParameterColumns parameters_;
  AlignedVector<double> rest_ = AlignedVector<double>(192), position_ = AlignedVector<double>(192),
                        force_ = AlignedVector<double>(192);
  std::array<std::uint32_t, 8> ids_{10, 11, 12, 13, 14, 15, 16, 17};
  std::vector<AlignedVector<double>> columns_, trials_;
  std::vector<const double*> pointers_;
  std::vector<double*> trial_pointers_;
};

}  // namespace suture::test
