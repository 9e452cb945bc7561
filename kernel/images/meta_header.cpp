// SPDX-License-Identifier: GPL-3.0-or-later
//
// MetaImage: itk.org/Wiki/MetaIO/Documentation.
#include <array>
#include <cmath>
#include <utility>

#include "kernel/images/text_header.hpp"
#include "kernel/mesh/file_text.hpp"

namespace suture {
namespace {

const VoxelTypes meta_types{
    {"met_char", VoxelType::int8},       {"met_uchar", VoxelType::uint8},
    {"met_short", VoxelType::int16},     {"met_ushort", VoxelType::uint16},
    {"met_int", VoxelType::int32},       {"met_uint", VoxelType::uint32},
    {"met_long", VoxelType::int32},      {"met_ulong", VoxelType::uint32},
    {"met_long_long", VoxelType::int64}, {"met_ulong_long", VoxelType::uint64},
    {"met_float", VoxelType::float32},   {"met_double", VoxelType::float64}};

/// Sets the steps and the place of the first voxel; images have three axes or more.
void place(const TextHeader& text, std::size_t axes, ImageHeader& image) {
  const auto spacing = text.numbers({"ElementSpacing", "ElementSize"});
  if (!spacing) fail_without_spacing(text.head(), "ElementSpacing");
  image.steps = straight_steps(text.head(), *spacing, "ElementSpacing");
  if (const auto turned = text.numbers({"TransformMatrix", "Rotation", "Orientation"})) {
    if (turned->size() != axes * axes)
      text.head().fail("'TransformMatrix' must have " + std::to_string(axes * axes) +
                       " numbers, has " + std::to_string(turned->size()));
    for (std::size_t a = 0; a < 3; ++a)  // one axis after the other
      for (std::size_t r = 0; r < 3; ++r)
        image.steps[a][r] = std::abs((*spacing)[a]) * (*turned)[axes * a + r];
  }
  const auto origin = text.numbers({"Offset", "Position", "Origin"});
  for (std::size_t r = 0; origin && r < std::min<std::size_t>(3, origin->size()); ++r)
    image.origin[r] = (*origin)[r];
}

}  // namespace

ImageHeader read_meta_header(const FileHead& head) {
  const TextHeader text(head, '=', "elementdatafile");
  ImageHeader image;
  const auto lengths = text.numbers({"DimSize"});
  if (!lengths) head.fail("the header has no 'DimSize'");
  set_size(head, *lengths, image);
  if (const auto count = text.numbers({"ElementNumberOfChannels"});
      count && !count->empty() && count->front() != 1)
    fail_with_components(head, count->front());
  image.type = text.type_named("ElementType", meta_types);
  place(text, lengths->size(), image);
  image.is_big_endian =
      text.is_true({"BinaryDataByteOrderMSB"}) || text.is_true({"ElementByteOrderMSB"});
  if (lowered(text.find({"BinaryData"}).value_or("true")) == "false")
    head.fail("voxels written as text are not read; save the image in binary");
  const bool is_packed = text.is_true({"CompressedData"});
  if (is_packed) image.packing = ImageHeader::Packing::deflated;
  const std::string file = text.require("ElementDataFile");
  const bool is_here = lowered(file) == "local";
  image.data = is_here ? head.path : text.beside(file);
  const double given = text.numbers({"HeaderSize"}).value_or(std::vector{0.0}).at(0);
  image.is_at_end = !is_here && given < 0;
  const auto begin = is_here ? text.end() : static_cast<std::uint64_t>(std::max(given, 0.0));
  (is_packed ? image.packed_from : image.skipped) = begin;
  return image;
}

}  // namespace suture
