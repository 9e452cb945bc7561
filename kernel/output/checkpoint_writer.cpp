// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/checkpoint_writer.hpp"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace suture {

namespace fs = std::filesystem;

// Everything from `write` on happens on the writing thread only; what waits is all that both
// threads touch.
struct CheckpointWriter::Impl {
  explicit Impl(CheckpointWriterOptions chosen)
      : options(std::move(chosen)), next(options.resumed_number + 1), newest(options.resumed_from) {
    if (newest.empty() || !same_folder(newest.parent_path(), folder().path())) return;
    for (const std::uint64_t number : checkpoints_in(folder().path())) {
      if (number > options.resumed_number) continue;
      own.push_back(number);
      folder().keep(checkpoint_name(number));
    }
  }

  const CheckpointWriterOptions options;
  std::uint64_t next;

  mutable std::mutex mutex;
  std::condition_variable changed;
  std::optional<Checkpoint> waiting;
  std::exception_ptr error;
  fs::path newest;
  bool busy = false, stopping = false;
  std::thread thread;

  std::deque<std::uint64_t> own;  ///< numbers of files that are whole, ascending

  OutputFolder& folder() const { return *options.folder; }
  fs::path path_of(std::uint64_t number) const { return folder().path() / checkpoint_name(number); }

  void write(Checkpoint checkpoint) {
    const std::uint64_t number = checkpoint.header.number;
    folder().write(checkpoint_name(number), [&](OutputFile& file) {
      write_checkpoint(file, std::move(checkpoint.header), std::move(checkpoint.state));
    });
    folder().sync();
    own.push_back(number);
    for (; own.size() > std::max(options.keep, 1u); own.pop_front())
      folder().remove(checkpoint_name(own.front()));
  }

  // The loop of the writing thread.
  void work() {
    std::unique_lock lock(mutex);
    while (true) {
      changed.wait(lock, [&] { return stopping || waiting; });
      if (!waiting) return;
      Checkpoint checkpoint = std::move(*waiting);
      waiting.reset();
      busy = true;
      changed.notify_all();
      const fs::path path = path_of(checkpoint.header.number);
      lock.unlock();
      std::exception_ptr failed;
      try {
        write(std::move(checkpoint));
      } catch (...) {
        failed = std::current_exception();
      }
      lock.lock();
      busy = false;
      if (failed) {
        error = failed;
        waiting.reset();
      } else {
        newest = path;
      }
      changed.notify_all();
    }
  }

  void rethrow() {
    if (error) std::rethrow_exception(std::exchange(error, nullptr));
  }
};

CheckpointWriter::CheckpointWriter(CheckpointWriterOptions options)
    : impl_(std::make_unique<Impl>(std::move(options))) {}

CheckpointWriter::~CheckpointWriter() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->stopping = true;
  }
  impl_->changed.notify_all();
  if (impl_->thread.joinable()) impl_->thread.join();
}

void CheckpointWriter::submit(CheckpointHeader header, StateTree&& state) {
  Impl& impl = *impl_;
  std::unique_lock lock(impl.mutex);
  impl.rethrow();
  if (!impl.thread.joinable()) impl.thread = std::thread([&impl] { impl.work(); });
  impl.changed.wait(lock, [&] { return impl.error || !impl.waiting; });
  impl.rethrow();
  header.number = impl.next++;
  impl.waiting.emplace(Checkpoint{std::move(header), std::move(state)});
  impl.changed.notify_all();
}

void CheckpointWriter::finish() {
  std::unique_lock lock(impl_->mutex);
  impl_->changed.wait(lock, [&] { return impl_->error || (!impl_->waiting && !impl_->busy); });
  impl_->rethrow();
}

fs::path CheckpointWriter::newest() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->newest;
}

}  // namespace suture
