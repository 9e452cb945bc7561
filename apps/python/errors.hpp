// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

namespace suture::python {

/// Adds the exceptions of the module and translates the kernel's errors to them:
///
///   Error (RuntimeError)
///     InputError (ValueError)
///       SceneError              .mistakes: [(path, line, text), ...]
///     PluginError
///     NumericalError (ArithmeticError)
///     IoError (OSError)
void add_errors(pybind11::module_& module);

}  // namespace suture::python
