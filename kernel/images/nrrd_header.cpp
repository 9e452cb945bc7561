// SPDX-License-Identifier: GPL-3.0-or-later
//
// NRRD: teem.sourceforge.net/nrrd/format.html.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "kernel/images/text_header.hpp"
#include "kernel/mesh/file_text.hpp"

namespace suture {
namespace {

const VoxelTypes nrrd_types{{"signed char", VoxelType::int8},
                            {"int8", VoxelType::int8},
                            {"int8_t", VoxelType::int8},
                            {"uchar", VoxelType::uint8},
                            {"unsigned char", VoxelType::uint8},
                            {"uint8", VoxelType::uint8},
                            {"uint8_t", VoxelType::uint8},
                            {"short", VoxelType::int16},
                            {"short int", VoxelType::int16},
                            {"signed short", VoxelType::int16},
                            {"signed short int", VoxelType::int16},
                            {"int16", VoxelType::int16},
                            {"int16_t", VoxelType::int16},
                            {"ushort", VoxelType::uint16},
                            {"unsigned short", VoxelType::uint16},
                            {"unsigned short int", VoxelType::uint16},
                            {"uint16", VoxelType::uint16},
                            {"uint16_t", VoxelType::uint16},
                            {"int", VoxelType::int32},
                            {"signed int", VoxelType::int32},
                            {"int32", VoxelType::int32},
                            {"int32_t", VoxelType::int32},
                            {"uint", VoxelType::uint32},
                            {"unsigned int", VoxelType::uint32},
                            {"uint32", VoxelType::uint32},
                            {"uint32_t", VoxelType::uint32},
                            {"longlong", VoxelType::int64},
                            {"long long", VoxelType::int64},
                            {"long long int", VoxelType::int64},
                            {"signed long long", VoxelType::int64},
                            {"int64", VoxelType::int64},
                            {"int64_t", VoxelType::int64},
                            {"ulonglong", VoxelType::uint64},
                            {"unsigned long long", VoxelType::uint64},
                            {"unsigned long long int", VoxelType::uint64},
                            {"uint64", VoxelType::uint64},
                            {"uint64_t", VoxelType::uint64},
                            {"float", VoxelType::float32},
                            {"double", VoxelType::float64}};

/// The axes of an image: how many voxels, and the step from one voxel to the next.
struct Axis {
  double length = 1;
  std::optional<Vec3> direction;  ///< nothing: "none", or no directions are given
  double spacing = std::numeric_limits<double>::quiet_NaN();
};

/// The vectors of "space directions: none (1,0,0) (0,1,0) (0,0,1)", "none" as nothing.
std::vector<std::optional<Vec3>> directions_of(const TextHeader& text, const std::string& value) {
  std::vector<std::optional<Vec3>> directions;
  for (std::size_t at = 0; (at = value.find_first_not_of(" \t,", at)) != value.npos;) {
    const bool is_vector = value[at] == '(';
    const std::size_t end =
        std::min(is_vector ? value.find(')', at) : value.find_first_of(" \t(", at), value.size());
    const std::string word = value.substr(at, end - at);
    at = std::min(end + (is_vector ? 1 : 0), value.size());
    if (!is_vector && lowered(word) != "none")
      text.head().fail("'space directions' has " + in_quotes(word) +
                       "; expected vectors in parentheses or 'none'");
    if (!is_vector) {
      directions.emplace_back();
      continue;
    }
    const std::vector<double> numbers = text.numbers_of("space directions", word.substr(1));
    if (numbers.size() != 3)
      text.head().fail("'space directions' must have vectors of three numbers, has " +
                       in_quotes(word + ")"));
    directions.emplace_back(Vec3{numbers[0], numbers[1], numbers[2]});
  }
  return directions;
}

std::vector<Axis> axes_of(const TextHeader& text) {
  const auto lengths = text.numbers({"sizes"});
  if (!lengths) text.head().fail("the header has no 'sizes'");
  std::vector<Axis> axes;
  for (const double length : *lengths) axes.push_back({length, {}, {}});
  const auto require_one_each = [&](const char* key, std::size_t count) {
    if (count != axes.size())
      text.head().fail(std::string("'") + key + "' must have one entry for each of the " +
                       std::to_string(axes.size()) + " axes of 'sizes', has " +
                       std::to_string(count));
  };
  if (const auto value = text.find({"space directions"})) {
    const auto directions = directions_of(text, *value);
    require_one_each("space directions", directions.size());
    for (std::size_t a = 0; a < axes.size(); ++a) axes[a].direction = directions[a];
  }
  if (const auto spacings = text.numbers({"spacings"})) {
    require_one_each("spacings", spacings->size());
    for (std::size_t a = 0; a < axes.size(); ++a) axes[a].spacing = (*spacings)[a];
  }
  return axes;
}

/// Axes of colours, vectors or time come first or last. One of them with a single entry changes
/// nothing and is left out, so that the axes of space remain.
void drop_other_axes(const TextHeader& text, std::vector<Axis>& axes) {
  const bool has_directions = text.find({"space directions"}).has_value();
  const auto is_of_space = [&](const Axis& axis) {
    return has_directions ? axis.direction.has_value() : std::isfinite(axis.spacing);
  };
  const std::string kinds = lowered(text.find({"kinds"}).value_or(""));
  if (axes.size() == 4 && axes[0].length > 1 && axes[0].length <= 4 &&
      (kinds.starts_with("rgb") || kinds.starts_with("vector") || kinds.starts_with("list") ||
       kinds.starts_with("3-color") || kinds.starts_with("4-color")))
    fail_with_components(text.head(), axes[0].length);
  if (axes.size() > 3)
    std::erase_if(axes, [&](const Axis& axis) { return axis.length == 1 && !is_of_space(axis); });
}

void place(const TextHeader& text, const std::vector<Axis>& axes, ImageHeader& image) {
  if (text.find({"space directions"})) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (!axes[a].direction)
        text.head().fail(
            "'space directions' has an axis that is not of space; save one image of three "
            "axes of space");
      image.steps[a] = *axes[a].direction;
    }
  } else {
    if (!text.find({"spacings"})) fail_without_spacing(text.head(), "space directions");
    image.steps = straight_steps(text.head(), {axes[0].spacing, axes[1].spacing, axes[2].spacing},
                                 "spacings");
  }
  const auto origin = text.numbers({"space origin"});
  if (origin && origin->size() != 3)
    text.head().fail("'space origin' must have three numbers, has " +
                     std::to_string(origin->size()));
  for (std::size_t r = 0; origin && r < 3; ++r) image.origin[r] = (*origin)[r];
}

/// Returns the length of the first unit that is stated, m; that of a millimetre if none is.
double unit_of(const TextHeader& text) {
  const std::string units = text.find({"space units", "units"}).value_or("");
  if (units.find("\"m\"") != units.npos) return 1;
  if (units.find("\"cm\"") != units.npos) return 1e-2;
  if (units.find("\"um\"") != units.npos || units.find("micron") != units.npos) return 1e-6;
  return 1e-3;
}

void find_data(const TextHeader& text, ImageHeader& image) {
  const FileHead& head = text.head();
  const std::string encoding = lowered(text.require("encoding"));
  if (encoding == "gzip" || encoding == "gz")
    image.packing = ImageHeader::Packing::deflated;
  else if (encoding != "raw")
    head.fail("voxels in the encoding " + in_quotes(encoding) +
              " are not read; save the image as raw or gzip");
  const auto file = text.find({"data file", "datafile"});
  image.data = file ? text.beside(*file) : head.path;
  const double lines = text.numbers({"line skip", "lineskip"}).value_or(std::vector{0.0}).at(0);
  const double skip = text.numbers({"byte skip", "byteskip"}).value_or(std::vector{0.0}).at(0);
  if (lines != 0) head.fail("'line skip' is not read; give 'byte skip'");
  image.is_at_end = skip < 0;
  image.skipped = static_cast<std::uint64_t>(std::max(skip, 0.0));
  const std::uint64_t begin = file ? 0 : text.end();
  (image.packing == ImageHeader::Packing::raw ? image.skipped : image.packed_from) += begin;
}

}  // namespace

ImageHeader read_nrrd_header(const FileHead& head) {
  const TextHeader text(head, ':', "");
  ImageHeader image;
  std::vector<Axis> axes = axes_of(text);
  drop_other_axes(text, axes);
  std::vector<double> lengths;
  for (const Axis& axis : axes) lengths.push_back(axis.length);
  set_size(head, lengths, image);
  image.type = text.type_named("type", nrrd_types);
  place(text, axes, image);
  image.unit = unit_of(text);
  if (bytes_of(image.type) > 1) image.is_big_endian = lowered(text.require("endian")) == "big";
  find_data(text, image);
  return image;
}

}  // namespace suture
