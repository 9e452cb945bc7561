// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/live/module/connection.hpp"

#include <utility>

namespace suture::live {

namespace beast = boost::beast;
namespace websocket = beast::websocket;

namespace {

constexpr std::size_t max_input = 1 << 16, max_unread = 1000;

}  // namespace

Connection::Connection(beast::tcp_stream stream, Room& room)
    : socket_(std::move(stream)), room_(room) {}

void Connection::accept(const Request& request) {
  socket_.next_layer().expires_never();  // the web socket has its own timer, and pings
  auto timeout = websocket::stream_base::timeout::suggested(beast::role_type::server);
  timeout.keep_alive_pings = true;
  timeout.idle_timeout = std::chrono::seconds(60);
  socket_.set_option(timeout);
  socket_.read_message_max(max_input);
  socket_.auto_fragment(false);
  socket_.write_buffer_bytes(1 << 16);
  socket_.async_accept(request, [self = shared_from_this()](beast::error_code failed) {
    if (failed) return;
    self->is_open_ = true;
    self->room_.join(self);
    self->read();
  });
}

void Connection::read() {
  socket_.async_read(incoming_, [self = shared_from_this()](beast::error_code failed, std::size_t) {
    if (failed) return self->end();
    self->heard();
    if (self->is_open_) self->read();
  });
}

void Connection::heard() {
  if (socket_.got_binary()) {
    is_waiting_ = false;
    take_picture();
    room_.check_wants();
  } else {
    room_.hear(*this, beast::buffers_to_string(incoming_.data()));
  }
  incoming_.consume(incoming_.size());
}

void Connection::send(Text text) {
  if (!is_open_) return;
  if (texts_.size() >= max_unread) return end();
  texts_.push_back(std::move(text));
  write_next();
}

void Connection::take_picture() { write_next(); }

void Connection::write_next() {
  if (!is_open_ || writing_) return;
  if (state_) {
    writing_ = std::exchange(state_, nullptr);
    write(*writing_, true);
  } else if (!texts_.empty()) {
    writing_ = std::move(texts_.front());
    texts_.pop_front();
    write(*writing_, false);
  } else if (is_ready() && picture_number_ != room_.picture_number()) {
    const LivePicture& picture = room_.picture();
    picture_number_ = room_.picture_number();
    is_waiting_ = true;
    writing_ = picture.state;
    if (std::exchange(surface_number_, picture.surface_number) != picture.surface_number) {
      state_ = picture.state;
      writing_ = picture.surface;
    }
    write(*writing_, true);
  }
}

void Connection::write(const std::string& message, bool is_binary) {
  socket_.binary(is_binary);
  socket_.async_write(boost::asio::buffer(message),
                      [self = shared_from_this()](beast::error_code failed, std::size_t) {
                        self->writing_.reset();
                        if (failed) return self->end();
                        self->write_next();
                      });
}

/// Operations that are under way end with an error.
void Connection::end() {
  if (!std::exchange(is_open_, false)) return;
  beast::get_lowest_layer(socket_).cancel();
  beast::get_lowest_layer(socket_).close();
  room_.leave(*this);
}

}  // namespace suture::live
