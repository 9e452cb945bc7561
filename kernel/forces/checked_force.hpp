// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "suture/plugin.h"

namespace suture {

/// Calls the force of the current call's functor (plugin_call.hpp) three times, each on a copy of
/// the batch between guard values, and throws PluginError if the plugin
///   writes outside its arrays, or into an input,
///   leaves a value of force or of a trial column unset, or sets it to a value that is not finite,
///   gives another result if the outputs held other values before (it adds to them),
///   gives another result if the cells of the batch are in another order.
/// Outputs and status are those of the first call. For `suture run --check-plugins`: slow.
suture_status checked_force(const suture_context* context, const suture_batch* batch);

}  // namespace suture
