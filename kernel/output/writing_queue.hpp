// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace suture {

/// Jobs that one thread carries out in their order while the simulation continues. The thread
/// starts with the first job and ends with the queue, when all that waits is done.
///
/// An error of a job is thrown, once, by the next submit() or finish(); jobs that wait then are
/// dropped.
template <class Job>
class WritingQueue {
 public:
  /// `work` is called on the thread, `done` for a job that succeeded while no other call of this
  /// object runs. `waiting`: jobs that may wait before submit() blocks; 0: submit() does the job.
  WritingQueue(std::size_t waiting, std::function<void(Job&)> work, std::function<void(Job)> done)
      : waiting_(waiting), work_(std::move(work)), done_(std::move(done)) {}

  ~WritingQueue() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
  }
  WritingQueue(const WritingQueue&) = delete;
  WritingQueue& operator=(const WritingQueue&) = delete;

  void submit(Job job) {
    std::unique_lock lock(mutex_);
    rethrow();
    if (waiting_ == 0) {
      work_(job);
      done_(std::move(job));
      return;
    }
    if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
    changed_.wait(lock, [&] { return error_ || jobs_.size() < waiting_; });
    rethrow();
    jobs_.push_back(std::move(job));
    changed_.notify_all();
  }

  /// Waits until nothing is left to do.
  void finish() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return error_ || (jobs_.empty() && !busy_); });
    rethrow();
  }

  /// While it is held, no job is done.
  std::unique_lock<std::mutex> lock() const { return std::unique_lock(mutex_); }

 private:
  void run() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [&] { return stopping_ || !jobs_.empty(); });
      if (jobs_.empty()) return;
      Job job = std::move(jobs_.front());
      jobs_.pop_front();
      busy_ = true;
      changed_.notify_all();
      lock.unlock();
      std::exception_ptr failed;
      try {
        work_(job);
      } catch (...) {
        failed = std::current_exception();
      }
      lock.lock();
      busy_ = false;
      if (failed) {
        error_ = failed;
        jobs_.clear();
      } else {
        done_(std::move(job));
      }
      changed_.notify_all();
    }
  }

  void rethrow() {
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  }

  const std::size_t waiting_;
  const std::function<void(Job&)> work_;
  const std::function<void(Job)> done_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  std::exception_ptr error_;
  bool busy_ = false, stopping_ = false;
  std::thread thread_;
};

}  // namespace suture
