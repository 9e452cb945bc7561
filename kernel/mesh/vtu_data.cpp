// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layout: "VTK XML Formats" of the VTK wiki, and vtkXMLDataParser.cxx for what it
// leaves open. An array is [bytes][data], or compressed
// [blocks][block size][last block size][size of each compressed block ...][data];
// as base64 the header of compressed data is encoded by itself.
#include "kernel/mesh/vtu_data.hpp"

#include <algorithm>
#include <array>
#include <cstring>

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
      file_.fail_at_line(array.tag.at, "there are no appended data: the file is truncated");
    if (offset > static_cast<std::uint64_t>(encoding.appended_end - encoding.appended)) {
      file_.fail_at_line(array.tag.at,
                         "offset " + in_quotes(word) + " is behind the end of the data");
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
    if (bytes.size() < n) fail("an array is cut off: the file is truncated or damaged");
    return bytes;
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

Bytes plain_bytes(Stream& stream) {
  const std::uint64_t n = stream.header(stream.peek(stream.header_size()), 0);
  if (n > stream.room()) {
    stream.fail("an array of " + grouped(n) + " bytes is announced, " + grouped(stream.room()) +
                " are left: the file is truncated or damaged");
  }
  Bytes bytes = stream.take(stream.header_size() + n);
  bytes.erase(bytes.begin(), bytes.begin() + stream.header_size());
  return bytes;
}

// No compressor of VTK makes more of a byte: LZMA 7,000, zlib 1,032, LZ4 255.
constexpr std::uint64_t largest_ratio = 8192;

Bytes expanded_bytes(Stream& stream, VtuCompression compression) {
  const unsigned word = stream.header_size();
  const std::uint64_t blocks = stream.header(stream.peek(word), 0);
  if (blocks == 0) return {};
  if (blocks > stream.room() / word) stream.fail("the header of an array is damaged");
  const Bytes header = stream.take((3 + blocks) * word);
  const std::uint64_t size = stream.header(header, 1), last = stream.header(header, 2);
  const std::uint64_t limit = largest_ratio * (stream.room() + 64);
  if (size > limit || last > size || (blocks > 1 && size > limit / blocks)) {
    stream.fail("the header of an array asks for more memory than its data can expand to");
  }
  std::uint64_t packed = 0;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const std::uint64_t n = stream.header(header, 3 + b);
    if (n > stream.room()) stream.fail("a compressed block is longer than the file");
    packed += n;
  }
  const Bytes data = stream.take(packed);
  // last == 0: the last block is a whole one.
  const std::uint64_t last_size = last == 0 ? size : last;
  Bytes out((blocks - 1) * size + last_size);
  std::uint64_t from = 0;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const std::uint64_t n = stream.header(header, 3 + b);
    const std::span<const unsigned char> block(data.data() + from, n);
    const std::span<unsigned char> target(out.data() + b * size,
                                          b + 1 == blocks ? last_size : size);
    if (!vtk_module().expand(compression, block, target)) {
      stream.fail("compressed block " + std::to_string(b) +
                  " does not expand: the file is damaged");
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

template <class To>
std::vector<To> text_values(const FileText& file, const VtuDataArray& array) {
  TextCursor in(file, array.tag.end, array.text_end);
  std::vector<To> values;
  while (in.skip_space()) {
    if constexpr (std::is_same_v<To, double>)
      values.push_back(in.real("number of an array"));
    else
      values.push_back(in.integer<To>("number of an array"));
  }
  return values;
}

template <class To>
std::vector<To> values_of(const FileText& file, const VtuEncoding& encoding,
                          const VtuDataArray& array, std::optional<std::uint64_t> count) {
  std::vector<To> values;
  const std::string_view format = array.tag["format"];
  if (format == "ascii") {
    values = text_values<To>(file, array);
  } else if (format == "binary" || format == "appended") {
    Stream stream(file, encoding, array);
    Bytes bytes = encoding.compression == VtuCompression::raw
                      ? plain_bytes(stream)
                      : expanded_bytes(stream, encoding.compression);
    values = converted<To>(std::move(bytes), array.tag["type"], encoding.swap_bytes);
  } else {
    file.fail_at_line(array.tag.at, "format " + in_quotes(format) + " of an array is not known");
  }
  if (count && values.size() != *count) {
    file.fail_at_line(array.tag.at, "array " + in_quotes(array.tag["Name"]) + " has " +
                                        grouped(values.size()) + " numbers where " +
                                        grouped(*count) +
                                        " are needed: the file is truncated or damaged");
  }
  return values;
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

std::vector<std::int64_t> vtu_integers(const FileText& file, const VtuEncoding& encoding,
                                       const VtuDataArray& array,
                                       std::optional<std::uint64_t> count) {
  if (!vtu_is_integer(array)) {
    file.fail_at_line(array.tag.at, "array " + in_quotes(array.tag["Name"]) +
                                        " must be of integers, is " + in_quotes(array.tag["type"]));
  }
  return values_of<std::int64_t>(file, encoding, array, count);
}

std::vector<double> vtu_reals(const FileText& file, const VtuEncoding& encoding,
                              const VtuDataArray& array, std::uint64_t count) {
  if (!type_of(array)) {
    file.fail_at_line(array.tag.at,
                      "type " + in_quotes(array.tag["type"]) + " of an array is not known");
  }
  return values_of<double>(file, encoding, array, count);
}

}  // namespace suture
