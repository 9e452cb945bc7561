// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/images/label_image.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "kernel/base/error.hpp"
#include "kernel/base/safe_range.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/images/voxel_bytes.hpp"
#include "kernel/images/voxel_stream.hpp"
#include "kernel/mesh/file_text.hpp"

namespace suture {
namespace {

constexpr double worth_a_note = 100e6;     // bytes
constexpr std::size_t most_labels = 4096;  // a scan has more values, a segmentation fewer
constexpr std::size_t labels_in_a_list = 12;

template <class T>
void decode(std::span<const char> bytes, bool is_reversed, std::span<double> values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = static_cast<double>(load<T>(bytes.data() + i * sizeof(T), is_reversed));
}

using Decode = void (*)(std::span<const char>, bool, std::span<double>);

Decode decoder_of(VoxelType type) {
  switch (type) {
    case VoxelType::int8:
      return decode<std::int8_t>;
    case VoxelType::uint8:
      return decode<std::uint8_t>;
    case VoxelType::int16:
      return decode<std::int16_t>;
    case VoxelType::uint16:
      return decode<std::uint16_t>;
    case VoxelType::int32:
      return decode<std::int32_t>;
    case VoxelType::uint32:
      return decode<std::uint32_t>;
    case VoxelType::int64:
      return decode<std::int64_t>;
    case VoxelType::uint64:
      return decode<std::uint64_t>;
    case VoxelType::float32:
      return decode<float>;
    case VoxelType::float64:
      break;
  }
  return decode<double>;
}

[[noreturn]] void fail_truncated(const ImageHeader& image) {
  throw InputError(image.data.string() + ": the file is shorter than the " + size_text(image) +
                   " that its header states; it is truncated or damaged");
}

/// The number of bytes of the inflated data.
std::uint64_t inflated_size(const ImageHeader& image) {
  VoxelStream stream(image.data);
  stream.seek(image.packed_from);
  stream.inflate();
  return stream.skip(std::numeric_limits<std::uint64_t>::max());
}

void go_to_voxels(const ImageHeader& image, VoxelStream& stream) {
  const std::uint64_t bytes = image.bytes();
  if (image.packing == ImageHeader::Packing::raw) {
    const std::uint64_t size = stream.file_size();
    if (bytes > size || (!image.is_at_end && image.skipped > size - bytes)) fail_truncated(image);
    return stream.seek(image.is_at_end ? size - bytes : image.skipped);
  }
  const std::uint64_t size = image.is_at_end ? inflated_size(image) : image.skipped + bytes;
  if (size < bytes) fail_truncated(image);
  stream.seek(image.packed_from);
  stream.inflate();
  stream.skip(size - bytes);
}

std::string place_text(const ImageHeader& image, std::uint64_t voxel) {
  const std::uint64_t row = voxel / image.size[0];
  return "(" + std::to_string(voxel % image.size[0]) + ", " + std::to_string(row % image.size[1]) +
         ", " + std::to_string(row / image.size[1]) + ")";
}

[[noreturn]] void fail_not_whole(const ImageHeader& image, std::uint64_t voxel, double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  throw InputError(image.source + ": voxel " + place_text(image, voxel) + " has the value " + text +
                   ", but labels are whole numbers; give the segmentation, not the scan");
}

[[noreturn]] void fail_too_many(const ImageHeader& image) {
  throw InputError(image.source + ": more than " + grouped(most_labels) +
                   " different values; give the segmentation, not the scan");
}

/// Calls work(first voxel, label, count) for runs of equal labels, row by row. Returns the number
/// of bytes that follow the voxels.
template <class Work>
std::uint64_t for_each_run(const ImageHeader& image, Work&& work) {
  constexpr double largest = 9e15;  // whole numbers up to there are exact
  VoxelStream stream(image.data);
  go_to_voxels(image, stream);
  const std::uint64_t row = image.size[0];
  require_memory(image.source, "rows of " + grouped(row) + " voxels",
                 double(row) * double(sizeof(double) + bytes_of(image.type)), available_memory());
  std::vector<char> bytes(row * bytes_of(image.type));
  std::vector<double> values(row);
  const Decode decode_row = decoder_of(image.type);
  const bool is_reversed = image.is_big_endian == (std::endian::native == std::endian::little);
  for (std::uint64_t first = 0; first < row * image.size[1] * image.size[2]; first += row) {
    if (stream.read_some(bytes) < bytes.size()) fail_truncated(image);
    decode_row(bytes, is_reversed, values);
    for (std::uint64_t i = 0, end = 0; i < row; i = end) {
      while (end < row && (values[end] == values[i] || end == i)) ++end;
      const double value = image.slope * values[i] + image.intercept;
      if (!(std::abs(value) <= largest) || value != std::floor(value))
        fail_not_whole(image, first + i, value);
      work(first + i, static_cast<std::int64_t>(value), end - i);
    }
  }
  return stream.skip(std::numeric_limits<std::uint64_t>::max());
}

void warn_of_surplus(const ImageHeader& image, std::uint64_t bytes, Diagnostics& diagnostics) {
  if (bytes == 0) return;
  diagnostics.warn(image.data.string() + ": " + grouped(bytes) + " bytes follow the " +
                   size_text(image) + " that the header states and are not read; check the " +
                   "sizes, the type and the number of skipped bytes in the header");
}

/// "1, 2, 7".
template <class Labels>
std::string list_of(const Labels& labels) {
  std::string text;
  std::size_t count = 0;
  for (const auto& [label, unused] : labels) {
    if (++count > labels_in_a_list) return text + ", ...";
    text += (text.empty() ? "" : ", ") + std::to_string(label);
  }
  return text;
}

[[noreturn]] void fail_unknown(const ImageHeader& image, std::int64_t label,
                               std::map<std::int64_t, std::uint64_t> labels) {
  labels.erase(0);
  std::string text = image.source + ": no voxel has the label " + std::to_string(label);
  if (labels.empty()) throw InputError(text + "; all voxels are 0");
  const auto distance = [&](const auto& entry) { return std::abs(double(entry.first - label)); };
  const auto nearest = std::min_element(
      labels.begin(), labels.end(), [&](auto& a, auto& b) { return distance(a) < distance(b); });
  throw InputError(text + "; the nearest one is " + std::to_string(nearest->first) +
                   "; the image has " + list_of(labels));
}

/// The number of a region in LabelImage::region_of, by label.
class Regions {
 public:
  Regions(const LabelOptions& options, LabelImage& image)
      : takes_all_(options.names.empty()), image_(image) {
    for (const auto& [label, name] : options.names) number_of_[label] = number(name);
  }
  std::uint16_t of(std::int64_t label) {
    const auto found = number_of_.find(label);
    if (found != number_of_.end()) return found->second;
    const bool is_outside = !takes_all_ || label == 0 || number_of_.size() >= most_labels;
    return number_of_[label] = is_outside ? 0 : number("label " + std::to_string(label));
  }

 private:
  std::uint16_t number(const std::string& name) {
    auto& regions = image_.regions;
    const auto found = std::ranges::find(regions, name);
    const auto at = static_cast<std::size_t>(found - regions.begin());
    if (at == regions.size()) regions.push_back(name);
    return static_cast<std::uint16_t>(at + 1);
  }

  bool takes_all_;
  LabelImage& image_;
  std::map<std::int64_t, std::uint16_t> number_of_;
};

void place(const ImageHeader& header, double scale, LabelImage& image) {
  for (std::size_t a = 0; a < 3; ++a) image.steps[a] = scaled(scale, header.steps[a]);
  image.origin = scaled(scale, header.origin);
  for (const Vec3& step : image.steps) {
    image.origin = minus(image.origin, scaled(0.5, step));
    if (!(norm(step) >= shortest_length))
      throw InputError(image.source +
                       ": voxels are shorter than 1e-30 m; check the header and the scale");
  }
  for (unsigned c = 0; c < 8; ++c)
    for (const double x :
         image.corner(double((c & 1) * image.size[0]), double((c >> 1 & 1) * image.size[1]),
                      double((c >> 2) * image.size[2])))
      if (!is_safe_coordinate(x))
        throw InputError(image.source +
                         ": the image reaches beyond 1e30 m; check the header and the scale");
}

std::string memory_text(double bytes) {
  char text[32];
  std::snprintf(text, sizeof text, bytes < 1e9 ? "%.0f MB" : "%.1f GB",
                bytes < 1e9 ? bytes / 1e6 : bytes / 1e9);
  return text;
}

}  // namespace

std::string size_text(const ImageHeader& image) {
  return std::to_string(image.size[0]) + " x " + std::to_string(image.size[1]) + " x " +
         std::to_string(image.size[2]) + " voxels of " + name_of(image.type);
}

void require_memory(const std::string& source, const std::string& what, double needed,
                    double available) {
  if (needed <= available) return;
  throw InputError(source + ": " + what + " need " + memory_text(needed) + " of memory, but " +
                   memory_text(available) +
                   " are available; crop the image or resample it to fewer voxels");
}

Vec3 LabelImage::corner(double i, double j, double k) const {
  Vec3 p = origin;
  for (std::size_t r = 0; r < 3; ++r) p[r] += i * steps[0][r] + j * steps[1][r] + k * steps[2][r];
  return p;
}

double LabelImage::voxel_volume() const {
  return std::abs(dot(steps[0], cross(steps[1], steps[2])));
}

LabelImage read_labels(const std::filesystem::path& path, const LabelOptions& options,
                       Diagnostics& diagnostics) {
  const ImageHeader header = read_image_header(path);
  LabelImage image;
  image.source = header.source;
  image.size = header.size;
  place(header, options.scale.value_or(header.unit), image);
  const double needed = header.voxels() * sizeof(std::uint16_t);
  require_memory(header.source, size_text(header), needed, options.memory);
  if (needed > worth_a_note)
    diagnostics.note(header.source + ": reading " + size_text(header) + ", which takes " +
                     memory_text(needed) + " of memory");
  VoxelStream stream(header.data);
  go_to_voxels(header, stream);  // a file that is too short is refused before memory is taken
  image.region_of.resize(header.size[0] * header.size[1] * header.size[2]);
  Regions regions(options, image);
  std::map<std::int64_t, std::uint64_t> counts;
  const std::uint64_t surplus =
      for_each_run(header, [&](std::uint64_t first, std::int64_t label, std::uint64_t count) {
        counts[label] += count;
        if (counts.size() > most_labels) fail_too_many(header);
        if (const std::uint16_t region = regions.of(label); region != 0)
          std::fill_n(image.region_of.begin() + static_cast<std::ptrdiff_t>(first), count, region);
      });
  warn_of_surplus(header, surplus, diagnostics);
  for (const auto& [label, name] : options.names)
    if (!counts.contains(label)) fail_unknown(header, label, counts);
  if (image.regions.empty()) throw InputError(header.source + ": all voxels are 0: no labels");
  std::erase_if(
      counts, [&](const auto& entry) { return entry.first == 0 || regions.of(entry.first) != 0; });
  if (!counts.empty())
    diagnostics.note(header.source +
                     ": voxels of labels without a name lie outside the body: " + list_of(counts));
  return image;
}

std::map<std::int64_t, std::uint64_t> count_labels(const ImageHeader& image,
                                                   Diagnostics& diagnostics) {
  std::map<std::int64_t, std::uint64_t> counts;
  const std::uint64_t surplus =
      for_each_run(image, [&](std::uint64_t, std::int64_t label, std::uint64_t count) {
        counts[label] += count;
        if (counts.size() > most_labels) fail_too_many(image);
      });
  warn_of_surplus(image, surplus, diagnostics);
  return counts;
}

}  // namespace suture
