// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/plugin_host/plugin_host.hpp"

namespace suture::test {

/// All plugins of the tree, and those of the tests of runs.
PluginHost& host();

}  // namespace suture::test
