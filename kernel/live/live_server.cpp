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

std::unique_ptr<LiveServer> open_live_server(std::uint16_t port, const std::string& host) {
  const auto open = reinterpret_cast<OpenLiveServer>(
      module_symbol("libsuture-live.so", "suture_open_live_server_2"));
  std::string problem;
  LiveServerOptions options{.port = port, .three_js = three_js_folder()};
  if (!host.empty()) options.host = host;
  std::unique_ptr<LiveServer> server(open(options, problem));
  if (!server)
    throw IoError(
        "cannot listen on " + (port == 0 ? "any port" : "port " + std::to_string(port)) +
        (host.empty() ? "" : " of '" + host + "'") + ": " + problem +
        "; choose another one (--port), or none to get one that is free" +
        (host.empty() ? "" : ", and an address of this machine (--host), such as 0.0.0.0"));
  return server;
}

}  // namespace suture
