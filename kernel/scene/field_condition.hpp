// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "kernel/fields/value_path.hpp"
#include "kernel/forces/time_ramp.hpp"
#include "kernel/scene/selection.hpp"

namespace suture {

/// A condition on a field that models declare (SUTURE_FIELD).
struct FieldCondition {
  enum class Kind {
    start,   ///< the value at the start
    fix,     ///< the value, constant
    move,    ///< the value over time
    flux,    ///< into boundary faces, per rest area and second
    source,  ///< into nodes, per second in total
    film     ///< into boundary faces, per rest area and second: value (outside - u)
  };
  std::string field;
  std::size_t component = 0;
  Kind kind = Kind::start;
  /// In the unit of the field; of a flux and a source, of its rate; of a film, of both as a ratio.
  double value = 0;
  double outside = 0;  ///< of a film, in the unit of the field
  ValuePath path;      ///< of move
  Selection where;
  TimeRamp ramp;      ///< of a flux or source
  std::string place;  ///< "/fields/0"
};

}  // namespace suture
