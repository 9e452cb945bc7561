// SPDX-License-Identifier: GPL-3.0-or-later
//
// The live view of a session.
#include "apps/python/session.hpp"
#include "kernel/base/error.hpp"

namespace suture::python {
namespace {

using Clock = std::chrono::steady_clock;

/// The page has the control until a time, or until an exception of Python stops it.
class Until final : public Observer {
 public:
  Until(Observing& python, double seconds)
      : python_(python),
        is_limited_(std::isfinite(seconds)),
        end_(Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                std::chrono::duration<double>(is_limited_ ? seconds : 0))) {}
  void on_message(const std::string& text) override { python_.on_message(text); }
  bool stop_requested() override {
    return (is_limited_ && Clock::now() >= end_) || python_.stop_requested();
  }

 private:
  Observing& python_;
  bool is_limited_;
  Clock::time_point end_;
};

}  // namespace

std::string Session::open_live(unsigned port, const std::string& host,
                               std::optional<std::filesystem::path> recording) {
  Simulation& now = between_steps();
  require_own_process();
  require_alive();
  if (live_) throw InputError("this simulation has a live view already: close() it first");
  if (is_given_mesh_) forgo_recording("the mesh is not in the scene");
  auto server = open_live_server(static_cast<std::uint16_t>(port), host);
  const bool records = recording && not_recorded_.empty();
  live_ = std::make_unique<LiveRun>(now, scene_, host_, diagnostics_, *server, recording,
                                    records ? done_ : std::vector<RecordedInput>());
  live_server_ = std::move(server);
  if (recording && !records) live_->stop_recording(not_recorded_);
  observer_.live = live_.get();
  return live_server_->address();
}

void Session::run_live(double seconds) {
  require_alive();
  run_.views->hand_over();  // pages may change what views refer to
  observer_.live = nullptr;
  try {
    advance([&] {
      Until observer(observer_, seconds);
      live_->run(observer);
    });
  } catch (...) {
    observer_.live = live_.get();
    throw;
  }
  observer_.live = live_.get();
  if (live_->has_failed()) failure_ = "in the live view";
}

std::optional<std::filesystem::path> Session::live_recording() const {
  if (!live_ || !live_->recording().has_inputs()) return {};
  return live_->recording().path();
}

void Session::close_live() {
  if (!live_) return;
  if (!failure_) live_->end();
  observer_.live = nullptr;
  live_.reset();
  live_server_.reset();
}

void Session::record(std::uint64_t step, std::string value) {
  done_.push_back({step, simulation().time(), "script", std::move(value)});
  if (!live_) return;
  live_->record(done_.back());
  live_->show_last();
}

void Session::forgo_recording(const std::string& why) {
  if (not_recorded_.empty()) not_recorded_ = why;
  if (live_) live_->stop_recording(why);
}

}  // namespace suture::python
