// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/run/host.hpp"

#include <string>

namespace suture::test {
namespace {

void add_plugins_of_tests(PluginHost& plugins) {
  for (const std::string name : {"fibres-of-test", "maxwell", "moody", "skin"})
    plugins.add_file(TEST_PLUGINS "/" + name + ".so");
  plugins.add_file(SDK_PLUGINS "/neo-hooke.so");
}

}  // namespace

PluginHost& host() {
  static PluginHost plugins;
  static const bool added = (add_plugins_of_tests(plugins), true);
  (void)added;
  return plugins;
}

}  // namespace suture::test
