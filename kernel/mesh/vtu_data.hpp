// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/mesh/vtu_xml.hpp"
#include "kernel/vtk/vtk_module.hpp"

// The numbers of .vtu files: text, base64 or raw, compressed or not.

namespace suture {

/// The properties of all arrays of a file, from <VTKFile> and <AppendedData>.
struct VtuEncoding {
  VtuCompression compression = VtuCompression::raw;
  bool long_headers = false;       ///< header_type UInt64, otherwise UInt32
  bool swap_bytes = false;         ///< byte_order BigEndian
  const char* appended = nullptr;  ///< after the '_' of <AppendedData>
  const char* appended_end = nullptr;
  bool appended_base64 = false;
  std::uint64_t memory_left = 0;  ///< bytes that the numbers of further arrays may take
};

/// One <DataArray>; its numbers are decoded on demand.
struct VtuDataArray {
  XmlTag tag;
  const char* text_end = nullptr;  ///< end of the text between the tags
};

/// All numbers of an array. Fails, naming the line or byte, if the type is not an integer (real)
/// type, if the data are truncated or cannot be expanded, or if their number is not `count`.
/// Binary data are decoded only if their header announces that many numbers; their memory is
/// taken from `memory_left`.
std::vector<std::int64_t> vtu_integers(const FileText& file, VtuEncoding& encoding,
                                       const VtuDataArray& array, std::uint64_t count);
std::vector<double> vtu_reals(const FileText& file, VtuEncoding& encoding,
                              const VtuDataArray& array, std::uint64_t count);
/// The same for arrays of any type, with numbers that need not be finite.
std::vector<double> vtu_numbers(const FileText& file, VtuEncoding& encoding,
                                const VtuDataArray& array, std::uint64_t count);
/// Fails for a type that VTK does not know.
void vtu_check_type(const FileText& file, const VtuDataArray& array);
/// Whether the array has an integer type; the bytes per number, 0 if unknown.
bool vtu_is_integer(const VtuDataArray& array);
unsigned vtu_bytes(const VtuDataArray& array);

}  // namespace suture
