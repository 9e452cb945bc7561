// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>

namespace suture::test {

using Json = nlohmann::json;

/// The parts of http://127.0.0.1:PORT/TOKEN/.
struct Address {
  explicit Address(const std::string& text)
      : port(text.substr(17, text.find('/', 17) - 17)), path(text.substr(text.find('/', 17))) {}
  std::string host() const { return "127.0.0.1:" + port; }
  std::string port, path;
};

/// A client that is no browser.
class Client {
 public:
  explicit Client(const Address& address) : address_(address), socket_(context_) {
    boost::asio::ip::tcp::endpoint to(boost::asio::ip::address_v4::loopback(),
                                      static_cast<unsigned short>(std::stoul(address.port)));
    socket_.next_layer().connect(to);
  }

  struct Answer {
    unsigned status;
    std::string text;
  };
  /// `host`: "" for the right one.
  Answer get(const std::string& target, const std::string& host = "") {
    namespace http = boost::beast::http;
    http::request<http::empty_body> request(http::verb::get, target, 11);
    request.set(http::field::host, host.empty() ? address_.host() : host);
    http::write(socket_.next_layer(), request);
    http::response<http::string_body> response;
    boost::beast::flat_buffer buffer;
    http::read(socket_.next_layer(), buffer, response);
    return {response.result_int(), response.body()};
  }

  /// Opens the web socket; false if it is refused.
  bool open() { return open(address_.path + "socket"); }
  bool open(const std::string& target, const std::string& origin = "") {
    socket_.set_option(boost::beast::websocket::stream_base::decorator([&](auto& request) {
      if (!origin.empty()) request.set(boost::beast::http::field::origin, origin);
    }));
    boost::beast::error_code failed;
    socket_.handshake(address_.host(), target, failed);
    return !failed;
  }
  void send(const std::string& text) {
    socket_.binary(false);
    socket_.write(boost::asio::buffer(text));
  }
  void send_bytes(const std::string& bytes) {
    socket_.binary(true);
    socket_.write(boost::asio::buffer(bytes));
  }
  void say_drawn() { send_bytes(""); }
  /// The next message, of any kind.
  std::string read() {
    boost::beast::flat_buffer buffer;
    socket_.read(buffer);
    return boost::beast::buffers_to_string(buffer.data());
  }
  /// The head of the next message; those of pictures are acknowledged.
  Json next() {
    const std::string message = read();
    if (!socket_.got_binary()) return Json::parse(message);
    std::uint32_t length = 0;
    std::memcpy(&length, message.data(), 4);
    Json head = Json::parse(message.substr(4, length));
    arrays_ = message.substr(4 + std::size_t{length});
    if (head.at("kind") == "state") say_drawn();
    return head;
  }
  /// The arrays of the last picture that next() has returned.
  const std::string& arrays() const { return arrays_; }
  /// Reads until a message has this key.
  Json until(const std::string& key) {
    for (;;)
      if (Json message = next(); message.contains(key)) return message;
  }
  /// Bytes that are not a message of a web socket.
  void send_raw(const std::string& bytes) {
    boost::asio::write(socket_.next_layer(), boost::asio::buffer(bytes));
  }
  /// Without a word.
  void vanish() { socket_.next_layer().close(); }

 private:
  Address address_;
  std::string arrays_;
  boost::asio::io_context context_;
  boost::beast::websocket::stream<boost::asio::ip::tcp::socket> socket_;
};

}  // namespace suture::test
