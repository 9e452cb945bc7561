// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/frame_writer.hpp"

#include <condition_variable>
#include <cstdio>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "kernel/base/error.hpp"
#include "kernel/output/collection.hpp"
#include "kernel/output/frame_file.hpp"

namespace suture {

namespace fs = std::filesystem;

// Everything from `write` on happens on the writing thread only; the queue is all
// that both threads touch.
struct FrameWriter::Impl {
  explicit Impl(FrameWriterOptions chosen)
      : options(std::move(chosen)),
        pvd_name(options.collection + ".pvd"),
        pvd_path(folder().path() / pvd_name) {}

  const FrameWriterOptions options;
  const std::string pvd_name;
  const fs::path pvd_path;

  std::mutex mutex;
  std::condition_variable changed;
  std::deque<Frame> queue;
  std::vector<Frame> used;
  std::exception_ptr error;
  std::size_t written = 0;
  bool busy = false, stopping = false, is_resumed = false;
  std::thread thread;

  Collection pvd;
  std::size_t missing = 0;

  OutputFolder& folder() const { return *options.folder; }

  std::string file_name(const Frame& frame) const {
    char number[24];
    std::snprintf(number, sizeof number, "_%04llu.vtu",
                  static_cast<unsigned long long>(frame.number));
    return options.prefix + number;
  }

  void write(Frame& frame) {
    const std::string name = file_name(frame);
    folder().write(name, [&](OutputFile& file) { write_frame(file, frame, options.compression); });
    pvd.add(frame.time, name);
    folder().write(pvd_name, [&](OutputFile& file) { file.write(pvd.text()); });
  }

  void require_all() {
    if (pvd.files().empty()) return;
    folder().require_in_place();
    if (const std::size_t gone = pvd.leave_out_missing(folder().path()); gone != 0)
      throw IoError(pvd_path.string() + ": " + std::to_string(gone) +
                    " of its frames were removed while the run wrote them; start the run again "
                    "and leave its files where they are");
  }

  // The files from which this run continues belong to it.
  void keep() {
    missing = pvd.leave_out_missing(folder().path());
    for (const std::string& file : pvd.files()) folder().keep(file);
    if (!pvd.files().empty()) folder().keep(pvd_name, pvd.text());
    is_resumed = true;
  }

  // The loop of the writing thread.
  void work() {
    std::unique_lock lock(mutex);
    while (true) {
      changed.wait(lock, [&] { return stopping || !queue.empty(); });
      if (queue.empty()) return;
      Frame frame = std::move(queue.front());
      queue.pop_front();
      busy = true;
      lock.unlock();
      std::exception_ptr failed;
      try {
        write(frame);
      } catch (...) {
        failed = std::current_exception();
      }
      lock.lock();
      busy = false;
      done(std::move(frame), failed);
      changed.notify_all();
    }
  }

  void done(Frame frame, const std::exception_ptr& failed) {
    if (failed) {
      error = failed;
      queue.clear();
      return;
    }
    ++written;
    if (used.size() < options.waiting) used.push_back(std::move(frame));
  }

  void rethrow() {
    if (error) std::rethrow_exception(std::exchange(error, nullptr));
  }
};

FrameWriter::FrameWriter(FrameWriterOptions options)
    : impl_(std::make_unique<Impl>(std::move(options))) {}

FrameWriter::~FrameWriter() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->stopping = true;
  }
  impl_->changed.notify_all();
  if (impl_->thread.joinable()) impl_->thread.join();
}

Frame FrameWriter::take_frame() {
  const std::lock_guard lock(impl_->mutex);
  if (impl_->used.empty()) return {};
  Frame frame = std::move(impl_->used.back());
  impl_->used.pop_back();
  return frame;
}

void FrameWriter::submit(Frame frame) {
  check_frame(frame);
  Impl& impl = *impl_;
  impl.folder().open();
  std::unique_lock lock(impl.mutex);
  impl.rethrow();
  if (!impl.options.background) {
    impl.write(frame);
    impl.done(std::move(frame), nullptr);
    return;
  }
  if (!impl.thread.joinable()) impl.thread = std::thread([&impl] { impl.work(); });
  impl.changed.wait(lock, [&] { return impl.error || impl.queue.size() < impl.options.waiting; });
  impl.rethrow();
  impl.queue.push_back(std::move(frame));
  impl.changed.notify_all();
}

void FrameWriter::finish() {
  std::unique_lock lock(impl_->mutex);
  impl_->changed.wait(lock, [&] { return impl_->error || (impl_->queue.empty() && !impl_->busy); });
  impl_->rethrow();
  if (impl_->is_resumed) impl_->folder().begin();
  impl_->require_all();
}

void FrameWriter::state(Archive& archive) {
  if (!archive.loads()) finish();
  const std::lock_guard lock(impl_->mutex);
  archive("written", impl_->written);
  archive("list", impl_->pvd);
  if (archive.loads()) impl_->keep();
}

std::size_t FrameWriter::missing() const { return impl_->missing; }

std::size_t FrameWriter::written() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->written;
}

const fs::path& FrameWriter::collection() const { return impl_->pvd_path; }

}  // namespace suture
