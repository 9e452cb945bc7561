// SPDX-License-Identifier: GPL-3.0-or-later
#include <vtkLZ4DataCompressor.h>
#include <vtkLZMADataCompressor.h>
#include <vtkNew.h>
#include <vtkZLibDataCompressor.h>

#include <algorithm>

#include "kernel/vtk/vtk_library.hpp"

namespace suture {
namespace {

template <class Compressor>
bool expand_with(std::span<const unsigned char> block, std::span<unsigned char> out) {
  const VtkMessages messages;
  const vtkNew<Compressor> compressor;
  const std::size_t size =
      compressor->Uncompress(block.data(), block.size(), out.data(), out.size());
  return size == out.size() && messages.first().empty();
}

}  // namespace

bool expand_block(VtuCompression compression, std::span<const unsigned char> block,
                  std::span<unsigned char> out) {
  switch (compression) {
    case VtuCompression::lz4:
      return expand_with<vtkLZ4DataCompressor>(block, out);
    case VtuCompression::zlib:
      return expand_with<vtkZLibDataCompressor>(block, out);
    case VtuCompression::lzma:
      return expand_with<vtkLZMADataCompressor>(block, out);
    case VtuCompression::raw:
      break;
  }
  if (block.size() != out.size()) return false;
  std::copy(block.begin(), block.end(), out.begin());
  return true;
}

}  // namespace suture
