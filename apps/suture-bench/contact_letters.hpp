// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "apps/suture-bench/report.hpp"
#include "kernel/plugin_host/plugin_host.hpp"

namespace suture::bench {

/// Adds lines for 20 letters of 1,000 elements that fall into a box: steps with contact beside
/// steps of the same letters without, while they fall onto each other and in the pile.
void measure_letters(PluginHost& host, Report& report);

}  // namespace suture::bench
