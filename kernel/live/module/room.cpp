// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/live/module/room.hpp"

#include <algorithm>
#include <utility>

#include "kernel/live/module/connection.hpp"

namespace suture::live {
namespace {

constexpr std::size_t kept_texts = 100, max_inputs = 10000, max_connections = 64;

Text text_of(const char* text) { return std::make_shared<const std::string>(text); }

}  // namespace

bool Room::has_place() const { return connections_.size() < max_connections; }

void Room::join(const std::shared_ptr<Connection>& connection) {
  connections_.push_back(connection);
  check_wants();  // first: who reads the greeting relies on being seen
  if (greeting_) connection->send(greeting_);
  connection->send(
      text_of(connections_.size() == 1 ? R"({"control":true})" : R"({"control":false})"));
  for (const Text& text : said_) connection->send(text);
  connection->take_picture();
  check_wants();
}

void Room::leave(const Connection& connection) {
  const bool had_control = !connections_.empty() && connections_.front().get() == &connection;
  std::erase_if(connections_, [&](const auto& each) { return each.get() == &connection; });
  if (had_control && !connections_.empty())
    connections_.front()->send(text_of(R"({"control":true})"));
  check_wants();
}

void Room::hear(Connection& from, std::string text) {
  if (connections_.front().get() != &from)
    return from.send(text_of(R"({"error":"another page controls this run; this one watches"})"));
  const std::scoped_lock lock(mutex_);
  if (inputs_.size() >= max_inputs)
    return from.send(text_of(R"({"error":"the run is behind; this input was dropped"})"));
  inputs_.push_back(std::move(text));
  has_inputs_.notify_one();
}

void Room::check_wants() {
  is_watched_ = !connections_.empty();
  wants_ = std::ranges::any_of(connections_, [](const auto& each) { return each->is_ready(); });
}

void Room::say(std::string text) {
  said_.push_back(std::make_shared<const std::string>(std::move(text)));
  if (said_.size() > kept_texts) said_.pop_front();
  const Text said = said_.back();
  // Sending may end a connection, which then leaves.
  for (const auto& connection : std::vector(connections_)) connection->send(said);
}

void Room::show(LivePicture picture) {
  picture_ = std::move(picture);
  ++picture_number_;
  for (const auto& connection : std::vector(connections_)) connection->take_picture();
  check_wants();
}

std::vector<std::string> Room::take_inputs() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(inputs_, {});
}

void Room::wait(std::chrono::milliseconds most) {
  std::unique_lock lock(mutex_);
  has_inputs_.wait_for(lock, most, [&] { return !inputs_.empty(); });
}

}  // namespace suture::live
