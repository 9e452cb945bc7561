// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "kernel/build/built_scene.hpp"

namespace suture {

/// Returns a warning if the body has hourglassed, otherwise "" (for a moving body, only where no
/// continuum resists hourglassing). It gives the number of elements whose alternating part exceeds
/// half their strain, the worst of them, and advice. A few elements, as around a force on a single
/// node, do not count: there must be at least 64, or, in a small body, a tenth of the elements and
/// at least 8.
std::string hourglass_warning(const Scene& scene, BuiltScene& built, bool at_rest);

}  // namespace suture
