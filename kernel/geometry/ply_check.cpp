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
#include <charconv>
#include <sstream>
#include <vector>

#include "kernel/base/nearest.hpp"
#include "kernel/geometry/surface_check.hpp"

namespace suture {
namespace {

enum class Format { ascii, little_endian, big_endian };

struct Property {
  std::string name;
  std::size_t bytes = 0;        ///< of a value
  std::size_t count_bytes = 0;  ///< of a list's count; 0: no list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

constexpr std::array<std::size_t, 16> bytes_of_types{1, 1, 1, 1, 2, 2, 2, 2,
                                                     4, 4, 4, 4, 4, 4, 8, 8};
constexpr std::size_t integer_types = 12;

class PlyCheck {
 public:
  explicit PlyCheck(const FileText& file) : file_(file), cursor_(file) {}

  void run() {
    read_format();
    while (read_line()) {
    }
    for (const Element& element : elements_) {
      if (element.name == "vertex" || element.name == "vertices") points_ += element.count;
    }
    for (const Element& element : elements_) walk(element);
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
    if (next_line() != std::vector<std::string>{"ply"})
      fail("expected 'ply', the first line of such a file");
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
      fail(in_quotes(key) + " begins no line of a header" + did_you_mean(key, keys) +
           "; one of comment, element, end_header, obj_info, property");
    }
    return true;
  }

  void add_element(const std::vector<std::string>& words) {
    Element element;
    if (words.size() != 3) fail("expected 'element', its name and how many there are");
    element.name = words[1];
    const char* end = words[2].data() + words[2].size();
    const auto [stop, error] = std::from_chars(words[2].data(), end, element.count);
    if (error != std::errc{} || stop != end)
      fail(in_quotes(words[2]) + " is no number of elements " + in_quotes(element.name));
    elements_.push_back(std::move(element));
  }

  void add_property(const std::vector<std::string>& words) {
    const bool list = words.size() > 1 && words[1] == "list";
    if (words.size() != (list ? 5U : 3U))
      fail("expected 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
    if (elements_.empty())
      fail("a property before the first 'element': nothing has it; is a line before misspelled?");
    Property property;
    property.name = words.back();
    property.bytes = bytes_of_types[type(words[words.size() - 2])];
    if (list) {
      const std::size_t counted = type(words[2]);
      if (counted >= integer_types) fail("a list is counted in integers, not in " + words[2]);
      property.count_bytes = bytes_of_types[counted];
    }
    elements_.back().properties.push_back(std::move(property));
  }

  std::size_t type(const std::string& word) const {
    static const std::vector<std::string> types{
        "char", "int8",  "uchar", "uint8",  "short", "int16",   "ushort", "uint16",
        "int",  "int32", "uint",  "uint32", "float", "float32", "double", "float64"};
    const auto known = std::ranges::find(types, word);
    if (known == types.end())
      fail(in_quotes(word) + " is no type of a property" + did_you_mean(word, types));
    return known - types.begin();
  }

  // Every property takes a byte at least, so what is walked is bounded by the file.
  void walk(const Element& element) {
    if (element.count == 0) return;
    if (element.properties.empty())
      fail("the element " + in_quotes(element.name) + " has no property");
    const bool text = format_ == Format::ascii;
    if (text)
      cursor_.require_room(element.count, element.properties.size(),
                           ("elements " + in_quotes(element.name)).c_str());
    for (std::uint64_t i = 0; i < element.count; ++i)
      for (const Property& property : element.properties)
        text ? pass_words(property) : pass_bytes(property);
  }

  void pass_words(const Property& property) {
    const char* name = property.name.c_str();
    if (property.count_bytes == 0) {
      cursor_.real(name);
      return;
    }
    const bool corners = property.name == "vertex_indices" || property.name == "vertex_index";
    const auto count = cursor_.integer<std::uint64_t>(name);
    if (count != 0) cursor_.require_room(count, 1, name);
    for (std::uint64_t i = 0; i < count; ++i) {
      if (!corners) {
        cursor_.real(name);
        continue;
      }
      const auto point = cursor_.integer<std::int64_t>(name);
      if (point < 0 || static_cast<std::uint64_t>(point) >= points_)
        cursor_.fail("a face has the point " + std::to_string(point) + "; the " + grouped(points_) +
                     " points are numbered from 0");
    }
  }

  void pass_bytes(const Property& property) {
    if (property.count_bytes == 0) return pass(1, property);
    const char* bytes = cursor_.position();
    pass(1, {property.name, property.count_bytes, 0});
    std::uint64_t count = 0;  // the most significant byte first
    for (std::size_t b = 0; b < property.count_bytes; ++b) {
      const std::size_t at = format_ == Format::big_endian ? b : property.count_bytes - 1 - b;
      count = count << 8 | static_cast<unsigned char>(bytes[at]);
    }
    pass(count, property);
  }

  void pass(std::uint64_t count, const Property& property) {
    if (count > cursor_.bytes_left() / property.bytes)
      file_.fail_at_byte(cursor_.position(),
                         "the file ends where " + property.name +
                             " is expected: it is truncated or a count in it is wrong");
    cursor_.seek(cursor_.position() + count * property.bytes);
  }

  const FileText& file_;
  TextCursor cursor_;
  const char* line_ = nullptr;
  Format format_ = Format::ascii;
  std::vector<Element> elements_;
  std::uint64_t points_ = 0;
};

}  // namespace

void check_ply(const FileText& file) { PlyCheck(file).run(); }

}  // namespace suture
