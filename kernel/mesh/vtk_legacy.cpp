// SPDX-License-Identifier: GPL-3.0-or-later
//
// Legacy VTK files, versions 1 to 5.1, ASCII and binary. Format: "VTK File Formats",
// VTK User's Guide. Not read by VTK, because its reader allocates as much as a corrupt
// count requests, accepts truncated files, and does not report line numbers.
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>

#include "kernel/base/error.hpp"
#include "kernel/mesh/readers.hpp"
#include "kernel/mesh/vtk_mesh.hpp"

namespace suture {
namespace {

enum class Scalar { u8, i8, u16, i16, u32, i32, u64, i64, f32, f64 };

struct ScalarName {
  std::string_view name;
  Scalar scalar;
  unsigned bytes;
};
// vtkIdType is written as int by every version that writes that name.
constexpr ScalarName scalar_names[] = {
    {"unsigned_char", Scalar::u8, 1},  {"char", Scalar::i8, 1},
    {"signed_char", Scalar::i8, 1},    {"unsigned_short", Scalar::u16, 2},
    {"short", Scalar::i16, 2},         {"unsigned_int", Scalar::u32, 4},
    {"int", Scalar::i32, 4},           {"unsigned_long", Scalar::u64, 8},
    {"long", Scalar::i64, 8},          {"vtktypeint64", Scalar::i64, 8},
    {"vtktypeuint64", Scalar::u64, 8}, {"vtkidtype", Scalar::i32, 4},
    {"float", Scalar::f32, 4},         {"double", Scalar::f64, 8},
};

std::string lower(std::string_view word) {
  std::string text(word);
  for (char& c : text) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  return text;
}

// Names of arrays carry %20 for a space.
std::string decoded(std::string_view name) {
  std::string text;
  for (std::size_t i = 0; i < name.size(); ++i) {
    unsigned code = 0;
    const char* digits = name.data() + i + 1;
    if (name[i] == '%' && i + 2 < name.size() &&
        std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2) {
      text += static_cast<char>(code);
      i += 2;
    } else {
      text += name[i];
    }
  }
  return text;
}

template <class T>
T big_endian(const char* p) {
  char bytes[sizeof(T)];
  std::reverse_copy(p, p + sizeof(T), bytes);
  return std::bit_cast<T>(bytes);
}

class LegacyReader {
 public:
  LegacyReader(const FileText& file, const MeshWants& wants, Diagnostics& diagnostics)
      : file_(file), wants_(wants), diagnostics_(diagnostics), in_(file) {}

  Mesh read() {
    header();
    while (in_.skip_space()) {
      if (!section()) break;
    }
    end_data();
    if (!has_points_) in_.fail("section POINTS is missing: the file is truncated");
    if (!has_cells_) in_.fail("section CELLS is missing: the file is truncated");
    if (grid_.types.empty() && grid_.offsets.size() > 1) {
      in_.fail("section CELL_TYPES is missing: the file is truncated");
    }
    return mesh_from_vtk(std::move(grid_), file_, wants_.all_solids, diagnostics_);
  }

 private:
  void header() {
    const std::string_view first = in_.skip_line();
    constexpr std::string_view magic = "# vtk DataFile Version ";
    if (!first.starts_with(magic)) {
      file_.fail_at_line(
          file_.begin(),
          "a legacy VTK file begins with '# vtk DataFile Version', found " + in_quotes(first));
    }
    major_ = first.size() > magic.size() ? first[magic.size()] - '0' : 0;
    in_.skip_line();  // title
    const std::string format = lower(in_.word("ASCII or BINARY"));
    if (format != "ascii" && format != "binary")
      in_.fail("expected ASCII or BINARY, found " + in_quotes(format));
    binary_ = format == "binary";
    if (lower(in_.word("DATASET")) != "dataset") in_.fail("expected DATASET");
    const std::string_view set = in_.peek_word();
    if (lower(set) != "unstructured_grid") {
      const bool is_surface = lower(set) == "polydata";
      in_.fail("the data set is " + in_quotes(set) + (is_surface ? ", a surface" : "") +
               "; expected an UNSTRUCTURED_GRID with hexahedra" +
               (is_surface ? ". \"surface\" in /mesh of a scene fills a closed surface, saved as "
                             ".vtp, .stl, .obj, .off or .ply"
                           : ""));
    }
    in_.word("the data set");
  }

  // Reads one section; false where reading ends.
  bool section() {
    const char* at = in_.position();
    const std::string name = lower(in_.word("a section"));
    if (name == "points")
      points();
    else if (name == "cells")
      cells();
    else if (name == "cell_types")
      cell_types();
    else if (name == "point_data")
      data_of(false);
    else if (name == "cell_data")
      data_of(true);
    else if (name == "field")
      field();
    else if (name == "metadata")
      metadata();
    else if (has_data_)
      attribute(name, at);
    else {
      in_.seek(at);
      in_.fail("expected a section such as POINTS or CELLS, found " + in_quotes(name));
    }
    return !stop_;
  }

  const ScalarName* find_scalar(std::string_view name) const {
    const std::string wanted = lower(name);
    for (const ScalarName& known : scalar_names) {
      if (known.name == wanted) return &known;
    }
    return nullptr;
  }
  const ScalarName& scalar() {
    const std::string_view name = in_.word("a type of numbers");
    const ScalarName* found = find_scalar(name);
    if (!found) fail_type(name);
    return *found;
  }
  [[noreturn]] void fail_type(std::string_view name) {
    const std::string cause = in_.skip_space() ? "" : ": the file is truncated";
    file_.fail_at_line(name.data(), "type of numbers " + in_quotes(name) + " is unknown" + cause);
  }

  void require_room(std::uint64_t count, unsigned bytes, const char* what) {
    if (!binary_) return in_.require_room(count, 1, what);
    if (count > in_.bytes_left() / bytes) {
      fail(grouped(count) + " " + what + " are declared, but only " + grouped(in_.bytes_left()) +
           " bytes remain: the file is truncated or the count is wrong");
    }
  }
  [[noreturn]] void fail(const std::string& what) const {
    if (binary_) file_.fail_at_byte(in_.position(), what);
    in_.fail(what);
  }

  template <class T>
  T value(const ScalarName& type) {
    const char* p = in_.position();
    in_.seek(p + type.bytes);
    switch (type.scalar) {
      case Scalar::u8:
        return static_cast<T>(static_cast<unsigned char>(*p));
      case Scalar::i8:
        return static_cast<T>(static_cast<signed char>(*p));
      case Scalar::u16:
        return static_cast<T>(big_endian<std::uint16_t>(p));
      case Scalar::i16:
        return static_cast<T>(big_endian<std::int16_t>(p));
      case Scalar::u32:
        return static_cast<T>(big_endian<std::uint32_t>(p));
      case Scalar::i32:
        return static_cast<T>(big_endian<std::int32_t>(p));
      case Scalar::u64:
        return static_cast<T>(big_endian<std::uint64_t>(p));
      case Scalar::i64:
        return static_cast<T>(big_endian<std::int64_t>(p));
      case Scalar::f32:
        return static_cast<T>(big_endian<float>(p));
      case Scalar::f64:
        return static_cast<T>(big_endian<double>(p));
    }
    return T{};
  }
  // Calls each(value) for `count` integers.
  template <class Each>
  void integers(const ScalarName& type, std::uint64_t count, const char* what, Each each) {
    if (!is_integral(type)) in_.fail(std::string(what) + " must be integers");
    start_array(type, count, what);
    for (std::uint64_t i = 0; i < count; ++i) {
      each(binary_ ? value<std::int64_t>(type) : in_.integer<std::int64_t>(what));
    }
  }
  void start_array(const ScalarName& type, std::uint64_t count, const char* what) {
    if (binary_) in_.skip_line();
    require_room(count, type.bytes, what);
  }
  void skip_array(const ScalarName& type, std::uint64_t count) {
    start_array(type, count, "values");
    if (binary_) return in_.seek(in_.position() + count * type.bytes);
    for (std::uint64_t i = 0; i < count; ++i) in_.word("a value");
  }

  void points() {
    if (has_points_) in_.fail("a second section POINTS");
    has_points_ = true;
    const auto count = in_.integer<std::uint64_t>("number of points");
    check_count(file_, count, "points");
    const ScalarName& type = scalar();
    start_array(type, 3 * count, "coordinates");
    grid_.points.resize(count);
    for (Vec3& x : grid_.points) {
      for (double& c : x) {
        c = binary_ ? value<double>(type) : in_.real("coordinate");
        if (c - c != 0) fail("a coordinate is not finite");
      }
    }
  }

  void cells() {
    if (has_cells_) in_.fail("a second section CELLS");
    has_cells_ = true;
    const auto first = in_.integer<std::uint64_t>("number of cells");
    const auto second = in_.integer<std::uint64_t>("size of the cells");
    check_count(file_, first, "cells");
    if (major_ >= 5) return cells_of_version_5(first, second);
    if (first > second) in_.fail("the size of CELLS is smaller than its number of cells");
    const ScalarName& type = *find_scalar("int");
    start_array(type, second, "numbers of cells");
    grid_.offsets.reserve(first + 1);
    grid_.offsets.push_back(0);
    grid_.connectivity.reserve(second - first);
    for (std::uint64_t c = 0; c < first; ++c) {
      const std::int64_t n = cell_number(type);
      if (n < 0 || std::uint64_t(n) + 1 + grid_.connectivity.size() + c > second) {
        fail("cell " + std::to_string(c) + " has " + std::to_string(n) +
             " points, more than the size of CELLS allows");
      }
      for (std::int64_t i = 0; i < n; ++i) add_node(c, cell_number(type));
      grid_.offsets.push_back(std::int64_t(grid_.connectivity.size()));
    }
    if (grid_.connectivity.size() + first != second) {
      fail("the cells have " + grouped(grid_.connectivity.size() + first) +
           " numbers; CELLS declares " + grouped(second));
    }
  }
  std::int64_t cell_number(const ScalarName& type) {
    return binary_ ? value<std::int64_t>(type) : in_.integer<std::int64_t>("number of a point");
  }
  void add_node(std::uint64_t cell, std::int64_t node) {
    if (has_points_ && (node < 0 || node >= std::int64_t(grid_.points.size()))) {
      fail("cell " + std::to_string(cell) + " has point " + std::to_string(node) +
           "; the points are numbered 0 to " +
           std::to_string(std::int64_t(grid_.points.size()) - 1));
    }
    grid_.connectivity.push_back(node);
  }
  void cells_of_version_5(std::uint64_t offsets, std::uint64_t connectivity) {
    if (lower(in_.word("OFFSETS")) != "offsets") in_.fail("expected OFFSETS");
    const ScalarName& offset_type = scalar();
    require_room(offsets, 1, "offsets");
    grid_.offsets.reserve(offsets);
    integers(offset_type, offsets, "offset", [&](std::int64_t v) { grid_.offsets.push_back(v); });
    if (lower(in_.word("CONNECTIVITY")) != "connectivity") in_.fail("expected CONNECTIVITY");
    const ScalarName& type = scalar();
    require_room(connectivity, 1, "points of cells");
    grid_.connectivity.reserve(connectivity);
    integers(type, connectivity, "number of a point",
             [&](std::int64_t v) { add_node(grid_.connectivity.size() / 8, v); });
  }

  void cell_types() {
    if (!grid_.types.empty()) in_.fail("a second section CELL_TYPES");
    const auto count = in_.integer<std::uint64_t>("number of cell types");
    if (has_cells_ && count + 1 != std::max<std::uint64_t>(grid_.offsets.size(), 1)) {
      in_.fail(grouped(count) + " cell types for " +
               grouped(std::max<std::uint64_t>(grid_.offsets.size(), 1) - 1) + " cells");
    }
    const ScalarName& type = *find_scalar("int");
    require_room(count, 1, "cell types");
    grid_.types.reserve(count);
    integers(type, count, "type of a cell", [&](std::int64_t v) {
      if (v < 0 || v > 255) fail("cell type " + std::to_string(v) + " is unknown");
      grid_.types.push_back(static_cast<std::uint8_t>(v));
    });
  }

  void data_of(bool cells) {
    end_data();
    has_data_ = true;
    arrays_ = 0;
    of_cells_ = cells;
    const auto count = in_.integer<std::uint64_t>("number of values");
    const std::size_t expected = cells ? grid_.types.size() : grid_.points.size();
    if (count != expected) {
      in_.fail(grouped(count) + " values for " + grouped(expected) +
               (cells ? " cells" : " points"));
    }
    tuples_ = count;
  }

  // Writers leave out a section that has no array.
  void end_data() {
    if (!has_data_ || arrays_ > 0) return;
    diagnostics_.warn(file_.name() + ": no array follows " +
                      (of_cells_ ? "CELL_DATA " : "POINT_DATA ") + std::to_string(tuples_) +
                      "; the file may be truncated");
  }

  // One array: integers label points or cells; numbers are kept where they are wanted.
  void array(const std::string& name, const ScalarName& type, std::uint64_t components,
             std::uint64_t tuples, bool global_ids) {
    require_size(name, components, tuples);
    if (!has_data_ || components == 0 || tuples != tuples_)
      return skip_array(type, components * tuples);
    MeshArray* const earlier = grid_.find_array(name, of_cells_);
    const bool wanted = !global_ids && !earlier && wants_.wants_array(name);
    MeshArray found{name, of_cells_, components, {}, {}};
    if (components == 1 && is_integral(type)) {
      label(name, type, global_ids);
      const auto& labels = grid_.labels.back().values;
      if (wanted) found.values.assign(labels.begin(), labels.end());
    } else if (wanted) {
      found.values = numbers(type, components * tuples);
    } else {
      skip_array(type, components * tuples);
    }
    if (earlier)
      *earlier = {name, of_cells_, components, {}, "the file has two arrays of this name"};
    else if (!global_ids)
      grid_.arrays.push_back(std::move(found));
  }

  void require_size(const std::string& name, std::uint64_t components, std::uint64_t tuples) {
    ++arrays_;
    if (components != 0 && tuples > file_.view().size() / components)
      in_.fail("array " + in_quotes(name) + " is larger than the file");
  }
  static bool is_integral(const ScalarName& type) {
    return type.scalar != Scalar::f32 && type.scalar != Scalar::f64;
  }
  void label(const std::string& name, const ScalarName& type, bool global_ids) {
    VtkGrid::Labels labels{name, of_cells_, type.bytes == 1, global_ids, {}};
    labels.values.reserve(std::min<std::uint64_t>(tuples_, in_.bytes_left()));
    integers(type, tuples_, "value", [&](std::int64_t v) { labels.values.push_back(v); });
    grid_.labels.push_back(std::move(labels));
  }
  std::vector<double> numbers(const ScalarName& type, std::uint64_t count) {
    start_array(type, count, "values");
    std::vector<double> result(count);
    for (double& x : result) x = binary_ ? value<double>(type) : in_.any_real("a value");
    return result;
  }

  void field() {
    in_.word("name of a field");
    const auto arrays = in_.integer<std::uint64_t>("number of arrays");
    for (std::uint64_t a = 0; a < arrays && !stop_; ++a) {
      while (lower(in_.peek_word()) == "metadata") {
        in_.word("METADATA");
        metadata();
      }
      const std::string name = decoded(in_.word("name of an array"));
      const auto components = in_.integer<std::uint64_t>("number of components");
      const auto tuples = in_.integer<std::uint64_t>("number of tuples");
      const std::string_view type_name = in_.word("a type of numbers");
      const ScalarName* type = find_scalar(type_name);
      if (!type) return stop_at(name, type_name);
      if (has_data_ && tuples != tuples_) warn_of_length(name, tuples);
      array(name, *type, components, tuples, false);
    }
  }

  void warn_of_length(const std::string& name, std::uint64_t tuples) {
    grid_.arrays.push_back({name, of_cells_, 1, {}, "it has " + grouped(tuples) + " values"});
    diagnostics_.warn(file_.name() + ": array " + in_quotes(name) + " has " + grouped(tuples) +
                      " values for " + grouped(tuples_) + (of_cells_ ? " cells" : " points") +
                      "; it is not read");
  }

  // Strings, bits and variants are rare, and nothing that a mesh needs follows them.
  void stop_at(const std::string& name, std::string_view type) {
    constexpr std::array<std::string_view, 4> unread{"bit", "string", "utf8_string", "variant"};
    if (std::find(unread.begin(), unread.end(), lower(type)) == unread.end()) fail_type(type);
    if (has_data_)
      grid_.arrays.push_back({name, of_cells_, 1, {}, "its type is " + in_quotes(type)});
    const std::string what = "array " + in_quotes(name) + " has the type " + in_quotes(type);
    stop_ = has_points_ && has_cells_ && !grid_.types.empty();
    if (!stop_) in_.fail(what + ", which is not supported");
    ++arrays_;
    diagnostics_.warn(file_.name() + ": " + what +
                      "; neither it nor the following arrays are read");
  }

  void metadata() {
    in_.skip_line();
    while (in_.bytes_left() > 0 && !in_.skip_line().empty()) {
    }
  }

  void attribute(const std::string& keyword, const char* at) {
    const std::string name = decoded(in_.word("name of an array"));
    if (keyword == "lookup_table") {
      const auto size = in_.integer<std::uint64_t>("size of a table");
      require_size(name, 4, size);
      return skip_array(*find_scalar(binary_ ? "unsigned_char" : "float"), 4 * size);
    }
    if (keyword == "color_scalars") {
      const auto components = in_.integer<std::uint64_t>("number of components");
      return array(name, *find_scalar(binary_ ? "unsigned_char" : "float"), components, tuples_,
                   false);
    }
    std::uint64_t components = 1;
    if (keyword == "vectors" || keyword == "normals")
      components = 3;
    else if (keyword == "tensors")
      components = 9;
    else if (keyword == "tensors6")
      components = 6;
    else if (keyword == "texture_coordinates")
      components = in_.integer<std::uint64_t>("number of components");
    else if (keyword != "scalars" && keyword != "global_ids" && keyword != "pedigree_ids" &&
             keyword != "edge_flags") {
      in_.seek(at);
      in_.fail("expected an array such as SCALARS or FIELD, found " + in_quotes(keyword) +
               "; the previous array has more values than declared");
    }
    const std::string_view type_name = in_.word("a type of numbers");
    const ScalarName* type = find_scalar(type_name);
    if (!type) return stop_at(name, type_name);
    if (keyword == "scalars") components = components_of_scalars();
    array(name, *type, components, tuples_, keyword == "global_ids");
  }

  // "SCALARS name type [components]", then "LOOKUP_TABLE name" on a separate line.
  std::uint64_t components_of_scalars() {
    std::uint64_t components = 1;
    const std::string next = lower(in_.peek_word());
    if (next != "lookup_table" && !next.empty() && next[0] >= '1' && next[0] <= '4' &&
        next.size() == 1 && !at_line_end()) {
      components = in_.integer<std::uint64_t>("number of components");
    }
    if (lower(in_.peek_word()) == "lookup_table") {
      in_.word("LOOKUP_TABLE");
      in_.word("name of a table");
    }
    return components;
  }
  // peek_word has moved to the next word already: did it cross a line feed?
  bool at_line_end() const {
    const char* p = in_.position();
    while (p > file_.begin() && (p[-1] == ' ' || p[-1] == '\t' || p[-1] == '\r')) --p;
    return p > file_.begin() && p[-1] == '\n';
  }

  const FileText& file_;
  const MeshWants& wants_;
  Diagnostics& diagnostics_;
  TextCursor in_;
  VtkGrid grid_;
  int major_ = 0;
  bool binary_ = false, has_points_ = false, has_cells_ = false, has_data_ = false;
  bool of_cells_ = false, stop_ = false;
  std::uint64_t tuples_ = 0;
  std::size_t arrays_ = 0;  ///< since the last POINT_DATA or CELL_DATA
};

}  // namespace

Mesh read_vtk_legacy(const FileText& file, const MeshWants& wants, Diagnostics& diagnostics) {
  return LegacyReader(file, wants, diagnostics).read();
}

}  // namespace suture
