// SPDX-License-Identifier: GPL-3.0-or-later
//
// v 0.05 -1 1        <- a point: three numbers; a weight or a colour may follow
// f 1 2/7 -1//3      <- a face: points from 1, or back from the last so far, before each '/'
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include "kernel/base/nearest.hpp"
#include "kernel/geometry/surface_readers.hpp"

namespace suture {
namespace {

// Words that may begin a line; lines other than vertices and polygons are skipped.
const std::vector<std::string> obj_keys{
    "v",          "f",         "l",      "vt",       "vn",     "vp",       "o",      "g",
    "s",          "p",         "bevel",  "lod",      "ctech",  "stech",    "usemap", "usemtl",
    "mtllib",     "c_interp",  "cstype", "deg",      "step",   "d_interp", "bmat",   "con",
    "shadow_obj", "trace_obj", "curv",   "curv2",    "surf",   "parm",     "trim",   "hole",
    "scrv",       "sp",        "end",    "bsp",      "bzp",    "cdc",      "cdp",    "res",
    "surf_1",     "q0_1",      "q1_1",   "curv2d_1", "surf_2", "q0_2",     "q1_2",   "curv2d_2"};

class ObjReader {
 public:
  explicit ObjReader(const FileText& file) : file_(file), at_(file.begin()) {}

  PolygonSoup run() {
    while (at_ != file_.end()) {
      next_line();
      if (words_.empty()) continue;
      const std::string_view key = words_[0];
      if (key == "v")
        add_point();
      else if (key == "f")
        add_face();
      else if (std::ranges::find(obj_keys, key) == obj_keys.end())
        fail(key, "not a valid .obj line: " + in_quotes(key) + " is not a keyword of the format" +
                      did_you_mean(key, obj_keys));
    }
    if (last_ > points()) fail_corner(last_at_, last_);
    return std::move(soup_);
  }

 private:
  // The words up to the end of the line, or of one that a '\' at its end carries on.
  void next_line() {
    words_.clear();
    bool comment = false;
    while ((at_ = behind_break(at_)) != file_.end()) {
      const char c = *at_;
      comment |= c == '#';
      if (c == '\n') {
        ++at_;
        return;
      }
      if (comment || is_space(c)) {
        ++at_;
        continue;
      }
      const char* word = at_;
      while (at_ != file_.end() && !is_space(*at_) && *at_ != '\n' && *at_ != '#' &&
             behind_break(at_) == at_)
        ++at_;
      words_.emplace_back(word, at_ - word);
    }
  }

  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }

  // Behind '\' and the end of a line.
  const char* behind_break(const char* p) const {
    while (p != file_.end() && *p == '\\') {
      const char* end = p + 1;
      if (end != file_.end() && *end == '\r') ++end;
      if (end == file_.end() || *end != '\n') break;
      p = end + 1;
    }
    return p;
  }

  void add_point() {
    Vec3& point = soup_.points.emplace_back();
    for (std::size_t i = 1; i < 4; ++i) {
      if (i == words_.size())
        fail(words_[0], "a point needs three numbers, found " + std::to_string(i - 1));
      point[i - 1] = number(words_[i]);
    }
  }

  double number(std::string_view word) const {
    const char* end = word.data() + word.size();
    double value = 0;
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    if (error == std::errc{} && stop == end && std::isfinite(value)) return value;
    // "+1", hexadecimals, and what is too small, which is 0.
    const std::string text(word);
    char* last = nullptr;
    value = std::strtod(text.c_str(), &last);
    if (last != text.c_str() + text.size() || !std::isfinite(value))
      fail(word, "expected a finite number, found " + in_quotes(word));
    return value;
  }

  void add_face() {
    for (std::size_t i = 1; i < words_.size(); ++i) {
      const std::string_view word = words_[i].substr(0, words_[i].find('/'));
      std::int64_t point = 0;
      const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), point);
      if (error != std::errc{} || stop != word.data() + word.size())
        fail(words_[i], "expected the number of a point, found " + in_quotes(words_[i]));
      if (point < -points() || point == 0 || point > none) fail_corner(words_[i], point);
      if (point > last_) {  // the points may come later
        last_ = point;
        last_at_ = words_[i];
      }
      soup_.corners.push_back(static_cast<Index>(point > 0 ? point - 1 : points() + point));
    }
    soup_.offsets.push_back(static_cast<Index>(soup_.corners.size()));
  }

  std::int64_t points() const { return static_cast<std::int64_t>(soup_.points.size()); }

  [[noreturn]] void fail_corner(std::string_view at, std::int64_t point) const {
    fail(at, "a face uses point " + std::to_string(point) + ", but the " +
                 grouped(soup_.points.size()) + " points" + (at_ == file_.end() ? "" : " so far") +
                 " are numbered from 1");
  }

  [[noreturn]] void fail(std::string_view at, const std::string& what) const {
    file_.fail_at_line(at.data(), what);
  }

  const FileText& file_;
  const char* at_;
  std::vector<std::string_view> words_;
  std::int64_t last_ = 0;  ///< largest number of a corner
  std::string_view last_at_;
  PolygonSoup soup_;
};

}  // namespace

PolygonSoup read_obj(const FileText& file) { return ObjReader(file).run(); }

}  // namespace suture
