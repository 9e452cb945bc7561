// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/frame_writer.hpp"

#include <cstdio>
#include <filesystem>
#include <optional>
#include <utility>

#include "kernel/base/error.hpp"
#include "kernel/output/collection.hpp"
#include "kernel/output/frame_file.hpp"
#include "kernel/output/frame_pieces.hpp"
#include "kernel/output/writing_queue.hpp"

namespace suture {

namespace fs = std::filesystem;

// Everything that `write` calls happens on the writing thread only; the queue and what its lock
// guards are all that both threads touch.
struct FrameWriter::Impl {
  explicit Impl(FrameWriterOptions chosen)
      : options(std::move(chosen)),
        pvd_name(options.collection + ".pvd"),
        pvd_path(folder().path() / pvd_name) {}

  const FrameWriterOptions options;
  const std::string pvd_name;
  const fs::path pvd_path;

  std::vector<Frame> used;
  std::size_t written = 0;
  bool is_resumed = false;
  Collection pvd;
  std::size_t missing = 0;

  OutputFolder& folder() const { return *options.folder; }
  bool waits() const { return options.in_pieces && folder().writers() > 1; }

  std::string stem(const Frame& frame) const {
    char number[24];
    std::snprintf(number, sizeof number, "_%04llu", static_cast<unsigned long long>(frame.number));
    return options.prefix + number;
  }

  void write_piece(Frame& frame, const std::string& list, const std::string& extension) {
    std::optional<Frame> made;
    if (frame.pieces == 0)
      made =
          piece_of(frame, folder().writer(), count_pieces(cell_count(frame), folder().writers()));
    Frame& piece = made ? *made : frame;
    std::vector<std::string> files;
    for (std::size_t i = 0; i < piece.pieces; ++i)
      files.push_back(stem(frame) + '_' + std::to_string(i) + extension);
    folder().write_pieces(files,
                          [&](OutputFile& file) { write_frame(file, piece, options.compression); });
    folder().write(list, [&](OutputFile& file) { file.write(list_of_pieces(piece, files)); });
  }

  void write(Frame& frame) {
    const std::string extension = frame.is_surface ? "vtp" : "vtu";
    const std::string name = stem(frame) + (options.in_pieces ? ".p" : ".") + extension;
    if (options.in_pieces)
      write_piece(frame, name, '.' + extension);
    else
      folder().write(name,
                     [&](OutputFile& file) { write_frame(file, frame, options.compression); });
    pvd.add(frame.time, name);
    folder().write(pvd_name, [&](OutputFile& file) { file.write(pvd.text()); });
  }

  void require_all() {
    if (pvd.files().empty() || folder().is_silent()) return;
    folder().require_in_place();
    if (const std::size_t gone = pvd.leave_out_missing(folder().path()); gone != 0)
      throw IoError(pvd_path.string() + ": " + std::to_string(gone) +
                    " of its frames were removed while the run wrote them; start the run again "
                    "and leave its files where they are");
  }

  // The files from which this run continues belong to it.
  void keep() {
    missing = pvd.leave_out_missing(folder().path());
    for (const std::string& file : pvd.files()) {
      folder().keep(file);
      for (const std::string& piece : pieces_of(folder().path(), file)) folder().keep(piece);
    }
    if (!pvd.files().empty()) folder().keep(pvd_name, pvd.text());
    is_resumed = true;
  }

  void done(Frame frame) {
    ++written;
    if (used.size() < options.waiting) used.push_back(std::move(frame));
  }

  // The last member: its thread ends before the others do.
  WritingQueue<Frame> queue{options.background && !waits() ? options.waiting : 0,
                            [this](Frame& frame) { write(frame); },
                            [this](Frame frame) { done(std::move(frame)); }};
};

FrameWriter::FrameWriter(FrameWriterOptions options)
    : impl_(std::make_unique<Impl>(std::move(options))) {}

FrameWriter::~FrameWriter() = default;

Frame FrameWriter::take_frame() {
  const auto lock = impl_->queue.lock();
  if (impl_->used.empty()) return {};
  Frame frame = std::move(impl_->used.back());
  impl_->used.pop_back();
  return frame;
}

void FrameWriter::submit(Frame frame) {
  check_frame(frame);
  impl_->folder().open();
  impl_->queue.submit(std::move(frame));
}

void FrameWriter::finish() {
  impl_->queue.finish();
  if (impl_->is_resumed) impl_->folder().begin();
  impl_->require_all();
}

void FrameWriter::state(Archive& archive) {
  if (!archive.loads()) finish();
  const auto lock = impl_->queue.lock();
  archive("written", impl_->written);
  archive("list", impl_->pvd);
  if (archive.loads()) impl_->keep();
}

std::size_t FrameWriter::missing() const { return impl_->missing; }

std::size_t FrameWriter::written() const {
  const auto lock = impl_->queue.lock();
  return impl_->written;
}

std::string FrameWriter::collection() const { return impl_->pvd_path.string(); }

}  // namespace suture
