// SPDX-License-Identifier: GPL-3.0-or-later
//
// NRRD: teem.sourceforge.net/nrrd/format.html.
#include <algorithm>
#include <bit>
#include <cmath>

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

/// Axes of colours, vectors or time come first or last.
void refuse_other_axes(const TextHeader& text, const std::vector<double>& lengths) {
  const std::string kinds = lowered(text.find({"kinds"}).value_or(""));
  if (lengths.size() == 4 && lengths[0] <= 4 &&
      (kinds.starts_with("rgb") || kinds.starts_with("vector") || kinds.starts_with("list") ||
       kinds.starts_with("3-color") || kinds.starts_with("4-color")))
    fail_with_components(text.head(), lengths[0]);
}

void place(const TextHeader& text, ImageHeader& image) {
  if (const auto directions = text.find({"space directions"});
      directions && directions->find("none") != directions->npos)
    text.head().fail(
        "'space directions' has an axis that is not of space; save one image of three "
        "axes of space");
  if (const auto steps = text.numbers({"space directions"})) {
    if (steps->size() != 9)
      text.head().fail("'space directions' must have three vectors of three numbers, has " +
                       std::to_string(steps->size()) + " numbers");
    for (std::size_t i = 0; i < 9; ++i) image.steps[i / 3][i % 3] = (*steps)[i];
  } else {
    const auto spacing = text.numbers({"spacings"});
    if (!spacing) fail_without_spacing(text.head(), "space directions");
    image.steps = straight_steps(text.head(), *spacing, "spacings");
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
  const auto lengths = text.numbers({"sizes"});
  if (!lengths) head.fail("the header has no 'sizes'");
  refuse_other_axes(text, *lengths);
  set_size(head, *lengths, image);
  image.type = text.type_named("type", nrrd_types);
  place(text, image);
  image.unit = unit_of(text);
  if (bytes_of(image.type) > 1) image.is_big_endian = lowered(text.require("endian")) == "big";
  find_data(text, image);
  return image;
}

}  // namespace suture
