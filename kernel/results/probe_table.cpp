// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/results/probe_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "kernel/base/error.hpp"
#include "kernel/base/nearest.hpp"

namespace suture {
namespace {

using On = FieldChoice::On;

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

FieldChoice position() {
  FieldChoice field{"position", On::points, false, {}};
  field.components = 3;
  field.unit = "m";
  field.value = [](BuiltScene& built, const Vec3&, Index v, int a) {
    const double x = built.body().attributes().position().get(v, a);
    return x + built.frame().origin[static_cast<std::size_t>(a)];
  };
  return field;
}

Probe::Of usual(const std::string& field) {
  const bool adds_up = field == "force" || field == "reaction" || field == "reaction_moment" ||
                       field == "contact_force";
  return adds_up ? Probe::Of::sum : Probe::Of::mean;
}

/// The elements that have one of these vertices, ascending.
std::vector<Index> elements_around(BuiltScene& built, const std::vector<Index>& vertices) {
  const CellComplex& complex = built.body().complex();
  std::vector<Index> elements;
  for (Index e = 0; e < complex.element_count(); ++e) {
    const bool touches =
        complex.exists(3, e) && std::ranges::any_of(complex.vertices_of(e), [&](Index v) {
          return std::ranges::binary_search(vertices, v);
        });
    if (touches) elements.push_back(e);
  }
  return elements;
}

std::vector<Index> cells_of(const Probe& probe, On on, BuiltScene& built) {
  if (on == On::points) return built.selector().vertices(probe.where);
  return probe.at_point ? elements_around(built, built.selector().vertices(probe.where))
                        : built.selector().elements(probe.where);
}

/// Values of one component, taken in one by one.
class Reduction {
 public:
  explicit Reduction(Probe::Of of) : of_(of) {}

  void add(double value) {
    if (count_ == 0 && (of_ == Probe::Of::min || of_ == Probe::Of::max))
      result_ = value;
    else if (of_ == Probe::Of::min)
      result_ = std::min(result_, value);
    else if (of_ == Probe::Of::max)
      result_ = std::max(result_, value);
    else
      result_ += value;
    ++count_;
  }
  bool is_empty() const { return count_ == 0; }
  double result() const {
    if (is_empty()) return no_value;
    return of_ == Probe::Of::mean ? result_ / count_ : result_;
  }

 private:
  Probe::Of of_;
  double result_ = 0, count_ = 0;
};

}  // namespace

ProbeTable::ProbeTable(const OutputOptions& options, BuiltScene& built) : built_(built) {
  std::vector<FieldChoice> all{position()};
  for (FieldChoice& field : all_fields(built)) all.push_back(std::move(field));
  for (const Probe& probe : options.probes) add(probe, all);
  computed_.resize(fields_.size());
}

void ProbeTable::add(const Probe& probe, const std::vector<FieldChoice>& all) {
  std::vector<Index> cells[2];  // chosen when a field lies on them
  std::vector<std::string> names = probe.fields;
  if (names.empty()) names = {"position", "displacement", "force"};
  for (const std::string& name : names) {
    const FieldChoice& field = field_named(all, name, probe.path + "/fields");
    std::vector<Index>& chosen = cells[field.on == On::points ? 0 : 1];
    if (chosen.empty()) chosen = cells_of(probe, field.on, built_);
    entries_.push_back({probe.name, add_field(field), probe.of.value_or(usual(name)), chosen});
  }
}

std::size_t ProbeTable::add_field(const FieldChoice& field) {
  const auto same = [&](const FieldChoice& f) { return f.name == field.name && f.on == field.on; };
  const auto found = std::ranges::find_if(fields_, same);
  const auto place = static_cast<std::size_t>(found - fields_.begin());
  if (found == fields_.end()) fields_.push_back(field);
  return place;
}

bool ProbeTable::needs(bool FieldChoice::*what) const {
  return std::ranges::any_of(fields_, [&](const FieldChoice& f) { return f.*what; });
}

std::vector<std::string> ProbeTable::columns() const {
  std::vector<std::string> columns{"time [s]"};
  for (const Entry& entry : entries_) {
    const FieldChoice& field = fields_[entry.field];
    const bool has_unit = !field.unit.empty() && field.unit != "1";
    for (const std::string& component : component_names(field)) {
      std::string column = entry.probe + ' ' + field.name;
      if (!component.empty()) column += ' ' + component;
      if (has_unit) column += " [" + field.unit + ']';
      columns.push_back(std::move(column));
    }
  }
  return columns;
}

std::vector<ProbeTable::Quantity> ProbeTable::quantities() const {
  std::vector<Quantity> quantities;
  for (const Entry& entry : entries_) {
    const FieldChoice& field = fields_[entry.field];
    quantities.push_back({entry.probe, field.name, field.components});
  }
  return quantities;
}

ProbeTable::Cover ProbeTable::cover(const std::string& probe, const std::string& field) const {
  std::vector<std::string> names;
  for (const Entry& entry : entries_) {
    names.push_back(entry.probe + ' ' + fields_[entry.field].name);
    if (names.back() != probe + ' ' + field) continue;
    Cover cover{entry.cells, entry.of};
    const int dimension = fields_[entry.field].on == FieldChoice::On::points ? 0 : 3;
    std::erase_if(cover.cells,
                  [&](Index cell) { return !built_.body().complex().exists(dimension, cell); });
    return cover;
  }
  throw InputError("no probe gives '" + probe + ' ' + field + "'" +
                   did_you_mean(probe + ' ' + field, names) + "; see /output/probes");
}

const std::vector<double>& ProbeTable::row(double time, const Vec3& gravity) {
  for (std::size_t f = 0; f < fields_.size(); ++f)
    if (!fields_[f].value) fields_[f].fill({built_, gravity, time}, computed_[f]);
  values_.assign(1, time);
  for (const Entry& entry : entries_) append(entry, gravity);
  return values_;
}

// Elements of a model that does not give the field have NaN, and are left out.
void ProbeTable::append(const Entry& entry, const Vec3& gravity) {
  const FieldChoice& field = fields_[entry.field];
  const FrameField& computed = computed_[entry.field];
  const auto width = static_cast<std::size_t>(field.components);
  const auto value = [&](Index cell, std::size_t c) {
    if (field.value) return field.value(built_, gravity, cell, static_cast<int>(c));
    return computed.ids.empty() ? computed.values[cell * width + c]
                                : static_cast<double>(computed.ids[cell]);
  };
  const CellComplex& complex = built_.body().complex();
  const int dimension = field.on == On::points ? 0 : 3;
  for (std::size_t c = 0; c < width; ++c) {
    Reduction reduction(entry.of);
    for (const Index cell : entry.cells) {
      if (!complex.exists(dimension, cell)) continue;
      const double x = value(cell, c);
      if (field.value || !std::isnan(x)) reduction.add(x);
    }
    values_.push_back(reduction.result());
    const bool may_be_undefined = !field.value || field.name == "gap" || reduction.is_empty();
    if (std::isinf(values_.back()) || (std::isnan(values_.back()) && !may_be_undefined))
      throw NumericalError("the probe '" + entry.probe + "' has a value of " + field.name +
                           " that is not finite; the forces or lengths of the scene are too large "
                           "to compute with");
  }
}

}  // namespace suture
