// SPDX-License-Identifier: GPL-3.0-or-later
//
// ply
// format ascii 1.0
// element vertex 3                    <- so many lines, or records, of
// property double x                   <- these values, or
// property list uchar int corners     <- a count and as many values
// end_header
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <sstream>
#include <vector>

#include "kernel/base/nearest.hpp"
#include "kernel/base/saturate.hpp"
#include "kernel/geometry/surface_readers.hpp"

namespace suture {
namespace {

enum class Format { ascii, little_endian, big_endian };

/// Names are in pairs: "char" and "int8".
enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
constexpr std::array<std::size_t, 8> bytes_of_types{1, 1, 2, 2, 4, 4, 4, 8};

bool is_integer(Type type) { return type < Type::float32; }
std::size_t bytes_of(Type type) { return bytes_of_types[static_cast<std::size_t>(type)]; }

struct Property {
  std::string name;
  Type type{};
  bool list = false;
  Type count_type{};  ///< of a list
  int axis = -1;      ///< of a point's coordinate
  bool corners = false;
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  bool is_one_of(const char* one, const char* many) const { return name == one || name == many; }
  bool points() const { return is_one_of("vertex", "vertices"); }
  bool faces() const { return is_one_of("face", "faces"); }
};

class PlyReader {
 public:
  explicit PlyReader(const FileText& file) : file_(file), cursor_(file) {}

  PolygonSoup run() {
    read_format();
    while (read_line()) {
    }
    for (const Element& element : elements_)
      if (element.points()) points_ += element.count;
    for (Element& element : elements_) read(element);
    return std::move(soup_);
  }

 private:
  // The words of the next line.
  std::vector<std::string> next_line() {
    line_ = cursor_.position();
    if (cursor_.bytes_left() == 0) fail("the file ends within its header: it is truncated");
    std::istringstream line{std::string(cursor_.skip_line())};
    std::vector<std::string> words;
    for (std::string word; line >> word;) words.push_back(word);
    return words;
  }

  [[noreturn]] void fail(const std::string& what) const { file_.fail_at_line(line_, what); }

  void read_format() {
    if (next_line() != std::vector<std::string>{"ply"}) fail("expected 'ply' in the first line");
    static const std::vector<std::string> formats{"ascii", "binary_little_endian",
                                                  "binary_big_endian"};
    const auto words = next_line();
    const auto known = words.size() == 3 ? std::ranges::find(formats, words[1]) : formats.end();
    if (known == formats.end() || words[0] != "format")
      fail("expected 'format ascii 1.0', binary_little_endian or binary_big_endian");
    format_ = static_cast<Format>(known - formats.begin());
  }

  // False at the end of the header.
  bool read_line() {
    static const std::vector<std::string> keys{"comment", "element", "end_header", "obj_info",
                                               "property"};
    const auto words = next_line();
    const std::string key = words.empty() ? "" : words[0];
    if (key == "end_header") return false;
    if (key == "element") {
      add_element(words);
    } else if (key == "property") {
      add_property(words);
    } else if (key != "comment" && key != "obj_info") {
      fail(in_quotes(key) + " is not a keyword of the header" + did_you_mean(key, keys) +
           "; expected comment, element, end_header, obj_info or property");
    }
    return true;
  }

  void add_element(const std::vector<std::string>& words) {
    Element element;
    if (words.size() != 3) fail("expected 'element NAME COUNT'");
    element.name = words[1];
    const char* end = words[2].data() + words[2].size();
    const auto [stop, error] = std::from_chars(words[2].data(), end, element.count);
    if (error != std::errc{} || stop != end)
      fail(in_quotes(words[2]) + " is not a valid number of elements " + in_quotes(element.name));
    elements_.push_back(std::move(element));
  }

  void add_property(const std::vector<std::string>& words) {
    const bool list = words.size() > 1 && words[1] == "list";
    if (words.size() != (list ? 5U : 3U))
      fail("expected 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
    if (elements_.empty())
      fail("a property appears before the first 'element'; is an earlier line misspelled?");
    Property property;
    property.name = words.back();
    property.type = type(words[words.size() - 2]);
    property.list = list;
    if (list) property.count_type = type(words[2]);
    if (list && !is_integer(property.count_type))
      fail("the count of a list must have an integer type, not " + words[2]);
    elements_.back().properties.push_back(std::move(property));
  }

  Type type(const std::string& word) const {
    static const std::vector<std::string> types{
        "char", "int8",  "uchar", "uint8",  "short", "int16",   "ushort", "uint16",
        "int",  "int32", "uint",  "uint32", "float", "float32", "double", "float64"};
    const auto known = std::ranges::find(types, word);
    if (known == types.end())
      fail(in_quotes(word) + " is not a property type" + did_you_mean(word, types));
    return static_cast<Type>((known - types.begin()) / 2);
  }

  // Every property takes a byte at least, so what is read is bounded by the file.
  void read(Element& element) {
    if (element.count == 0) return;
    if (element.properties.empty())
      fail("the element " + in_quotes(element.name) + " has no property");
    if (format_ == Format::ascii)
      cursor_.require_room(element.count, element.properties.size(),
                           ("elements " + in_quotes(element.name)).c_str());
    choose(element);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      Vec3 point{};
      for (const Property& property : element.properties) {
        const std::uint64_t values = property.list ? count(property) : 1;
        for (std::uint64_t n = 0; n < values; ++n) {
          const double x = value(property, property.type);
          if (property.axis >= 0) point[property.axis] = x;
          if (property.corners) add_corner(x);
        }
      }
      if (element.points()) soup_.points.push_back(point);
      if (element.faces()) soup_.offsets.push_back(static_cast<Index>(soup_.corners.size()));
    }
  }

  // Which of the properties are coordinates or corners.
  void choose(Element& element) const {
    const auto find = [&](const std::string& name, bool list) {
      const auto found = std::ranges::find(element.properties, name, &Property::name);
      return found != element.properties.end() && found->list == list ? &*found : nullptr;
    };
    for (int a = 0; element.points() && a < 3; ++a) {
      const std::string name(1, "xyz"[a]);
      Property* coordinate = find(name, false);
      if (coordinate == nullptr)
        fail("the element " + in_quotes(element.name) + " has no property " + in_quotes(name));
      coordinate->axis = a;
    }
    if (!element.faces()) return;
    Property* corners = find("vertex_indices", true);
    if (corners == nullptr) corners = find("vertex_index", true);
    if (corners == nullptr)
      fail("the element " + in_quotes(element.name) + " has no list 'vertex_indices'");
    if (!is_integer(corners->type)) fail(in_quotes(corners->name) + " must be integers");
    corners->corners = true;
  }

  std::uint64_t count(const Property& property) {
    if (format_ != Format::ascii) {
      const auto count = static_cast<std::int64_t>(value(property, property.count_type));
      if (count < 0)
        file_.fail_at_byte(cursor_.position(), property.name + " has a negative count");
      need(static_cast<std::uint64_t>(count), property, property.type);
      return static_cast<std::uint64_t>(count);
    }
    const auto count = cursor_.integer<std::uint64_t>(property.name.c_str());
    if (count != 0) cursor_.require_room(count, 1, property.name.c_str());
    return count;
  }

  double value(const Property& property, Type type) {
    if (format_ != Format::ascii) return value_of_bytes(property, type);
    const char* name = property.name.c_str();
    if (property.corners) return static_cast<double>(cursor_.integer<std::int64_t>(name));
    const double x = cursor_.real(name);
    return type == Type::float32 ? static_cast<float>(x) : x;
  }

  double value_of_bytes(const Property& property, Type type) {
    need(1, property, type);
    std::array<char, 8> bytes{};
    const std::size_t size = bytes_of(type);
    std::memcpy(bytes.data(), cursor_.position(), size);
    cursor_.seek(cursor_.position() + size);
    const auto order = format_ == Format::big_endian ? std::endian::big : std::endian::little;
    if (order != std::endian::native) std::reverse(bytes.begin(), bytes.begin() + size);
    const auto as = [&]<class Value>(Value number) {
      std::memcpy(&number, bytes.data(), sizeof number);
      return static_cast<double>(number);
    };
    switch (type) {
      case Type::int8:
        return as(std::int8_t{});
      case Type::uint8:
        return as(std::uint8_t{});
      case Type::int16:
        return as(std::int16_t{});
      case Type::uint16:
        return as(std::uint16_t{});
      case Type::int32:
        return as(std::int32_t{});
      case Type::uint32:
        return as(std::uint32_t{});
      case Type::float32:
        return as(float{});
      case Type::float64:
        return as(double{});
    }
    return 0;
  }

  void add_corner(double corner) {
    if (corner < 0 || corner >= static_cast<double>(points_)) {
      const std::string what = "a face uses point " +
                               std::to_string(saturate<std::int64_t>(corner)) + ", but the " +
                               grouped(points_) + " points are numbered from 0";
      if (format_ == Format::ascii) cursor_.fail(what);
      file_.fail_at_byte(cursor_.position(), what);
    }
    soup_.corners.push_back(static_cast<Index>(corner));
  }

  // Fails unless the file has so many values more.
  void need(std::uint64_t count, const Property& property, Type type) const {
    if (count > cursor_.bytes_left() / bytes_of(type))
      file_.fail_at_byte(cursor_.position(),
                         "the file ends where " + property.name +
                             " is expected: it is truncated or a count in it is wrong");
  }

  const FileText& file_;
  TextCursor cursor_;
  const char* line_ = nullptr;
  Format format_ = Format::ascii;
  std::vector<Element> elements_;
  std::uint64_t points_ = 0;  ///< in the whole file
  PolygonSoup soup_;
};

}  // namespace

PolygonSoup read_ply(const FileText& file) { return PlyReader(file).run(); }

}  // namespace suture
