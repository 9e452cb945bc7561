// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/base/error.hpp"

namespace suture {

/// An operation that the state of the body does not allow. Nothing has changed.
class RefusedOperation : public NumericalError {
 public:
  using NumericalError::NumericalError;
};

}  // namespace suture
