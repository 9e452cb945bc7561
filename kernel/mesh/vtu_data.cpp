// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layout: "VTK XML Formats" of the VTK wiki, and vtkXMLDataParser.cxx for what it
// leaves open. An array is [bytes][data], or compressed
// [blocks][block size][last block size][size of each compressed block ...][data];
// as base64 the header of compressed data is encoded by itself. Some programs encode the header of
// plain data by itself, too: the padding behind the header shows it.
#include "kernel/mesh/vtu_data.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

namespace suture {
namespace {

using Bytes = std::vector<unsigned char>;

struct TypeOf {
  std::string_view name;
  unsigned bytes;
  bool is_integer;
};
constexpr TypeOf types[] = {{"Int8", 1, true},    {"UInt8", 1, true},  {"Int16", 2, true},
                            {"UInt16", 2, true},  {"Int32", 4, true},  {"UInt32", 4, true},
                            {"Int64", 8, true},   {"UInt64", 8, true}, {"Float32", 4, false},
                            {"Float64", 8, false}};

const TypeOf* type_of(const VtuDataArray& array) {
  const std::string_view name = array.tag["type"];
  const auto* found = std::find_if(std::begin(types), std::end(types),
                                   [&](const TypeOf& t) { return t.name == name; });
  return found == std::end(types) ? nullptr : found;
}

std::array<int, 256> make_base64_values() {
  std::array<int, 256> values;
  values.fill(-1);
  const std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < digits.size(); ++i) {
    values[static_cast<unsigned char>(digits[i])] = static_cast<int>(i);
  }
  return values;
}

// Decodes from `p` as many whole groups as hold n bytes, and moves p behind them.
// Fewer bytes come back where the text ends, is no base64 or is padded before.
Bytes base64(const char*& p, const char* end, std::uint64_t n) {
  static const std::array<int, 256> values = make_base64_values();
  Bytes bytes;
  bytes.reserve(std::min<std::uint64_t>(n, static_cast<std::uint64_t>(end - p) / 4 * 3) + 3);
  while (bytes.size() < n && end - p >= 4) {
    std::uint32_t group = 0;
    int digits = 0;
    for (; digits < 4; ++digits) {
      const int value = values[static_cast<unsigned char>(p[digits])];
      if (value < 0) break;
      group = group << 6 | static_cast<std::uint32_t>(value);
    }
    if (digits < 4 && (digits < 2 || p[digits] != '=')) break;
    group <<= 6 * (4 - digits);
    for (int b = 0; b < digits - 1; ++b)
      bytes.push_back(static_cast<unsigned char>(group >> (16 - 8 * b)));
    p += 4;
    if (digits < 4) break;
  }
  if (bytes.size() > n) bytes.resize(n);
  return bytes;
}

// The encoded bytes of one array, taken piece by piece.
class Stream {
 public:
  Stream(const FileText& file, const VtuEncoding& encoding, const VtuDataArray& array)
      : file_(file), encoding_(encoding), base64_(true) {
    if (array.tag["format"] == "binary") {
      p_ = array.tag.end;
      end_ = array.text_end;
      while (p_ != end_ && static_cast<unsigned char>(*p_) <= ' ') ++p_;
      return;
    }
    std::uint64_t offset = 0;
    const std::string_view word = array.tag["offset"];
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), offset);
    if (word.empty() || error != std::errc{} || stop != word.data() + word.size()) {
      file_.fail_at_line(array.tag.at, "the array has no offset");
    }
    if (!encoding.appended)
      file_.fail_at_line(array.tag.at, "the appended data are missing: the file is truncated");
    if (offset > static_cast<std::uint64_t>(encoding.appended_end - encoding.appended)) {
      file_.fail_at_line(array.tag.at,
                         "offset " + in_quotes(word) + " is beyond the end of the data");
    }
    p_ = encoding.appended + offset;
    end_ = encoding.appended_end;
    base64_ = encoding.appended_base64;
  }

  // Bytes that can be left at most.
  std::uint64_t room() const { return static_cast<std::uint64_t>(end_ - p_); }

  // The next n bytes; base64 starts a new group.
  Bytes take(std::uint64_t n) {
    Bytes bytes;
    if (base64_) {
      bytes = base64(p_, end_, n);
    } else if (n <= room()) {
      bytes.assign(p_, p_ + n);
      p_ += n;
    }
    if (bytes.size() < n) fail("an array is incomplete: the file is truncated or damaged");
    return bytes;
  }
  // Whether a header of n bytes is encoded by itself, as base64 that ends with padding.
  bool is_apart(std::uint64_t n) const {
    const char* p = p_;
    return base64_ && base64(p, end_, n + 3).size() == n && p[-1] == '=';
  }
  // As take, without moving on.
  Bytes peek(std::uint64_t n) {
    const char* before = p_;
    Bytes bytes = take(n);
    p_ = before;
    return bytes;
  }
  [[noreturn]] void fail(const std::string& what) const { file_.fail_at_byte(p_, what); }

  std::uint64_t header(const Bytes& bytes, std::uint64_t index) const {
    const unsigned size = header_size();
    std::uint64_t value = 0;
    unsigned char number[8];
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(index * size), size, number);
    if (encoding_.swap_bytes) std::reverse(number, number + size);
    std::memcpy(&value, number, size);
    return value;
  }
  unsigned header_size() const { return encoding_.long_headers ? 8 : 4; }

 private:
  const FileText& file_;
  const VtuEncoding& encoding_;
  const char* p_ = nullptr;
  const char* end_ = nullptr;
  bool base64_;
};

/// What the header of an array says of its data.
struct Announced {
  std::uint64_t blocks = 0;          ///< 0: not compressed
  std::uint64_t size = 0, last = 0;  ///< of a block and of the last one, expanded
  std::uint64_t bytes = 0;           ///< of all, expanded
};

Announced plain_header(Stream& stream) {
  const std::uint64_t n = stream.header(stream.peek(stream.header_size()), 0);
  if (n > stream.room()) {
    stream.fail("an array of " + grouped(n) + " bytes is declared, but only " +
                grouped(stream.room()) + " remain: the file is truncated or damaged");
  }
  return {0, 0, 0, n};
}

// A last block of 0 bytes is a whole one.
Announced compressed_header(Stream& stream) {
  const unsigned word = stream.header_size();
  Announced said;
  said.blocks = stream.header(stream.peek(word), 0);
  if (said.blocks == 0) return said;
  if (said.blocks > stream.room() / word) stream.fail("the header of an array is damaged");
  const Bytes header = stream.peek(3 * word);
  said.size = stream.header(header, 1);
  const std::uint64_t last = stream.header(header, 2);
  if (last > said.size || said.size > std::numeric_limits<std::uint64_t>::max() / said.blocks)
    stream.fail("the header of an array is damaged");
  said.last = last == 0 ? said.size : last;
  said.bytes = (said.blocks - 1) * said.size + said.last;
  return said;
}

Bytes plain_bytes(Stream& stream, const Announced& said) {
  if (stream.is_apart(stream.header_size())) {
    stream.take(stream.header_size());
    return stream.take(said.bytes);
  }
  Bytes bytes = stream.take(stream.header_size() + said.bytes);
  bytes.erase(bytes.begin(), bytes.begin() + stream.header_size());
  return bytes;
}

Bytes expanded_bytes(Stream& stream, const Announced& said, VtuCompression compression) {
  if (said.blocks == 0) return {};
  const Bytes header = stream.take((3 + said.blocks) * stream.header_size());
  std::uint64_t packed = 0;
  for (std::uint64_t b = 0; b < said.blocks; ++b) {
    const std::uint64_t n = stream.header(header, 3 + b);
    if (n > stream.room()) stream.fail("a compressed block is longer than the file");
    packed += n;
  }
  const Bytes data = stream.take(packed);
  Bytes out(said.bytes);
  std::uint64_t from = 0;
  for (std::uint64_t b = 0; b < said.blocks; ++b) {
    const std::uint64_t n = stream.header(header, 3 + b);
    const std::span<const unsigned char> block(data.data() + from, n);
    const std::span<unsigned char> target(out.data() + b * said.size,
                                          b + 1 == said.blocks ? said.last : said.size);
    if (!vtk_module().expand(compression, block, target)) {
      stream.fail("compressed block " + std::to_string(b) +
                  " cannot be expanded: the file is damaged");
    }
    from += n;
  }
  return out;
}

template <class From, class To>
void convert(Bytes& bytes, bool swap, std::vector<To>& values) {
  const std::size_t n = bytes.size() / sizeof(From);
  values.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    unsigned char* at = bytes.data() + i * sizeof(From);
    if (swap) std::reverse(at, at + sizeof(From));
    From value;
    std::memcpy(&value, at, sizeof(From));
    values[i] = static_cast<To>(value);  // NOLINT(bugprone-signed-char-misuse): Int8 is a number
  }
}

template <class To>
std::vector<To> converted(Bytes bytes, std::string_view type, bool swap) {
  std::vector<To> values;
  if (type == "Int8") convert<std::int8_t>(bytes, swap, values);
  if (type == "UInt8") convert<std::uint8_t>(bytes, swap, values);
  if (type == "Int16") convert<std::int16_t>(bytes, swap, values);
  if (type == "UInt16") convert<std::uint16_t>(bytes, swap, values);
  if (type == "Int32") convert<std::int32_t>(bytes, swap, values);
  if (type == "UInt32") convert<std::uint32_t>(bytes, swap, values);
  if (type == "Int64") convert<std::int64_t>(bytes, swap, values);
  if (type == "UInt64") convert<std::uint64_t>(bytes, swap, values);
  if (type == "Float32") convert<float>(bytes, swap, values);
  if (type == "Float64") convert<double>(bytes, swap, values);
  return values;
}

enum class Numbers { finite, any };

template <class To>
std::vector<To> text_values(const FileText& file, const VtuDataArray& array, Numbers numbers) {
  TextCursor in(file, array.tag.end, array.text_end);
  std::vector<To> values;
  while (in.skip_space()) {
    if constexpr (std::is_same_v<To, double>)
      values.push_back(numbers == Numbers::any ? in.any_real("number of an array")
                                               : in.real("number of an array"));
    else
      values.push_back(in.integer<To>("number of an array"));
  }
  return values;
}

void check_number(const FileText& file, const VtuDataArray& array, std::uint64_t found,
                  std::uint64_t count) {
  if (found == count) return;
  file.fail_at_line(array.tag.at, "array " + in_quotes(array.tag["Name"]) + " has " +
                                      grouped(found) + " numbers, expected " + grouped(count) +
                                      ": the file is truncated or damaged");
}

// A file of a few bytes can announce, and even expand to, more than there is memory.
template <class To>
void take_memory(const FileText& file, VtuEncoding& encoding, const VtuDataArray& array,
                 std::uint64_t count) {
  if (count > encoding.memory_left / sizeof(To)) {
    file.fail_at_line(array.tag.at,
                      "array " + in_quotes(array.tag["Name"]) + " declares " + grouped(count) +
                          " numbers, more than expected for a file of " +
                          grouped(file.view().size()) +
                          " bytes; if this is correct, save the file without compression");
  }
  encoding.memory_left -= sizeof(To) * count;
}

template <class To>
std::vector<To> encoded_values(const FileText& file, VtuEncoding& encoding,
                               const VtuDataArray& array, std::uint64_t count) {
  Stream stream(file, encoding, array);
  const bool plain = encoding.compression == VtuCompression::raw;
  const Announced said = plain ? plain_header(stream) : compressed_header(stream);
  if (said.bytes % vtu_bytes(array) != 0) stream.fail("the header of an array is damaged");
  check_number(file, array, said.bytes / vtu_bytes(array), count);
  take_memory<To>(file, encoding, array, count);
  Bytes bytes =
      plain ? plain_bytes(stream, said) : expanded_bytes(stream, said, encoding.compression);
  return converted<To>(std::move(bytes), array.tag["type"], encoding.swap_bytes);
}

template <class To>
std::vector<To> values_of(const FileText& file, VtuEncoding& encoding, const VtuDataArray& array,
                          std::uint64_t count, Numbers numbers = Numbers::finite) {
  const std::string_view format = array.tag["format"];
  if (format == "binary" || format == "appended")
    return encoded_values<To>(file, encoding, array, count);
  if (format != "ascii")
    file.fail_at_line(array.tag.at, "format " + in_quotes(format) + " of an array is unknown");
  std::vector<To> values = text_values<To>(file, array, numbers);
  check_number(file, array, values.size(), count);
  return values;
}

[[noreturn]] void fail_type(const FileText& file, const VtuDataArray& array) {
  file.fail_at_line(array.tag.at,
                    "type " + in_quotes(array.tag["type"]) + " of an array is unknown");
}

}  // namespace

bool vtu_is_integer(const VtuDataArray& array) {
  const TypeOf* type = type_of(array);
  return type && type->is_integer;
}

unsigned vtu_bytes(const VtuDataArray& array) {
  const TypeOf* type = type_of(array);
  return type ? type->bytes : 0;
}

void vtu_check_type(const FileText& file, const VtuDataArray& array) {
  const std::string_view name = array.tag["type"];
  if (!type_of(array) && name != "String" && name != "Bit" && name != "Variant")
    fail_type(file, array);
}

std::vector<std::int64_t> vtu_integers(const FileText& file, VtuEncoding& encoding,
                                       const VtuDataArray& array, std::uint64_t count) {
  if (!vtu_is_integer(array)) {
    file.fail_at_line(array.tag.at, "array " + in_quotes(array.tag["Name"]) +
                                        " must have an integer type, has " +
                                        in_quotes(array.tag["type"]));
  }
  return values_of<std::int64_t>(file, encoding, array, count);
}

std::vector<double> vtu_reals(const FileText& file, VtuEncoding& encoding,
                              const VtuDataArray& array, std::uint64_t count) {
  if (!type_of(array)) fail_type(file, array);
  return values_of<double>(file, encoding, array, count);
}

std::vector<double> vtu_numbers(const FileText& file, VtuEncoding& encoding,
                                const VtuDataArray& array, std::uint64_t count) {
  if (!type_of(array)) fail_type(file, array);
  return values_of<double>(file, encoding, array, count, Numbers::any);
}

}  // namespace suture
