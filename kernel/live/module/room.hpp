// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "kernel/live/live_server.hpp"

namespace suture::live {

class Connection;
using Text = std::shared_ptr<const std::string>;

/// What the connections of a server share. On the thread of the server, except for take_inputs(),
/// wait(), is_watched() and wants_picture().
class Room {
 public:
  Room(std::string own_token, std::filesystem::path three_js_folder, bool others_may_connect)
      : token(std::move(own_token)),
        three_js(std::move(three_js_folder)),
        is_open(others_may_connect) {}

  const std::string token;
  const std::filesystem::path three_js;
  const bool is_open;  ///< to other machines

  /// Whether another connection may join.
  bool has_place() const;
  void join(const std::shared_ptr<Connection>& connection);
  void leave(const Connection& connection);
  /// Drops all connections, before what they need ends.
  void clear() { connections_.clear(); }
  /// A text from a page: an input if it has the control.
  void hear(Connection& from, std::string text);
  /// Call when a page may take another picture, or no longer.
  void check_wants();

  void greet(std::string text) { greeting_ = std::make_shared<const std::string>(std::move(text)); }
  void say(std::string text);
  void show(LivePicture picture);
  const LivePicture& picture() const { return picture_; }
  /// 0 before the first one.
  std::uint64_t picture_number() const { return picture_number_; }

  bool is_watched() const { return is_watched_; }
  bool wants_picture() const { return wants_; }
  std::vector<std::string> take_inputs();
  void wait(std::chrono::milliseconds most);

 private:
  std::vector<std::shared_ptr<Connection>> connections_;  ///< the first one has the control
  Text greeting_;
  std::deque<Text> said_;
  LivePicture picture_;
  std::uint64_t picture_number_ = 0;
  std::atomic<bool> is_watched_ = false, wants_ = false;
  std::mutex mutex_;
  std::condition_variable has_inputs_;
  std::vector<std::string> inputs_;
};

}  // namespace suture::live
