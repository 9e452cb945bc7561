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
};

/// One <DataArray>; its numbers are decoded when they are asked for.
struct VtuDataArray {
  XmlTag tag;
  const char* text_end = nullptr;  ///< of what stands between the tags
};

/// All numbers of an array. Fails, with line or byte, for a type that is no
/// integer (real), data that are cut off or do not expand, and unless there are
/// `count` numbers; `count` none: as many as there are. Never allocates more than
/// the data can expand to.
std::vector<std::int64_t> vtu_integers(const FileText& file, const VtuEncoding& encoding,
                                       const VtuDataArray& array,
                                       std::optional<std::uint64_t> count);
std::vector<double> vtu_reals(const FileText& file, const VtuEncoding& encoding,
                              const VtuDataArray& array, std::uint64_t count);
/// Whether the type of an array is one of integers; bytes in one number, 0 if unknown.
bool vtu_is_integer(const VtuDataArray& array);
unsigned vtu_bytes(const VtuDataArray& array);

}  // namespace suture
