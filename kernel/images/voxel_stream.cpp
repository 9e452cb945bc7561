// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/images/voxel_stream.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "kernel/base/error.hpp"

namespace suture {

struct VoxelStream::Inflater {
  z_stream state{};
  std::vector<char> packed = std::vector<char>(std::size_t{1} << 16);
  bool is_at_end = false;  ///< of a packed part

  Inflater() {
    constexpr int largest_window = 15, any_header = 32;  // gzip or zlib
    if (inflateInit2(&state, largest_window + any_header) != Z_OK) throw std::bad_alloc();
  }
  ~Inflater() { inflateEnd(&state); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
};

VoxelStream::VoxelStream(const std::filesystem::path& path) : name_(path.string()), file_(path) {
  if (!file_.problem().empty()) throw InputError(name_ + ": " + file_.problem());
  std::array<char, 2> first{};
  is_gzip_ = file_.read(first) == 2 && first[0] == '\x1f' && first[1] == '\x8b';
  file_.seek(0);
}

VoxelStream::~VoxelStream() = default;

void VoxelStream::inflate() { inflater_ = std::make_unique<Inflater>(); }

std::size_t VoxelStream::read_some(std::span<char> bytes) {
  return inflater_ ? inflate_some(bytes) : file_.read(bytes);
}

std::size_t VoxelStream::inflate_some(std::span<char> bytes) {
  z_stream& state = inflater_->state;
  std::size_t done = 0;
  while (done < bytes.size()) {
    if (state.avail_in == 0) {
      state.next_in = reinterpret_cast<Bytef*>(inflater_->packed.data());
      state.avail_in = static_cast<uInt>(file_.read(inflater_->packed));
      if (state.avail_in == 0) break;
    }
    if (inflater_->is_at_end) {  // parallel gzips write several parts
      if (inflateReset(&state) != Z_OK) break;
      inflater_->is_at_end = false;
    }
    const std::size_t step = std::min<std::size_t>(bytes.size() - done, std::size_t{1} << 30);
    state.next_out = reinterpret_cast<Bytef*>(bytes.data() + done);
    state.avail_out = static_cast<uInt>(step);
    const int result = ::inflate(&state, Z_NO_FLUSH);
    done += step - state.avail_out;
    inflater_->is_at_end = result == Z_STREAM_END;
    if (result == Z_MEM_ERROR) throw std::bad_alloc();
    if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR)
      throw InputError(name_ + ": the compressed data is damaged" +
                       (state.msg != nullptr ? std::string(": ") + state.msg : std::string()));
  }
  return done;
}

std::uint64_t VoxelStream::skip(std::uint64_t bytes) {
  std::vector<char> skipped(std::min<std::uint64_t>(bytes, std::uint64_t{1} << 16));
  std::uint64_t done = 0;
  while (done < bytes) {
    const std::size_t step = std::min<std::uint64_t>(bytes - done, skipped.size());
    const std::size_t read = read_some(std::span(skipped).first(step));
    done += read;
    if (read < step) break;
  }
  return done;
}

}  // namespace suture
