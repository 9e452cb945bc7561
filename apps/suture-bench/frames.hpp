// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "apps/suture-bench/body.hpp"
#include "kernel/plugin_host/plugin_host.hpp"
#include "kernel/results/recorder.hpp"

namespace suture::bench {

/// A block of tm-faure at rest whose frames go to a folder that is removed again.
class Frames {
 public:
  Frames(PluginHost& host, const std::array<Index, 3>& cells, std::vector<std::string> fields,
         bool skip) {
    folder_ = std::filesystem::temp_directory_path() / ("suture-bench-" + std::to_string(getpid()));
    scene_.mesh.box =
        BoxOptions{.size = {0.025 * cells[0], 0.025 * cells[1], 0.025 * cells[2]}, .cells = cells};
    ModelUse use;
    use.name = "tissue";
    use.model = &host.model("tm-faure");
    use.parameters = parameters_of(*use.model, {});
    scene_.models.push_back(use);
    scene_.output.directory = folder_;
    scene_.output.fields = std::move(fields);
    built_ = std::make_unique<BuiltScene>(scene_, diagnostics_, skip);
    built_->dynamics().start();
    events_ = std::make_unique<EventRunner>(scene_, *built_, diagnostics_);
    recorder_ =
        std::make_unique<Recorder>(scene_, *built_, *events_, Provenance{"suture-bench", {}},
                                   std::make_shared<OutputFolder>(folder_));
  }
  ~Frames() {
    recorder_->finish();
    std::filesystem::remove_all(folder_);
  }
  Frames(const Frames&) = delete;
  Frames& operator=(const Frames&) = delete;

  void write() {
    recorder_->frame(static_cast<std::uint64_t>(count_), 0.1 * count_, {});
    recorder_->release(static_cast<std::uint64_t>(count_++));
  }
  /// Until the frames so far are likely on disk.
  void wait() const { std::this_thread::sleep_for(std::chrono::milliseconds(150)); }

 private:
  std::filesystem::path folder_;
  Scene scene_;
  Diagnostics diagnostics_;
  std::unique_ptr<BuiltScene> built_;
  std::unique_ptr<EventRunner> events_;
  std::unique_ptr<Recorder> recorder_;
  int count_ = 0;
};

}  // namespace suture::bench
