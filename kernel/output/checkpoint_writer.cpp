// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/checkpoint_writer.hpp"

#include <algorithm>
#include <deque>
#include <utility>

#include "kernel/output/writing_queue.hpp"

namespace suture {

namespace fs = std::filesystem;

// `write` is called on the writing thread only; the queue and what its lock guards are all that
// both threads touch.
struct CheckpointWriter::Impl {
  struct Numbered {
    std::uint64_t number;
    Checkpoint checkpoint;
  };

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

  fs::path newest;
  std::deque<std::uint64_t> own;  ///< numbers of files that are whole, ascending

  OutputFolder& folder() const { return *options.folder; }
  fs::path path_of(std::uint64_t number) const { return folder().path() / checkpoint_name(number); }

  void write(Numbered& job) {
    const std::uint64_t number = job.number;
    folder().write(checkpoint_name(number), [&](OutputFile& file) {
      write_checkpoint(file, std::move(job.checkpoint.header), std::move(job.checkpoint.state));
    });
    folder().sync();
    own.push_back(number);
    for (; own.size() > std::max(options.keep, 1u); own.pop_front())
      folder().remove(checkpoint_name(own.front()));
  }

  // The last member: its thread ends before the others do.
  WritingQueue<Numbered> queue{1, [this](Numbered& job) { write(job); },
                               [this](const Numbered& job) { newest = path_of(job.number); }};
};

CheckpointWriter::CheckpointWriter(CheckpointWriterOptions options)
    : impl_(std::make_unique<Impl>(std::move(options))) {}

CheckpointWriter::~CheckpointWriter() = default;

void CheckpointWriter::submit(CheckpointHeader header, StateTree&& state) {
  header.number = impl_->next;
  impl_->queue.submit({impl_->next, {std::move(header), std::move(state)}});
  ++impl_->next;
}

void CheckpointWriter::finish() { impl_->queue.finish(); }

fs::path CheckpointWriter::newest() const {
  const auto lock = impl_->queue.lock();
  return impl_->newest;
}

}  // namespace suture
