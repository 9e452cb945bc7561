// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "suture/plugin.h"

namespace suture {

/// Everything wrong with tables that copy_tables() could read, one sentence each, naming
/// the model and the entry ("model 'm', parameter 'E': ..."); empty if the rest of the
/// host may rely on them: no NULL where text or a function is needed, ids unique, known
/// values only, columns in range and of the right dimension, required extensions present.
std::vector<std::string> table_problems(const suture_plugin& plugin);

}  // namespace suture
