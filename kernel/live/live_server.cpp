// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/live/live_server.hpp"

#include "kernel/base/error.hpp"
#include "kernel/base/module.hpp"

namespace suture {
namespace {

/// Where Debian's libjs-three is, or node-three.
std::filesystem::path three_js_folder() {
  for (const char* folder : {"/usr/share/javascript/three", "/usr/share/nodejs/three"}) {
    std::error_code failed;
    if (std::filesystem::exists(std::filesystem::path(folder) / "build/three.module.js", failed))
      return folder;
  }
  throw IoError(
      "the page needs three.js, which is neither in /usr/share/javascript/three nor in "
      "/usr/share/nodejs/three; install it: apt-get install libjs-three");
}

}  // namespace

std::unique_ptr<LiveServer> open_live_server(std::uint16_t port) {
  const auto open = reinterpret_cast<OpenLiveServer>(
      module_symbol("libsuture-live.so", "suture_open_live_server_1"));
  std::string problem;
  auto server = open({port, three_js_folder()}, problem);
  if (!server)
    throw IoError("cannot listen on port " + std::to_string(port) + ": " + problem +
                  "; choose another one (--port), or none to get one that is free");
  return server;
}

}  // namespace suture
