// SPDX-License-Identifier: GPL-3.0-or-later
//
// Binary: 80 bytes, a count n, and n times a normal, three corners (32-bit floats) and 2 bytes.
// Text, in which case and white space do not count:
//
// solid NAME
//   facet normal 0 0 1          <- not read: the order of the corners says the same
//     outer loop
//       vertex 0.05 -1 1        <- three of them
//       vertex ...
//     endloop
//   endfacet
// endsolid NAME                 <- another solid may follow
#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>

#include "kernel/base/error.hpp"
#include "kernel/geometry/surface_readers.hpp"

namespace suture {
namespace {

constexpr std::size_t header_bytes = 84, triangle_bytes = 50;

/// Gives equal places one number, in the order in which they come first.
class PointNumbers {
 public:
  PointNumbers(std::vector<Vec3>& points, std::size_t most)
      : points_(points), slots_(std::bit_ceil(most + most / 4 + 1), none) {}

  Index number(const Vec3& point) {
    if (!std::ranges::all_of(point, [](double x) { return std::isfinite(x); })) {
      points_.push_back(point);  // its reader refuses it by its number
      return static_cast<Index>(points_.size() - 1);
    }
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t slot = hash(point) & mask;; slot = (slot + 1) & mask) {
      if (slots_[slot] == none) {
        slots_[slot] = static_cast<Index>(points_.size());
        points_.push_back(point);
      }
      if (points_[slots_[slot]] == point) return slots_[slot];
    }
  }

 private:
  static std::size_t hash(const Vec3& point) {
    std::uint64_t mixed = 0;
    for (const double x : point) {
      mixed = (mixed ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x9E3779B97F4A7C15u;  // -0 is 0
      mixed ^= mixed >> 29;
    }
    return mixed;
  }

  std::vector<Vec3>& points_;
  std::vector<Index> slots_;  ///< at most 4/5 are taken
};

std::uint32_t count_in_header(std::string_view bytes) {
  std::uint32_t n = 0;
  if (bytes.size() >= header_bytes)
    std::memcpy(&n, bytes.data() + header_bytes - sizeof n, sizeof n);
  return n;
}

std::uint64_t binary_bytes(std::uint32_t triangles) {
  return header_bytes + triangle_bytes * std::uint64_t{triangles};
}

PolygonSoup read_binary(std::string_view bytes) {
  const std::uint32_t n = count_in_header(bytes);
  PolygonSoup soup;
  PointNumbers numbers(soup.points, std::size_t{3} * n);
  for (std::uint32_t i = 0; i < n; ++i) {
    std::array<std::array<float, 3>, 4> rows;  // the normal, then the corners
    std::memcpy(rows.data(), bytes.data() + header_bytes + triangle_bytes * i, sizeof rows);
    for (std::size_t corner = 1; corner < rows.size(); ++corner)
      soup.corners.push_back(numbers.number({rows[corner][0], rows[corner][1], rows[corner][2]}));
    soup.offsets.push_back(3 * (i + 1));
  }
  return soup;
}

class TextReader {
 public:
  explicit TextReader(const FileText& file)
      : cursor_(file), numbers_(soup_.points, file.view().size() / shortest_vertex) {}

  PolygonSoup run() {
    while (cursor_.skip_space()) {
      expect("solid");
      cursor_.skip_line();  // a name may follow
      while (!next_is("endsolid")) facet();
      cursor_.skip_line();
    }
    return std::move(soup_);
  }

 private:
  static constexpr std::size_t shortest_vertex = 13;  // "vertex 0 0 0\n"

  /// Words are compared without case.
  static bool is_word(std::string_view word, std::string_view expected) {
    return std::ranges::equal(
        word, expected, [](unsigned char a, unsigned char b) { return std::tolower(a) == b; });
  }
  bool next_is(std::string_view word) {
    const std::string_view found = cursor_.peek_word();
    if (found.empty())
      cursor_.fail("the file ends without '" + std::string(word) +
                   "': it is truncated; if it is whole, add that line");
    return is_word(found, word);
  }
  void expect(const char* word) {
    if (!next_is(word))
      cursor_.fail("expected '" + std::string(word) + "', found " + in_quotes(cursor_.peek_word()));
    cursor_.word(word);
  }
  double number(const char* what) {
    const std::string_view word = cursor_.peek_word();
    if (word.find(',') != word.npos)
      cursor_.fail("expected a number (" + std::string(what) + "), found " + in_quotes(word) +
                   ": write decimal points instead of commas");
    return cursor_.real(what);
  }

  void facet() {
    expect("facet");
    expect("normal");
    for (int i = 0; i < 3; ++i) cursor_.word("a normal");  // some writers put "nan" there
    expect("outer");
    expect("loop");
    for (int corner = 0; corner < 3; ++corner) {
      expect("vertex");
      Vec3 point;
      point[0] = number("x");
      point[1] = number("y");
      point[2] = number("z");
      soup_.corners.push_back(numbers_.number(point));
    }
    soup_.offsets.push_back(static_cast<Index>(soup_.corners.size()));
    expect("endloop");
    expect("endfacet");
  }

  TextCursor cursor_;
  PolygonSoup soup_;
  PointNumbers numbers_;
};

/// Binary files may begin with "solid" too, but they contain bytes that are 0.
bool is_text(const FileText& file) {
  TextCursor cursor(file);
  std::string first(cursor.peek_word());
  std::ranges::transform(first, first.begin(), [](unsigned char c) { return std::tolower(c); });
  return first == "solid" && file.view().find('\0') == std::string_view::npos;
}

}  // namespace

PolygonSoup read_stl(const FileText& file) {
  const std::string_view bytes = file.view();
  const std::uint32_t n = count_in_header(bytes);
  const std::uint64_t needed = binary_bytes(n);
  if (bytes.size() == needed) return read_binary(bytes);
  if (is_text(file)) return TextReader(file).run();
  if (bytes.size() < needed)
    throw InputError(file.name() + ": " + grouped(bytes.size()) +
                     " bytes are too few for a binary STL file with " + grouped(n) +
                     " triangles, which needs " + grouped(needed) +
                     ": the file is truncated or has another format");
  throw InputError(file.name() + ": " + grouped(bytes.size() - needed) + " bytes follow the " +
                   grouped(n) +
                   " triangles that the header states: the file is damaged or has another format");
}

}  // namespace suture
