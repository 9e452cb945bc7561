// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include "kernel/build/select.hpp"
#include "kernel/dynamics/body.hpp"
#include "kernel/scene/scene.hpp"

namespace suture {

/// Adds the conditions of a scene to the fields of its body. `name`: a vertex in messages. Throws
/// InputError for conditions that contradict each other.
void add_fields(const Scene& scene, const Selector& selector, Body& body,
                const std::function<std::string(Index)>& name);

}  // namespace suture
