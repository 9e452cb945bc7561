// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kernel/base/types.hpp"

// VTK behind a small interface. Its libraries (30 MB, 10 ms to load) are used only by the module
// libsuture-vtk.so, which is loaded when the first .vtu is written or a compressed one is read.

namespace suture {

/// One array to write, tightly packed, component fastest; exactly one of the pointers is set.
struct VtuArray {
  std::string name;
  int components = 1;
  const double* values = nullptr;
  const std::int64_t* ids = nullptr;
  const std::uint8_t* flags = nullptr;
  bool global_ids = false;                       ///< the user's own numbers; marked as global ids
  std::span<const char* const> component_names;  ///< one per component; empty: those of VTK
};

enum class VtuCompression { raw, lz4, zlib, lzma };

/// VTK's numbers.
enum class VtuCell : std::uint8_t {
  line = 3,
  triangle = 5,
  quad = 9,
  tetrahedron = 10,
  hexahedron = 12
};
constexpr int points_of(VtuCell type) {
  switch (type) {
    case VtuCell::line:
      return 2;
    case VtuCell::triangle:
      return 3;
    case VtuCell::quad:
    case VtuCell::tetrahedron:
      return 4;
    case VtuCell::hexahedron:
      break;
  }
  return 8;
}

/// The contents of a .vtu file, or of the .vtp of a surface. Points to memory of the caller;
/// nothing is copied.
struct VtuImage {
  const Vec3* points = nullptr;
  std::size_t point_count = 0;
  const Index* connectivity = nullptr;  ///< VTK's node order
  std::size_t connectivity_size = 0;
  std::size_t cell_count = 0;
  std::span<const VtuCell> cell_types;  ///< of each cell; empty: all cells are hexahedra
  bool is_surface = false;              ///< its cells are polygons
  std::vector<VtuArray> point_arrays, cell_arrays;
  std::optional<double> time;  ///< s, as "TimeValue"
  std::string provenance;      ///< as the text "provenance"; empty: none
  VtuCompression compression = VtuCompression::lz4;
};

/// The result of writing: errno or VTK's message if it failed; otherwise 0 and "".
struct VtuOutcome {
  int error = 0;
  std::string text;
};

class VtkModule {
 public:
  virtual ~VtkModule() = default;
  /// Expands one block, which must yield exactly `out.size()` bytes; returns false otherwise.
  virtual bool expand(VtuCompression compression, std::span<const unsigned char> block,
                      std::span<unsigned char> out) const = 0;
  /// Writes appended raw data to an open file, which stays open. May be called on any thread, and
  /// on several at the same time.
  virtual VtuOutcome write_vtu(int file, const VtuImage& image) const = 0;
};

/// The module, loaded at the first call. Throws IoError if it cannot be loaded.
const VtkModule& vtk_module();

}  // namespace suture
