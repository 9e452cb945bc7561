// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/scene/scene.hpp"

namespace suture {

/// Times that an automatic dt must hit, besides the corners of the paths of obstacles, s.
std::vector<double> stops_of(const Scene& scene);

}  // namespace suture
