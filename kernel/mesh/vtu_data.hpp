// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/mesh/vtu_xml.hpp"
#include "kernel/vtk/vtk_module.hpp"

// The numbers of .vtu files: text, base64 or raw, compressed or not.

namespace suture {

/// What <VTKFile> and <AppendedData> say of all arrays of a file.
struct VtuEncoding {
  VtuCompression compression = VtuCompression::raw;
  bool long_headers = false;       ///< header_type UInt64, else UInt32
  bool swap_bytes = false;         ///< byte_order BigEndian
  const char* appended = nullptr;  ///< behind the '_' of <AppendedData>
  const char* appended_end = nullptr;
  bool appended_base64 = false;
  std::uint64_t memory_left = 0;  ///< bytes that the numbers of further arrays may take
};

/// One <DataArray>; its numbers are decoded when they are asked for.
struct VtuDataArray {
  XmlTag tag;
  const char* text_end = nullptr;  ///< of what stands between the tags
};

/// All numbers of an array. Fails, with line or byte, for a type that is no
/// integer (real), data that are cut off or do not expand, and unless there are
/// `count` numbers. What is not text is decoded only after its header has announced
/// that many, and takes its memory from `memory_left`.
std::vector<std::int64_t> vtu_integers(const FileText& file, VtuEncoding& encoding,
                                       const VtuDataArray& array, std::uint64_t count);
std::vector<double> vtu_reals(const FileText& file, VtuEncoding& encoding,
                              const VtuDataArray& array, std::uint64_t count);
/// Fails for a type that VTK does not know.
void vtu_check_type(const FileText& file, const VtuDataArray& array);
/// Whether the type of an array is one of integers; bytes in one number, 0 if unknown.
bool vtu_is_integer(const VtuDataArray& array);
unsigned vtu_bytes(const VtuDataArray& array);

}  // namespace suture
