// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/model_check/parameter_sets.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <span>
#include <sstream>
#include <string_view>

#include "kernel/base/error.hpp"
#include "kernel/base/escape.hpp"
#include "kernel/base/nearest.hpp"

namespace suture {
namespace {

std::span<const suture_parameter> parameters_of(const suture_model& model) {
  return {model.parameters, model.parameter_count};
}

/// What soft tissue has, in elements of a few centimetres.
double typical(std::string_view unit) {
  if (unit == "Pa" || unit == "N/m^2") return 1e4;
  if (unit == "kg/m^3") return 1000;
  if (unit == "Pa s") return 100;
  if (unit == "Pa/m") return 1e7;
  if (unit == "J/m^2") return 100;
  if (unit == "N/m") return 100;
  if (unit == "N s/m") return 1;
  if (unit == "s") return 0.05;
  if (unit == "1") return 0.3;
  return 1;
}

/// A value in the range of the parameter, the typical one if that is.
double value_in_range(const suture_parameter& p) {
  double x = typical(p.unit);
  if (p.type == SUTURE_INTEGER) x = std::ceil(x);
  if (admits(p, x)) return x;
  if (std::isfinite(p.minimum) && std::isfinite(p.maximum))
    x = (p.minimum + p.maximum) / 2;
  else if (std::isfinite(p.minimum))
    x = p.minimum + std::max(1.0, std::abs(p.minimum)) / 2;
  else
    x = p.maximum - std::max(1.0, std::abs(p.maximum)) / 2;
  return p.type == SUTURE_INTEGER ? std::round(x) : x;
}

double value_of(const suture_parameter& p, const std::string& text) {
  for (std::uint32_t i = 0; p.type == SUTURE_CHOICE && i < p.choice_count; ++i)
    if (text == p.choices[i]) return i;
  if (p.type == SUTURE_BOOLEAN && (text == "true" || text == "false")) return text == "true";
  double x = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  const bool is_number = p.type == SUTURE_NUMBER || p.type == SUTURE_INTEGER;
  if (is_number && error == std::errc() && end == text.data() + text.size() && std::isfinite(x) &&
      admits(p, x))
    return x;
  throw UsageError("--set " + quote(std::string(p.name) + "=" + text) +
                   ": the value does not fit the parameter; `suture describe` gives its type and "
                   "range");
}

void require_known(const suture_model& model, const std::map<std::string, std::string>& given) {
  std::vector<std::string> names;
  for (const suture_parameter& p : parameters_of(model)) names.push_back(p.name);
  for (const auto& [name, value] : given)
    if (std::ranges::find(names, name) == names.end())
      throw UsageError("--set " + quote(name + "=" + value) + ": model '" + model.id +
                       "' has no such parameter" + did_you_mean(name, names));
}

/// Required times differ, since most name a beginning and an end.
void spread_times(const suture_model& model, const std::map<std::string, std::string>& given,
                  ParameterSet& set) {
  double times = 0;
  for (std::size_t i = 0; i < model.parameter_count; ++i) {
    const suture_parameter& p = model.parameters[i];
    if (std::string_view(p.unit) != "s" || (p.flags & SUTURE_REQUIRED) == 0) continue;
    const double later = set.values[i] * ++times;
    if (!given.contains(p.name) && admits(p, later)) set.values[i] = later;
  }
}

ParameterSet base_set(const suture_model& model, const std::map<std::string, std::string>& given) {
  ParameterSet set{"default values", {}, false, true};
  for (const suture_parameter& p : parameters_of(model)) {
    const auto found = given.find(p.name);
    if (p.type == SUTURE_DIRECTION)
      set.values.push_back(std::numeric_limits<double>::quiet_NaN());
    else if (found != given.end())
      set.values.push_back(value_of(p, found->second));
    else
      set.values.push_back((p.flags & SUTURE_REQUIRED) != 0 ? value_in_range(p) : p.default_value);
  }
  spread_times(model, given, set);
  return set;
}

/// Other values of a parameter that a set of their own is worth.
std::vector<double> other_values(const suture_parameter& p) {
  std::vector<double> values;
  const bool is_number = p.type == SUTURE_NUMBER || p.type == SUTURE_INTEGER;
  if (is_number && (p.flags & SUTURE_REQUIRED) == 0 && p.default_value == 0)
    values = {value_in_range(p)};
  if (p.type == SUTURE_BOOLEAN) values = {1 - p.default_value};
  for (std::uint32_t i = 0; p.type == SUTURE_CHOICE && i < p.choice_count; ++i)
    if (i != p.default_value) values.push_back(i);
  return values;
}

std::string assignment(const suture_parameter& p, double value) {
  std::ostringstream text;
  text << p.name << " = ";
  if (p.type == SUTURE_CHOICE)
    text << p.choices[static_cast<std::size_t>(value)];
  else if (p.type == SUTURE_BOOLEAN)
    text << (value != 0 ? "true" : "false");
  else if (p.type == SUTURE_DIRECTION)
    text << "[0.48, 0.6, 0.64]";
  else
    text << value << (std::string_view(p.unit) == "1" ? "" : std::string(" ") + p.unit);
  return text.str();
}

}  // namespace

bool admits(const suture_parameter& p, double x) {
  const bool above = (p.flags & SUTURE_MINIMUM_EXCLUDED) != 0 ? x > p.minimum : x >= p.minimum;
  const bool below = (p.flags & SUTURE_MAXIMUM_EXCLUDED) != 0 ? x < p.maximum : x <= p.maximum;
  const bool is_whole = p.type == SUTURE_NUMBER || x == std::floor(x);
  return above && below && is_whole;
}

std::vector<ParameterSet> parameter_sets(const suture_model& model,
                                         const std::map<std::string, std::string>& given) {
  require_known(model, given);
  std::vector<ParameterSet> sets{base_set(model, given)};
  bool may_differ = false;
  for (std::size_t i = 0; i < model.parameter_count; ++i) {
    const suture_parameter& p = model.parameters[i];
    may_differ |= (p.flags & SUTURE_PER_ELEMENT) != 0;
    if (given.contains(p.name)) continue;
    for (const double value : other_values(p)) {
      sets.push_back(sets.front());
      sets.back().name = assignment(p, value);
      sets.back().is_first = false;
      sets.back().values[i] = value;
    }
  }
  if (may_differ) sets.push_back({"values that differ", sets.front().values, true, false});
  return sets;
}

std::vector<double> sample_times(const suture_model& model, const ParameterSet& set) {
  std::set<double> named{0};
  for (std::size_t i = 0; i < model.parameter_count; ++i) {
    const std::string_view unit = model.parameters[i].unit;
    const double value = set.values[i];
    if (unit == "s") named.insert(value);
    if (unit == "1/s" || unit == "Hz") named.insert(1 / value);
  }
  std::vector<double> times;
  double last = 0;
  for (const double time : named) {
    if (!(time > last) || !std::isfinite(time)) continue;
    times.push_back(last + 0.6 * (time - last));  // not the middle, where a sine is zero
    last = time;
  }
  times.insert(times.end(), {last > 0 ? 1.4 * last : 1, 0});
  return times;
}

ParameterSet with_everything_on(const suture_model& model, ParameterSet set) {
  for (std::size_t i = 0; i < model.parameter_count; ++i) {
    const suture_parameter& p = model.parameters[i];
    if (p.type != SUTURE_NUMBER || set.values[i] != 0) continue;
    const double x = value_in_range(p);
    const double other = x * (1 + 0.1 * static_cast<double>(i));  // than those of its unit
    set.values[i] = admits(p, other) ? other : x;
  }
  return set;
}

std::string text_of(const suture_model& model, const ParameterSet& set) {
  std::string text;
  for (std::size_t i = 0; i < model.parameter_count; ++i)
    text += (i == 0 ? "" : ", ") + assignment(model.parameters[i], set.values[i]);
  return set.differs ? text + "; those that may differ from element to element do, by 30 %" : text;
}

}  // namespace suture
