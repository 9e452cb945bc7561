// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <memory>

#include "kernel/live/module/room.hpp"

namespace suture::live {

using Request = boost::beast::http::request<boost::beast::http::string_body>;

/// The web socket of one page, which sends texts and, for each picture that it begins to draw, an
/// empty binary message.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(boost::beast::tcp_stream stream, Room& room);

  void accept(const Request& request);
  /// Sends a text as soon as the page takes it. A page that leaves a thousand unread is cut off.
  void send(Text text);
  /// Sends the picture of the room if the page has begun to draw the last one.
  void take_picture();
  /// Whether it would take a new picture.
  bool is_ready() const { return !is_waiting_; }

 private:
  void read();
  void heard();
  void write_next();
  void write(const std::string& message, bool is_binary);
  void end();

  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  Room& room_;
  boost::beast::flat_buffer incoming_;
  std::deque<Text> texts_;
  Text writing_, state_;  ///< the message under way; the one to follow a surface
  std::uint64_t picture_number_ = 0, surface_number_ = 0;  ///< the last ones sent
  bool is_open_ = false, is_waiting_ = false;              ///< for the page to draw
};

}  // namespace suture::live
