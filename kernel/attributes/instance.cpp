// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/instance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string_view>
#include <utility>

#include "kernel/attributes/shape.hpp"
#include "kernel/base/archive.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/reset_error.hpp"
#include "kernel/plugin_host/host_extensions.hpp"
#include "kernel/plugin_host/part_functors.hpp"

namespace suture {
namespace {

void report(const suture_context* context, std::int32_t severity, std::uint32_t cell,
            const char* key, const char* text) {
  static_cast<Findings*>(context->host_data)->add(severity, cell, key, text);
}

std::int32_t has_extension(const char* id) { return host_has_extension(id) ? 1 : 0; }

const suture_host host = {sizeof(suture_host), SUTURE_ABI_MINOR, &report, &has_extension};

// Behind the memory that a model asked for: one that stores more is found.
constexpr double prepared_guard = 0x1.5afe5afe5afe5p-800;

/// Cells of dimension 0..2 of the given elements, ascending.
template <class CellsOf>
std::vector<Index> incident_cells(const CellSet& region, Index cell_count, CellsOf cells_of) {
  std::vector<bool> touched(cell_count, false);
  for (const Index e : region.cells())
    for (const Index cell : cells_of(e)) touched[cell] = true;
  std::vector<Index> cells;
  for (Index cell = 0; cell < cell_count; ++cell)
    if (touched[cell]) cells.push_back(cell);
  return cells;
}

CellSet cells_of_region(const CellComplex& complex, const CellSet& region, int dimension) {
  const Index count = complex.count(dimension);
  if (region.size() == complex.element_count()) return all_cells(complex, dimension);
  switch (dimension) {
    case 0:
      return CellSet::of(
          incident_cells(
              region, count, [&](Index e) -> auto& { return complex.vertices_of(e); }),
          count);
    case 1:
      return CellSet::of(incident_cells(
                             region, count, [&](Index e) -> auto& { return complex.edges_of(e); }),
                         count);
    default:
      return CellSet::of(incident_cells(
                             region, count, [&](Index e) -> auto& { return complex.faces_of(e); }),
                         count);
  }
}

}  // namespace

CellSet all_cells(const CellComplex& complex, int dimension) {
  CellSet cells = CellSet::all(complex.count(dimension));
  for (Index cell = 0; cell < cells.size() && complex.existing(dimension) < cells.size(); ++cell)
    if (!complex.exists(dimension, cell)) cells.remove(cell);
  return cells;
}

Instance::Instance(const suture_model& model, std::string name, std::vector<double> parameters,
                   Diagnostics& diagnostics, bool skip, std::vector<GivenColumn> given)
    : model_(model),
      name_(std::move(name)),
      parameters_(std::move(parameters)),
      given_(std::move(given)),
      skip_(skip) {
  if (parameters_.size() != model_.parameter_count)
    throw PluginError(title() + ": declares " + std::to_string(model_.parameter_count) +
                      " parameters, but " + std::to_string(parameters_.size()) + " were given");
  for (int d = 0; d < 4; ++d) table(d).dimension = d;
  if (model_.instance_bytes != 0) {
    constexpr std::size_t row = 8 * sizeof(double);
    prepared_.emplace("its memory",
                      "the model's instance_bytes must be the size of what prepare stores",
                      (model_.instance_bytes / row + 2) * 8);
    std::ranges::fill(behind_own_memory(), prepared_guard);
  }
  set_workers(1);
  prepare(diagnostics);
  ask_functors();
}

Instance::~Instance() = default;

std::string Instance::title() const { return "model '" + name_ + "' (" + model_.id + ")"; }

void Instance::set_workers(unsigned count) {
  while (workers_.size() < count) {
    auto worker = std::make_unique<Worker>();
    worker->context = {sizeof(suture_context),
                       static_cast<std::uint32_t>(parameters_.size()),
                       parameters_.data(),
                       own_memory(),
                       &host,
                       &worker->error,
                       &findings_};
    reset(worker->error);
    workers_.push_back(std::move(worker));
  }
}

/// At least 8 values.
std::span<double> Instance::behind_own_memory() const {
  const std::size_t own = (model_.instance_bytes + sizeof(double) - 1) / sizeof(double);
  return {prepared_->data() + own, prepared_->end()};
}

void Instance::prepare(Diagnostics& diagnostics) {
  if (!model_.prepare) return;
  const suture_status status = call_plugin(call("prepare"), workers_[0]->error, [&] {
    return model_.prepare(&context(0), own_memory());
  });
  const auto is_guard = [](double value) { return value == prepared_guard; };
  if (prepared_ && !std::ranges::all_of(behind_own_memory(), is_guard))
    throw PluginError(describe(call("prepare")) + ": it wrote behind its " +
                      std::to_string(model_.instance_bytes) +
                      " bytes of memory; the model's instance_bytes must be the size of what "
                      "prepare stores");
  deliver_findings(diagnostics);
  if (status != SUTURE_OK)
    throw PluginError(title() + " could not be prepared: " + text_of(workers_[0]->error));
}

void Instance::ask_functors() {
  enabled_.clear();
  for (const suture_functor& f : std::span(model_.functors, model_.functor_count)) {
    Enabled answer{true, f.reads};
    PluginCall asked = call("enabled");
    asked.functor = &f;
    if (f.enabled)
      answer.runs = call_plugin(asked, [&] { return f.enabled(&context(0), &answer.reads); }) != 0;
    if (!skip_ && f.alternative == 0) answer.runs = true;
    answer.reads = skip_ ? answer.reads & f.reads : f.reads;
    enabled_.push_back(answer);
  }
  for (std::size_t i = 0; i < enabled_.size(); ++i)
    if (model_.functors[i].alternative != 0 && enabled_[i].runs) choose_alternative(i);
  find_needed();
}

/// Alternatives begin with the cheapest: the first that is enabled runs, or the last if
/// nothing is skipped.
void Instance::choose_alternative(std::size_t number) {
  for (std::size_t i = number + 1; i < enabled_.size(); ++i) {
    if (model_.functors[i].alternative != model_.functors[number].alternative) continue;
    if (!enabled_[i].runs) continue;
    enabled_[skip_ ? i : number].runs = false;
    if (!skip_) return;
  }
}

void Instance::find_needed() {
  constexpr std::uint32_t for_others = SUTURE_OUTPUT | SUTURE_PARAMETER;
  needed_.clear();
  for (std::uint32_t a = 0; a < model_.attribute_count; ++a)
    needed_.push_back(!skip_ || is_of_kernel(model_.attributes[a]) ||
                      (model_.attributes[a].flags & for_others) != 0 || is_read(a));
}

/// By a functor that runs, or by none at all: then it is there for others.
bool Instance::is_read(std::uint32_t attribute) const {
  const auto reads = [&](const suture_functor& f) {
    return std::ranges::count(std::span(f.cell_columns, f.cell_column_count), attribute) != 0 ||
           std::ranges::count(std::span(f.vertex_columns, f.vertex_column_count), attribute) != 0;
  };
  bool named = false;
  for (std::uint32_t i = 0; i < model_.functor_count; ++i) {
    const suture_functor& f = model_.functors[i];
    const suture_functor* const on_parts = part_functor(i);
    const bool is_read_on_parts = on_parts != nullptr && reads(*on_parts);
    if (enabled_[i].runs && ((reads(f) && has_cells(f)) || is_read_on_parts)) return true;
    named |= reads(f) || is_read_on_parts;
  }
  return !named;
}

/// False if no full element of the region has the shape that the functor is written for;
/// known once the region is.
bool Instance::has_cells(const suture_functor& functor) const {
  const Index elements = table(3).cells.size();
  if (elements == 0 || functor.dimension != 3 || functor.shape == SUTURE_ANY_SHAPE) return true;
  return functor.shape == SUTURE_PARALLELEPIPED ? general_begin > 0 : general_begin < part_begin;
}

bool Instance::uses(int dimension) const {
  const auto d = static_cast<std::uint32_t>(dimension);
  for (std::uint32_t a = 0; a < model_.attribute_count; ++a) {
    const suture_attribute& attribute = model_.attributes[a];
    if (attribute.dimension == d && !is_of_kernel(attribute) && needs(a)) return true;
  }
  for (std::uint32_t i = 0; i < model_.functor_count; ++i)
    if (model_.functors[i].dimension == d && enabled_[i].runs) return true;
  return false;
}

bool Instance::asks_for_shape() const {
  const std::span functors(model_.functors, model_.functor_count);
  return std::ranges::any_of(functors, [](const suture_functor& f) {
    return f.dimension == 3 && f.shape != SUTURE_ANY_SHAPE;
  });
}

CellSet Instance::region(const RestPlaces& rest, std::vector<Index> elements) {
  const CellComplex& complex = rest.complex();
  const Index count = complex.element_count();
  if (elements.empty() || elements.size() == count) {
    elements.resize(count);
    std::iota(elements.begin(), elements.end(), Index{0});
    std::erase_if(elements, [&](Index e) { return !complex.exists(3, e); });
  }
  const ElementParts& parts = rest.parts();
  const auto partial = parts.empty()
                           ? elements.end()
                           : std::stable_partition(elements.begin(), elements.end(),
                                                   [&](Index e) { return parts.of(e) == nullptr; });
  part_begin = static_cast<Index>(partial - elements.begin());
  if (asks_for_shape()) {
    const auto has_parallel_edges = [&](Index e) { return is_parallelepiped(rest.of(e)); };
    const auto general = std::stable_partition(elements.begin(), partial, has_parallel_edges);
    general_begin = static_cast<Index>(general - elements.begin());
    const auto skewed = std::stable_partition(elements.begin(), general,
                                              [&](Index e) { return is_box(rest.of(e)); });
    skewed_begin = static_cast<Index>(skewed - elements.begin());
  } else {
    skewed_begin = general_begin = part_begin;
  }
  if (elements.size() == count && std::ranges::is_sorted(elements)) return CellSet::all(count);
  return CellSet::of(std::move(elements), count);
}

void Instance::build(CellComplex& complex, const RestPlaces& rest, std::vector<Index> elements) {
  if (uses(1)) complex.require_edges();
  if (uses(2)) complex.require_faces();
  table(3).cells = region(rest, std::move(elements));
  built_rows_ = table(3).cells.size();
  may_get_parts_ = rest.parts().may_grow();
  parts_are_general_ = rest.parts().are_general();
  if (has_parts() || may_get_parts_) find_part_functors();
  fill_parts(rest.parts(), part_begin);
  find_needed();
  for (int d = 0; d < 3; ++d)
    if (uses(d)) table(d).cells = cells_of_region(complex, table(3).cells, d);
  columns_.clear();
  shared_columns_.assign(model_.attribute_count, nullptr);
  for (std::uint32_t i = 0; i < model_.attribute_count; ++i) {
    const suture_attribute& a = model_.attributes[i];
    const bool own = !is_of_kernel(a) && needs(i);
    columns_.push_back(own ? &table(static_cast<int>(a.dimension)).add(spec_of(a)) : nullptr);
  }
  fill_columns();
}

/// Functors of one shape compute all parts.
void Instance::find_part_functors() {
  const std::span functors(model_.functors, model_.functor_count);
  const std::uint32_t shape = parts_are_general_ ? SUTURE_GENERAL : SUTURE_PARALLELEPIPED;
  const bool has_functor = std::ranges::count(functors, shape, &suture_functor::shape) != 0;
  for (std::uint32_t i = 0; i < model_.functor_count; ++i) {
    const suture_functor& f = functors[i];
    const bool is_of_other = f.shape != SUTURE_ANY_SHAPE && f.shape != shape;
    const bool is_left_to_another = is_of_other && (has_functor || f.shape == SUTURE_GENERAL);
    part_functors_.push_back(is_of_other ? nullptr : functor_on_parts(f));
    if (enabled_[i].runs && !is_left_to_another && (is_of_other || !allows_parts(f)))
      refuse_parts(f);
  }
}

void Instance::refuse_parts(const suture_functor& functor) const {
  const Index all = table(3).cells.size();
  const std::string fault = title() + ": functor '" + functor.name +
                            "' is not made for elements of which only a part is material, as ";
  if (!has_parts())
    throw InputError(fault +
                     "cuts with \"along\": \"blade\" make them; cut along \"faces\", or choose "
                     "another model");
  throw InputError(fault + std::to_string(all - part_begin) + " of " + std::to_string(all) +
                   " elements are; fill the body with whole elements, or choose another model");
}

void Instance::add_copies(std::span<const Split> copies, const ElementParts& parts) {
  CellSet& cells = table(3).cells;
  const Index first_row = cells.size();
  std::vector<RowSplit> rows;
  std::vector<double> shares;
  for (const auto& [origin, copy] : copies) {
    if (!cells.contains(origin)) continue;
    rows.push_back({cells.row(origin), first_row + static_cast<Index>(rows.size())});
    shares.push_back(parts.fraction(copy) / parts.fraction(origin));
    if (!cells.is_all()) cells.append(copy);
  }
  if (rows.empty()) return;
  for (const RowSplit& row : rows)
    shapes_.push_back(static_cast<std::uint8_t>(whole_shape(row.old_row)));
  if (cells.is_all()) cells.append_all(static_cast<Index>(rows.size()));
  for (Column& column : table(3).columns) {
    column.append_copies(rows);
    for (std::size_t i = 0; i < rows.size() && column.spec().policy == SUTURE_SHARE; ++i)
      column.scale_row(rows[i].new_row, shares[i]);
  }
  fill_parts(parts, first_row);
}

void Instance::state_of_copies(Archive& archive, const ElementParts& parts) {
  archive("shapes", shapes_);
  archive.require(shapes_.size() == table(3).cells.size() - part_begin, "the rows differ");
  if (archive.loads()) fill_parts(parts, part_begin);
}

void Instance::fill_parts(const ElementParts& parts, Index first_row) {
  if (!has_parts()) return;
  const Index rows = table(3).cells.size(), lanes = SUTURE_LANES;
  shapes_.resize(rows - part_begin, static_cast<std::uint8_t>(RowShape::general));
  is_part_.resize(rows - part_begin);
  for (Index row = first_row; row < rows; ++row)
    is_part_[row - part_begin] = parts.of(table(3).cells.cell(row)) != nullptr ? 1 : 0;
  moments_.resize(part_begin, rows);
  if (parts_are_general_) general_parts_.resize(part_begin, rows);
  // Behind the last one, in its block, are copies of it, so that nobody divides by 0.
  for (Index row = first_row; row < (rows + lanes - 1) / lanes * lanes; ++row) {
    const Index element = table(3).cells.cell(std::min(row, rows - 1));
    const PartMoments* const part = parts.of(element);
    const PartMoments m = part ? *part : PartMoments{};
    const auto& [x, y, z] = m.centroid;
    const auto& [yz, xz, xy] = m.covariance;
    moments_.set(row, std::array{m.fraction, x, y, z, yz + y * z, xz + x * z, xy + x * y});
    if (!parts_are_general_) continue;
    std::array<double, SUTURE_GENERAL_PART_COMPONENTS> values{m.fraction};
    for (std::size_t i = 0; i < 12 && part; ++i)
      values[i + 1] = parts.general(element).gradients[i / 3][i % 3];
    general_parts_.set(row, values);
  }
}

Column* Instance::parameter_column(std::size_t parameter) const {
  const std::string_view name = model_.parameters[parameter].name;
  for (std::uint32_t i = 0; i < model_.attribute_count; ++i)
    if ((model_.attributes[i].flags & SUTURE_PARAMETER) != 0 && model_.attributes[i].name == name)
      return columns_[i];
  return nullptr;
}

/// The columns of parameters that do not differ from element to element.
void Instance::fill_parameter_columns() {
  parameter_columns_.clear();
  const std::span parameters(model_.parameters, model_.parameter_count);
  for (std::uint32_t i = 0; i < model_.attribute_count; ++i) {
    if ((model_.attributes[i].flags & SUTURE_PARAMETER) == 0) continue;
    const std::string_view name = model_.attributes[i].name;
    const auto of =
        std::ranges::find_if(parameters, [&](const suture_parameter& p) { return p.name == name; });
    const double value = parameters_[static_cast<std::size_t>(of - parameters.begin())];
    if (!std::isnan(value)) columns_[i]->fill(value);
    parameter_columns_.push_back(columns_[i]);
  }
}

void Instance::set_parameters(std::vector<double> parameters, Diagnostics& diagnostics) {
  const std::vector<double> values = parameters_;
  const std::vector<Enabled> enabled = enabled_;
  const std::vector<double> memory(own_memory() ? prepared_->data() : nullptr,
                                   own_memory() ? prepared_->end() : nullptr);
  try {
    std::ranges::copy(parameters, parameters_.begin());  // contexts point there
    prepare(diagnostics);
    ask_functors();
    if (enabled_ != enabled)
      throw InputError(title() +
                       ": these values switch functors of the model on or off, which is decided "
                       "when a scene is built; give it values with which the same functors run");
  } catch (...) {
    std::ranges::copy(values, parameters_.begin());
    if (own_memory()) std::ranges::copy(memory, prepared_->data());
    enabled_ = enabled;
    find_needed();
    throw;
  }
  fill_parameter_columns();
}

void Instance::set_field(std::size_t parameter, std::span<const double> values,
                         Diagnostics& diagnostics) {
  Column& column = *parameter_column(parameter);
  std::vector<double> parameters = parameters_;
  parameters[parameter] = std::numeric_limits<double>::quiet_NaN();
  set_parameters(std::move(parameters), diagnostics);
  for (Index row = 0; row < values.size(); ++row) column.set(row, 0, values[row]);
  const auto number = static_cast<std::uint32_t>(parameter);
  const auto place = std::ranges::lower_bound(changed_fields_, number);
  if (place == changed_fields_.end() || *place != number) changed_fields_.insert(place, number);
}

std::vector<std::uint32_t> Instance::changed_fields() const {
  std::vector<std::uint32_t> fields = changed_fields_;
  std::erase_if(fields, [&](std::uint32_t field) { return !std::isnan(parameters_[field]); });
  return fields;
}

/// Uniform parameters fill their columns, then comes what the scene gives.
void Instance::fill_columns() {
  fill_parameter_columns();
  for (const GivenColumn& given : given_)
    if (columns_[given.attribute] != nullptr) fill(given);
  given_.clear();
}

void Instance::fill(const GivenColumn& given) {
  Column& column = *columns_[given.attribute];
  const CellSet& cells = table(column.dimension()).cells;
  const auto components = static_cast<std::size_t>(column.spec().components);
  column.expand();
  for (Index row = 0; row < cells.size(); ++row) {
    const double* from = given.values.data() + (given.by_cell ? components * cells.cell(row) : 0);
    for (std::size_t c = 0; c < components; ++c) column.set(row, static_cast<int>(c), from[c]);
  }
  if (skip_) column.compress(0);
  if (given.by_cell) by_cell_.push_back(&column);
}

}  // namespace suture
