// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "suture/plugin.h"

namespace suture {

/// Everything wrong with a plugin's tables, one sentence each, naming the model
/// and the entry ("model 'm', parameter 'E': ..."); empty if the rest of the host
/// may rely on them: no NULL where text, a function or an array is needed, sizes
/// as compiled into this host, ids unique, known values only, columns in range
/// and of the right dimension, required extensions present.
/// Strings and arrays must be readable: garbage pointers cannot be told apart.
std::vector<std::string> table_problems(const suture_plugin& plugin);

}  // namespace suture
