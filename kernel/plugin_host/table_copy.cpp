// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/table_copy.hpp"

#include "kernel/plugin_host/table_entry.hpp"

namespace suture {
namespace {

class Copier {
 public:
  Copier(PluginTables& tables, const TableSizes& least) : tables_(tables), least_(least) {}

  bool header(const Entry& entry, const suture_plugin& plugin) {
    if (!entry.size(plugin.size, least_.plugin, sizeof plugin)) return false;
    tables_.plugin = copy_of<suture_plugin>(reinterpret_cast<const char*>(&plugin), plugin.size);
    const suture_plugin& p = tables_.plugin;
    return entry.require(p.magic == SUTURE_MAGIC, "its magic number is wrong") &&
           entry.require(p.abi_major == SUTURE_ABI_MAJOR && p.abi_minor <= SUTURE_ABI_MINOR,
                         "its table says ABI " + std::to_string(p.abi_major) + "." +
                             std::to_string(p.abi_minor)) &&
           entry.require(p.lanes == SUTURE_LANES,
                         "its table says " + std::to_string(p.lanes) + " lanes");
  }

  void models(const Entry& entry) {
    suture_plugin& p = tables_.plugin;
    tables_.models = copy_entries(entry, p.models, p.model_count, least_.model, "model");
    for (std::uint32_t i = 0; i < tables_.models.size(); ++i)
      members(entry.inner("model", tables_.models[i].id, i), tables_.models[i]);
  }

 private:
  void members(const Entry& entry, suture_model& m) {
    tables_.parameters.push_back(
        copy_entries(entry, m.parameters, m.parameter_count, least_.parameter, "parameter"));
    tables_.functors.push_back(
        copy_entries(entry, m.functors, m.functor_count, least_.functor, "functor"));
    tables_.attributes.push_back(
        copy_entries(entry, m.attributes, m.attribute_count, least_.attribute, "attribute"));
    auto& attributes = tables_.attributes.back();
    for (std::uint32_t i = 0; i < attributes.size(); ++i) {
      suture_attribute& a = attributes[i];
      tables_.contributions.push_back(copy_entries(entry.inner("attribute", a.name, i),
                                                   a.contributions, a.contribution_count,
                                                   least_.contribution, "contribution"));
      a.contributions = tables_.contributions.back().data();
    }
  }

  PluginTables& tables_;
  const TableSizes& least_;
};

}  // namespace

std::unique_ptr<PluginTables> copy_tables(const suture_plugin& plugin,
                                          std::vector<std::string>& problems,
                                          const TableSizes& least) {
  auto tables = std::make_unique<PluginTables>();
  Copier copier(*tables, least);
  const Entry entry(problems, "");
  if (copier.header(entry, plugin)) copier.models(entry);
  return tables;
}

}  // namespace suture
