// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/extension_check.hpp"

#include <map>
#include <span>

#include "kernel/plugin_host/part_functors.hpp"
#include "kernel/plugin_host/plugin_call.hpp"
#include "kernel/plugin_host/table_check.hpp"
#include "kernel/plugin_host/table_entry.hpp"
#include "suture/single.h"

namespace suture {
namespace {

class ExtensionCheck {
 public:
  ExtensionCheck(const TableSizes& least, const suture_functor& functor, const Entry& entry)
      : least_(least), functor_(functor), entry_(entry) {}

  /// An extension of one function.
  template <class Table, class Function>
  void one(const char* id, Function Table::*function) const {
    const auto* table = extension_of<Table>(functor_, id);
    if (table == nullptr) return;
    const Entry entry = entry_.inner("extension", id, 0);
    if (!entry.size(table->size, least_.extension, sizeof *table)) return;
    entry.reserved(table->reserved);
    entry.require(table->*function != nullptr, "its function is NULL");
  }

  void single_tangent() const {
    const auto* table = extension_of<suture_tangent_single_1>(functor_, SUTURE_TANGENT_SINGLE_1);
    if (table == nullptr) return;
    const Entry entry = entry_.inner("extension", SUTURE_TANGENT_SINGLE_1, 0);
    if (!entry.size(table->size, sizeof *table, sizeof *table)) return;
    entry.require(table->lanes == SUTURE_SINGLE_LANES, "lanes is " + std::to_string(table->lanes) +
                                                           ", expected " +
                                                           std::to_string(SUTURE_SINGLE_LANES));
    entry.known_bits(table->reads, SUTURE_READ_REST | SUTURE_READ_POSITION | SUTURE_READ_VELOCITY,
                     "reads");
    entry.require(table->columns <= functor_.cell_column_count || table->columns == UINT32_MAX,
                  "columns is " + std::to_string(table->columns) + ", but the functor has " +
                      std::to_string(functor_.cell_column_count) + " cell columns");
    entry.require(table->apply != nullptr, "its function is NULL");
  }

  /// The functor of suture.parts/1 or /2, or null.
  const suture_functor* on_parts(const suture_model& model) const {
    const char* const id = parts_extension(functor_);
    const auto* table = extension_of<suture_parts_1>(functor_, id);
    if (table == nullptr) return nullptr;
    const Entry entry = entry_.inner("extension", id, 0);
    if (!entry.size(table->size, least_.extension, sizeof *table)) return nullptr;
    entry.reserved(table->reserved);
    if (table->functor == nullptr) {
      entry.require(functor_.dimension < 3,
                    "its functor is NULL, which a functor on elements may not have");
      return nullptr;
    }
    if (!entry.size(table->functor->size, least_.functor, sizeof functor_)) return nullptr;
    const suture_functor& f = *functor_on_parts(functor_);
    check_functor(entry, model, f, true);
    const bool may_read_more = functor_.shape == SUTURE_GENERAL;
    entry.require(f.dimension == 3 && functor_.dimension == 3 && f.shape == functor_.shape &&
                      (may_read_more ? f.reads | functor_.reads : functor_.reads) == f.reads,
                  "its functor differs in dimension, shape or reads, or is not on elements");
    return &f;
  }

  /// The fields of suture.output/1, by name; those of other functors are `known`.
  void output(std::map<std::string, std::uint32_t>& known) const {
    const auto* output = extension_of<suture_output_1>(functor_, SUTURE_OUTPUT_1);
    if (output == nullptr) return;
    const Entry entry = entry_.inner("extension", SUTURE_OUTPUT_1, 0);
    if (!entry.size(output->size, least_.output, sizeof *output)) return;
    entry.require(output->compute != nullptr, "its function is NULL");
    Names names;
    const suture_field* fields = output->fields;
    std::uint32_t number = 0;
    for (const suture_field& field :
         copy_entries(entry, fields, output->field_count, least_.field, "field")) {
      const Entry inner = entry.inner("field", field.name, number++);
      names.check(inner, field.name);
      if (field.name != nullptr) components(inner, field, known);
      inner.text(field.unit, "unit");
      inner.text(field.doc, "doc");
    }
  }

 private:
  static void components(const Entry& entry, const suture_field& field,
                         std::map<std::string, std::uint32_t>& known) {
    const std::uint32_t count = field.components;
    if (!entry.require(count == 1 || count == 3 || count == 6,
                       "has " + std::to_string(count) + " components, expected 1, 3 or 6"))
      return;
    const std::uint32_t first = known.emplace(field.name, count).first->second;
    entry.require(count == first, "has " + std::to_string(count) +
                                      " components, but the field of this name in an earlier "
                                      "functor of the model has " +
                                      std::to_string(first));
  }

  const TableSizes& least_;
  const suture_functor& functor_;
  const Entry& entry_;
};

using Fields = std::map<std::string, std::uint32_t>;

void check_functions(const ExtensionCheck& check, Fields& fields) {
  check.one(SUTURE_ENERGY_1, &suture_energy_1::energy);
  check.one(SUTURE_DISSIPATION_1, &suture_dissipation_1::power);
  check.one(SUTURE_STABLE_DT_1, &suture_stable_dt_1::bounds);
  check.one(SUTURE_TANGENT_1, &suture_tangent_1::apply);
  check.single_tangent();
  check.one(SUTURE_INSPECT_1, &suture_inspect_1::inspect);
  check.output(fields);
}

void check_model(const Entry& model, const suture_model& m, const TableSizes& least) {
  Fields fields[4];  // by dimension
  for (const suture_functor& functor : std::span(m.functors, m.functor_count)) {
    const Entry entry = model.inner("functor", functor.name, 0);
    const ExtensionCheck check(least, functor, entry);
    check_functions(check, fields[functor.dimension]);
    const std::size_t before = entry.count();
    const suture_functor* const on_parts = check.on_parts(m);
    if (on_parts == nullptr || entry.count() != before) continue;
    const Entry inner = entry.inner("functor on parts", on_parts->name, 0);
    check_functions({least, *on_parts, inner}, fields[3]);
  }
}

}  // namespace

std::vector<std::string> extension_problems(const suture_plugin& plugin, const TableSizes& least) {
  std::vector<std::string> problems;
  const Entry entry(problems, "");
  for (const suture_model& model : std::span(plugin.models, plugin.model_count))
    check_model(entry.inner("model", model.id, 0), model, least);
  return problems;
}

}  // namespace suture
