// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "suture/plugin.h"

namespace suture {

class Entry;

/// Everything that is wrong with tables that copy_tables() could read, in one sentence each
/// that names the model and the entry ("model 'm', parameter 'E': ..."); empty if the rest of the
/// host may rely on them: no text or required function is NULL, ids are unique, values are
/// known, columns are in range and of the right dimension, required extensions are present.
std::vector<std::string> table_problems(const suture_plugin& plugin);

/// Whether the declaration of a field limits what values a scene may give.
inline bool has_range(const suture_attribute& a) { return a.minimum != 0 || a.maximum != 0; }

/// The same of one functor of a model; one for elements of which only a part is material may read
/// SUTURE_PART_COLUMN, or SUTURE_GENERAL_PART_COLUMN if it is for general hexahedra.
void check_functor(const Entry& entry, const suture_model& model, const suture_functor& functor,
                   bool on_parts = false);

}  // namespace suture
