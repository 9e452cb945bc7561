// SPDX-License-Identifier: GPL-3.0-or-later
//
// The module itself: listens, answers requests for the files of the page, and hands requests for a
// web socket to Connection.
#include <array>
#include <boost/asio/ip/host_name.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <deque>
#include <optional>
#include <random>
#include <thread>

#include "kernel/live/module/connection.hpp"
#include "kernel/live/module/pages.hpp"

namespace suture::live {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using Tcp = asio::ip::tcp;

/// Connections that have not opened a web socket. Browsers open about six.
constexpr std::size_t max_visitors = 64;
/// A connection says something in so long after it was made, and between its requests.
constexpr auto first_word = std::chrono::seconds(5), next_word = std::chrono::seconds(30);
/// Where no connection can be accepted, as no descriptor is left, the next attempt is made later.
constexpr auto rest_after_failure = std::chrono::milliseconds(200);

/// 128 bits of the system's generator, in hexadecimal digits.
std::string random_token() {
  std::random_device random;
  std::string token;
  for (int i = 0; i < 32; ++i) token += "0123456789abcdef"[random() % 16];
  return token;
}

/// In a time that does not depend on the first difference.
bool is_same(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned different = 0;
  for (std::size_t i = 0; i < a.size(); ++i) different |= unsigned(a[i]) ^ unsigned(b[i]);
  return different == 0;
}

std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }

/// A page of another site, or one that has a name of its own resolve to this machine, has no
/// business here. Programs other than browsers send no origin. Where others may connect, they use
/// any of the names of this machine.
bool is_own_page(const Request& request, const Room& room) {
  const std::string_view host = view_of(request[http::field::host]);
  const std::string_view name = host.substr(0, host.rfind(':'));
  if (!room.is_open && name != "localhost" && name != "127.0.0.1" && name != "[::1]") return false;
  const std::string_view origin = view_of(request[http::field::origin]);
  return origin.empty() || origin == "http://" + std::string(host);
}

/// What follows "/TOKEN/"; none without the token.
std::optional<std::string_view> name_in(std::string_view target, const std::string& token) {
  target = target.substr(0, target.find('?'));
  if (target.size() < token.size() + 2 || target[0] != '/' || target[token.size() + 1] != '/' ||
      !is_same(target.substr(1, token.size()), token))
    return {};
  return target.substr(token.size() + 2);
}

/// The name of an address in that of a page; the machine's own for all of its addresses.
std::string name_of(const asio::ip::address& host) {
  if (host.is_unspecified()) return asio::ip::host_name();
  return host.is_v6() ? "[" + host.to_string() + "]" : host.to_string();
}

using Response = http::response<http::string_body>;

Response response_to(const Request& request, http::status status, PageFile file) {
  Response response(status, request.version());
  response.set(http::field::content_type, file.type);
  response.set(http::field::cache_control, "no-store");
  response.set("Referrer-Policy", "no-referrer");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Content-Security-Policy", "default-src 'self'; img-src 'self' data: blob:");
  response.keep_alive(request.keep_alive());
  response.body() = std::move(file.text);
  response.prepare_payload();
  return response;
}

Response refusal(const Request& request, http::status status, const char* text) {
  return response_to(request, status, {"text/plain; charset=utf-8", text});
}

Response answer(const Request& request, const Room& room) {
  const auto name = name_in(view_of(request.target()), room.token);
  if (!name || !is_own_page(request, room))
    return refusal(request, http::status::forbidden,
                   "Use the address that suture live has printed, with its token.\n");
  if (request.method() != http::verb::get)
    return refusal(request, http::status::method_not_allowed, "GET only.\n");
  auto file = page_file(*name, room.three_js);
  if (!file) return refusal(request, http::status::not_found, "No such file.\n");
  return response_to(request, http::status::ok, std::move(*file));
}

/// Reads requests until one asks for a web socket.
class Visitor : public std::enable_shared_from_this<Visitor> {
 public:
  Visitor(Tcp::socket socket, Room& room) : stream_(std::move(socket)), room_(room) {}

  void read(std::chrono::seconds most = first_word) {
    parser_.emplace();
    parser_->header_limit(1 << 13);
    parser_->body_limit(1 << 10);
    stream_.expires_after(most);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](beast::error_code failed, std::size_t) {
                       if (!failed) self->receive(self->parser_->release());
                     });
  }
  /// Operations that are under way end with an error.
  void leave() { stream_.close(); }

 private:
  void receive(Request request) {
    const auto name = name_in(view_of(request.target()), room_.token);
    if (beast::websocket::is_upgrade(request) && name && *name == "socket" &&
        is_own_page(request, room_) && room_.has_place()) {
      std::make_shared<Connection>(std::move(stream_), room_)->accept(request);
      return;
    }
    response_ = answer(request, room_);
    http::async_write(stream_, response_,
                      [self = shared_from_this()](beast::error_code failed, std::size_t) {
                        if (!failed && self->response_.keep_alive()) self->read(next_word);
                      });
  }

  beast::tcp_stream stream_;
  Room& room_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
  Response response_;
};

class Server final : public LiveServer {
 public:
  explicit Server(const LiveServerOptions& options)
      : host_(asio::ip::make_address(options.host)),
        room_(random_token(), options.three_js, !host_.is_loopback()),
        listener_(context_, {host_, options.port}),
        address_("http://" + name_of(host_) + ":" +
                 std::to_string(listener_.local_endpoint().port()) + "/" + room_.token + "/") {
    accept();
    thread_ = std::thread([this] { context_.run(); });
  }
  ~Server() override {
    context_.stop();
    thread_.join();
    room_.clear();
  }

  const std::string& address() const override { return address_; }
  void greet(std::string text) override {
    post([this, text = std::move(text)]() mutable { room_.greet(std::move(text)); });
  }
  void say(std::string text) override {
    post([this, text = std::move(text)]() mutable { room_.say(std::move(text)); });
  }
  void show(LivePicture picture) override {
    post([this, picture = std::move(picture)]() mutable { room_.show(std::move(picture)); });
  }
  bool is_watched() const override { return room_.is_watched(); }
  bool wants_picture() const override { return room_.wants_picture(); }
  std::vector<std::string> take_inputs() override { return room_.take_inputs(); }
  void wait(std::chrono::milliseconds most) override { room_.wait(most); }

 private:
  template <class F>
  void post(F&& f) {
    asio::post(context_, std::forward<F>(f));
  }
  void accept() {
    listener_.async_accept([this](beast::error_code failed, Tcp::socket socket) {
      if (failed) return accept_later();
      socket.set_option(Tcp::no_delay(true), failed);
      admit(std::make_shared<Visitor>(std::move(socket), room_));
      accept();
    });
  }
  /// The listener stays readable as long as somebody waits: another attempt at once would fail,
  /// too.
  void accept_later() {
    pause_.expires_after(rest_after_failure);
    pause_.async_wait([this](beast::error_code stopped) {
      if (!stopped) accept();
    });
  }
  /// Where there are too many, the one that came first leaves.
  void admit(const std::shared_ptr<Visitor>& visitor) {
    std::erase_if(visitors_, [](const auto& each) { return each.expired(); });
    if (visitors_.size() >= max_visitors) {
      if (const auto first = visitors_.front().lock()) first->leave();
      visitors_.pop_front();
    }
    visitors_.push_back(visitor);
    visitor->read();
  }

  asio::ip::address host_;
  Room room_;  // outlives the handlers that wait in the context
  asio::io_context context_{1};
  Tcp::acceptor listener_;
  asio::steady_timer pause_{context_};
  std::deque<std::weak_ptr<Visitor>> visitors_;  ///< in the order in which they came
  std::string address_;
  std::thread thread_;
};

}  // namespace
}  // namespace suture::live

extern "C" __attribute__((visibility("default"))) suture::LiveServer* suture_open_live_server_2(
    const suture::LiveServerOptions& options, std::string& problem) {
  try {
    return new suture::live::Server(options);
  } catch (const boost::system::system_error& error) {
    problem = error.code().message();
    return nullptr;
  }
}
