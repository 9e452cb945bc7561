// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

#include "suture/plugin.h"

namespace suture {

/// Values of a model's parameters with which it is checked.
struct ParameterSet {
  std::string name;            ///< "element = trilinear": how it differs from the first one
  std::vector<double> values;  ///< in declared order; NaN for directions
  /// Parameters that may differ from element to element do, by up to 30 %, within their ranges.
  bool differs = false;
  bool is_first = false;
};

/// First the defaults, and typical values of parameters without one, by their unit and range; then
/// one set for every other choice, for every boolean, and for every number that is 0 by default;
/// last a set that differs from element to element, if the model allows that. `given` values hold
/// in all sets. Throws UsageError for a name or value that the model does not have.
std::vector<ParameterSet> parameter_sets(const suture_model& model,
                                         const std::map<std::string, std::string>& given);

/// All numbers that are 0 by default take another value, so that what they switch on runs.
ParameterSet with_everything_on(const suture_model& model, ParameterSet set);

/// Times at which a model is checked, s: 0, and one in every interval between the times that its
/// parameters name (those in s, and the periods of those in 1/s and Hz) and after the last one, so
/// that what begins, grows or ends there is seen.
std::vector<double> sample_times(const suture_model& model, const ParameterSet& set);

/// Whether the range of the parameter includes the number.
bool admits(const suture_parameter& parameter, double value);

/// "E = 1e+04 Pa, element = trilinear".
std::string text_of(const suture_model& model, const ParameterSet& set);

}  // namespace suture
