// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/base/archive.hpp"

namespace suture {
namespace {

/// std::copy_n() calls memmove.
inline void copy_three(const double* from, double* to) {
  const double x = from[0], y = from[1], z = from[2];
  to[0] = x, to[1] = y, to[2] = z;
}

/// Rows of `columns` (4 doubles each, of which 3 count) side by side, in parts that stay in the
/// cache: a copy of all would cost more than the state itself. `ranges`: of rows, ascending.
template <std::size_t n>
void pack_rows(Archive& archive, const char* name, const std::array<Column*, n>& columns,
               std::span<const PartialRows::Range> ranges) {
  const Index rows = columns[0]->size(), part = archive.has_cells() ? 1 << 14 : 1 << 11;
  std::vector<std::array<double, 3 * n>> packed;
  const auto pack = [&](Index first, Index end) {
    packed.resize(std::min(part, end - first));
    for (std::size_t i = 0; i < n; ++i) {
      const double* row = columns[i]->rows() + std::size_t{first} * 4;
      for (auto& each : packed) copy_three(std::exchange(row, row + 4), each.data() + 3 * i);
    }
  };
  const auto unpack = [&](Index first, Index end) {
    archive.require(packed.size() == std::min(part, end - first), "the number of vertices differs");
    for (std::size_t i = 0; i < n; ++i) {
      double* row = columns[i]->rows() + std::size_t{first} * 4;
      for (const auto& each : packed) copy_three(each.data() + 3 * i, std::exchange(row, row + 4));
    }
  };
  archive.group(name, [&] {
    Index count = rows;
    archive("rows", count);
    archive.require(count == rows, "the number of vertices differs");
    unsigned number = 0;
    for (auto [first, end] : ranges)
      for (; first < end; first += std::min(part, end - first)) {
        if (!archive.loads()) pack(first, end);
        archive(std::to_string(number++).c_str(), packed);
        if (archive.loads()) unpack(first, end);
      }
  });
}

/// "edge (2), memory (2, a state)".
std::string words(const Table& table) {
  std::string text;
  for (const Column& column : table.columns)
    text += (text.empty() ? "" : ", ") + column.spec().name + " (" +
            std::to_string(column.spec().components) + (column.has_trial() ? ", a state)" : ")");
  return text.empty() ? "none" : text;
}

void check_columns(Archive& archive, const Instance& instance, const Table& table) {
  const std::string here = words(table);
  std::string there = here;
  archive("columns", there);
  if (there != here)
    archive.refuse(instance.title() + " had other columns of dimension " +
                   std::to_string(table.dimension) + ": " + there + "; now: " + here);
}

void cells_of_table(Archive& archive, Table& table) {
  archive("cells", table.cells);
  archive("volumes", table.volumes);
}

bool has_removed(const CellSet& cells) {
  for (Index row = 0; row < cells.size(); ++row)
    if (!cells.is_live(row)) return true;
  return false;
}

/// `whole`: not only the states of the model. Other columns of elements are as they were built
/// unless some were copied: their sums are not summed again. Where some were removed, parameters
/// may have changed since: then those that are left do not agree as all did.
void columns_of(Archive& archive, const Instance& instance, Table& table, bool whole) {
  if (archive.has_cells()) check_columns(archive, instance, table);
  if (whole) cells_of_table(archive, table);
  const bool is_built =
      table.dimension == 3 && !instance.has_copies() && !(whole && has_removed(table.cells));
  for (Column& column : table.columns) {
    if (column.has_trial() || (whole && !is_built))
      archive(("column " + column.spec().name).c_str(), column);
    archive.require(column.size() == table.cells.size(), "a column has a different number of rows");
  }
}

void state_of(Archive& archive, Instance& instance, const ElementParts& parts, bool whole) {
  std::string name = instance.title();
  if (archive.has_cells()) archive("title", name);
  if (name != instance.title())
    archive.refuse("the state belongs to " + name + ", but this is " + instance.title());
  std::span<Table, 4> tables = instance.tables();
  archive.each("tables", tables,
               [&](Archive& a, Table& table) { columns_of(a, instance, table, whole); });
  if (whole && instance.has_copies()) instance.state_of_copies(archive, parts);
}

/// The same parameters differ from element to element as in the scene, besides those of `fields`.
void require_openness(const Archive& archive, const Instance& instance,
                      std::span<const double> values, std::span<const std::uint32_t> fields) {
  const std::span built = instance.parameters();
  archive.require(values.size() == built.size(), "the number of parameters differs");
  for (std::size_t i = 0; i < built.size(); ++i) {
    const bool is_field = std::ranges::find(fields, i) != fields.end();
    archive.require(is_field || std::isnan(values[i]) == std::isnan(built[i]),
                    "other parameters differ between elements");
  }
  for (const std::uint32_t field : fields)
    archive.require(field < built.size() && instance.parameter_column(field) != nullptr,
                    "a parameter is the same in all elements here");
}

/// The values of the elements that were built; copies of elements have theirs in their columns.
std::vector<double> built_values(const Instance& instance, std::size_t parameter) {
  const Column& column = *instance.parameter_column(parameter);
  std::vector<double> values;
  for (Index row = 0; row < instance.built_rows(); ++row) values.push_back(column.get(row, 0));
  return values;
}

}  // namespace

void Attributes::parameters(Archive& archive, const CellComplex& complex) {
  std::span instances = instances_;
  archive.each("parameters", instances, [&](Archive& a, std::unique_ptr<Instance>& instance) {
    const std::span built = instance->parameters();
    std::vector<double> values(built.begin(), built.end());
    a("values", values);
    std::vector<std::uint32_t> fields = instance->changed_fields();
    a("fields", fields);
    require_openness(a, *instance, values, fields);
    Diagnostics known;  // what models report was reported when they were changed
    const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
    const auto open = std::numeric_limits<double>::quiet_NaN();
    for (const std::uint32_t field : fields) values[field] = open;
    if (a.loads() && !std::ranges::equal(values, built, {}, bits, bits))
      set_parameters(*instance, std::move(values), complex, known);
    for (const std::uint32_t field : fields) {
      std::vector<double> rows = built_values(*instance, field);
      a(instance->model().parameters[field].name, rows);
      a.require(rows.size() == instance->built_rows(), "a parameter has other elements");
      if (a.loads()) set_field(*instance, field, rows, complex, known);
    }
  });
}

void Attributes::state(Archive& archive) {
  if (archive.has_cells()) {
    if (archive.loads()) {
      complete_rows();
    } else {
      gather_motion();
      force();
    }
    const bool opens_lips =  // when it is built
        std::ranges::any_of(instances_, [](const auto& i) { return !i->lips.empty(); });
    const bool is_fresh = operations_ == (opens_lips ? 1 : 0);
    archive("operations", operations_);
    archive.require(is_fresh || !archive.loads(),
                    "operations have already been applied to this body");
    if (operations_ != 0) kernel_tables(archive);
  }
  motion(archive);
  if (archive.has_cells()) forces(archive);
  std::span instances = instances_;
  archive.each("instances", instances, [&](Archive& a, std::unique_ptr<Instance>& instance) {
    state_of(a, *instance, parts_, a.has_cells() && operations_ != 0);
  });
}

void Attributes::gather_motion() {
  partial_rows_.gather(PartialRows::position, *position_);
  partial_rows_.gather(PartialRows::velocity, *velocity_);
}

/// Operations change the others of the kernel's columns only.
void Attributes::kernel_tables(Archive& archive) {
  archive.each("kernel", kernel_, cells_of_table);
  const auto summed = [&](Column& column) {
    archive(column.spec().name.c_str(), column);
    archive.require(column.size() == kernel(0).cells.size(),
                    "a column has a different number of rows");
  };
  for (Column* column : {rest_, mass_, fixed_}) summed(*column);
  for (const VertexField& field : fields_) {
    for (Column* sum : field.sums())
      if (sum) summed(*sum);
    if (field.rate) field.rate->resize(kernel(0).cells.size());
  }
  for (Column* column : {position_, velocity_, force_}) column->resize(kernel(0).cells.size());
  archive("own_rest", own_rest_);
  if (parts_.may_grow()) archive("parts", parts_);
}

/// Each of several processes goes back to the rows that it knows.
void Attributes::motion(Archive& archive) {
  const PartialRows::Range all{0, position_->size()};
  std::span<const PartialRows::Range> rows;
  if (!archive.has_cells()) rows = partial_rows_.known();  // on all processes
  bool is_whole = archive.has_cells() || partial_rows_.keeps_all || rows.empty();
  if (!archive.has_cells()) archive("is whole", is_whole);
  if (is_whole) rows = {&all, 1};
  pack_rows<2>(archive, "motion", {position_, velocity_}, rows);
  for (const VertexField& field : fields_) {
    archive(("field " + field.name).c_str(), *field.values);
    archive.require(field.values->size() == kernel(0).cells.size(),
                    "a field has a different number of rows");
  }
}

/// Those of sleepers, or of a state whose step is to come; mostly there are none.
void Attributes::forces(Archive& archive) {
  const std::span rows(force_->rows(), std::size_t{force_->size()} * 4);
  bool any = std::ranges::any_of(
      rows, [](double value) { return std::bit_cast<std::uint64_t>(value) != 0; });
  archive("has_forces", any);
  const PartialRows::Range all{0, force_->size()};
  if (any)
    pack_rows<1>(archive, "forces", {force_}, {&all, 1});
  else if (archive.loads())
    std::ranges::fill(rows, 0);
}

}  // namespace suture
