// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

// Boost.Beast behind a small interface. Its headers take half a minute to compile: they stay in
// libsuture-live.so, which is loaded by `suture live` only.

namespace suture {

/// A state of a run as two binary messages (docs/live.md): the faces, and what changes in each
/// step. A page that has the faces with this number gets the second one only.
struct LivePicture {
  std::uint64_t surface_number = 0;
  std::shared_ptr<const std::string> surface, state;
};

struct LiveServerOptions {
  std::string host = "127.0.0.1";  ///< an address of this machine; "0.0.0.0": all
  std::uint16_t port = 0;          ///< 0: any that is free
  std::filesystem::path three_js;  ///< the folder of three.js
};

/// Serves pages, on a thread of its own; none of its functions waits for a page. The address
/// contains a random token; requests without it, and pages of other origins, are refused. The first
/// page controls the run, the others watch it; when the first one leaves, the oldest of the others
/// takes over. All functions are called on one thread.
class LiveServer {
 public:
  virtual ~LiveServer() = default;
  virtual const std::string& address() const = 0;
  /// Sends a JSON text to every page that comes from now on, before anything else.
  virtual void greet(std::string text) = 0;
  /// Sends a JSON text to all pages. Those that come later get the last hundred texts.
  virtual void say(std::string text) = 0;
  /// A page takes a new picture when it begins to draw the last one; what it misses is not kept.
  virtual void show(LivePicture picture) = 0;
  /// True if there is a page.
  virtual bool is_watched() const = 0;
  /// True if a page would take a picture now.
  virtual bool wants_picture() const = 0;
  /// The texts that the controlling page has sent since the last call, in order; at most 64 kB
  /// each.
  virtual std::vector<std::string> take_inputs() = 0;
  /// Returns when there is an input, or after `most`.
  virtual void wait(std::chrono::milliseconds most) = 0;
};

/// Loads the module. `host`: an address of this machine at which others may connect; "": only this
/// machine may. Throws IoError if that is not possible, if three.js is missing, or if it
/// cannot listen there.
std::unique_ptr<LiveServer> open_live_server(std::uint16_t port, const std::string& host = "");

/// What the module exports: null, and the reason in `problem`, if it cannot listen.
using OpenLiveServer = LiveServer* (*)(const LiveServerOptions& options, std::string& problem);

}  // namespace suture
