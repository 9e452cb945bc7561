// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/frame_writer.hpp"

#include <condition_variable>
#include <cstdio>
#include <deque>
#include <exception>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include "kernel/base/file.hpp"
#include "kernel/output/frame_file.hpp"
#include "kernel/output/pvd.hpp"

namespace suture {
namespace {

namespace fs = std::filesystem;

// prefix_0042.vtu: the number has four digits or more.
bool is_frame_name(const std::string& name, const std::string& prefix) {
  const std::string head = prefix + "_", tail = ".vtu";
  if (name.size() < head.size() + 4 + tail.size()) return false;
  if (!name.starts_with(head) || !name.ends_with(tail)) return false;
  const std::string_view digits(&name[head.size()], name.size() - head.size() - tail.size());
  return digits.find_first_not_of("0123456789") == digits.npos;
}

}  // namespace

// Everything from `write` on happens on the writing thread only; the queue is all
// that both threads touch.
struct FrameWriter::Impl {
  explicit Impl(FrameWriterOptions chosen)
      : options(std::move(chosen)),
        pvd_path(options.directory / (options.collection + ".pvd")),
        pvd(pvd_path),
        old_files(PvdFile::files_of(pvd_path)) {}

  const FrameWriterOptions options;
  const fs::path pvd_path;

  std::mutex mutex;
  std::condition_variable changed;
  std::deque<Frame> queue;
  std::vector<Frame> used;
  std::exception_ptr error;
  std::size_t written = 0;
  bool busy = false, stopping = false, has_folder = false;
  std::thread thread;

  PvdFile pvd;
  std::vector<std::string> old_files;
  std::size_t missing = 0;

  std::string file_name(const Frame& frame) const {
    char number[24];
    std::snprintf(number, sizeof number, "_%04llu.vtu",
                  static_cast<unsigned long long>(frame.number));
    return options.prefix + number;
  }

  void write(Frame& frame) {
    const std::string name = file_name(frame);
    write_frame(options.directory / name, frame, options.compression);
    pvd.add(frame.time, name);
    remove_old(name);
  }

  void remove_old(const std::string& but = "") {
    for (const std::string& old : std::exchange(old_files, {})) {
      std::error_code ignored;
      if (old != but && is_frame_name(old, options.prefix))
        fs::remove(options.directory / old, ignored);
    }
  }

  // A run that was resumed and fails before its next frame.
  void leave_out_later() {
    if (pvd.files().empty() || old_files.empty()) return;
    pvd.write();
    remove_old();
  }

  // Not before the first frame: a scene that is only looked at leaves no trace.
  void make_folder() {
    if (std::exchange(has_folder, true)) return;
    std::error_code failed;
    fs::create_directories(options.directory, failed);
    if (failed) fail_io(options.directory, "made as output folder", failed.value());
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
  impl.make_folder();
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
  impl_->leave_out_later();
}

void FrameWriter::state(Archive& archive) {
  if (!archive.loads()) finish();
  const std::lock_guard lock(impl_->mutex);
  archive("written", impl_->written);
  archive("list", impl_->pvd);
  if (!archive.loads()) return;
  impl_->missing = impl_->pvd.leave_out_missing();
  impl_->old_files = PvdFile::files_of(impl_->pvd_path);
  const std::set<std::string> listed(impl_->pvd.files().begin(), impl_->pvd.files().end());
  std::erase_if(impl_->old_files, [&](const std::string& file) { return listed.contains(file); });
}

std::size_t FrameWriter::missing() const { return impl_->missing; }

std::size_t FrameWriter::written() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->written;
}

const fs::path& FrameWriter::collection() const { return impl_->pvd_path; }

}  // namespace suture
