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

#include "kernel/geometry/surface_check.hpp"

namespace suture {
namespace {

using Words = std::vector<std::string_view>;

Words words_of(std::string_view line) {
  line = line.substr(0, line.find('#'));
  Words words;
  for (std::size_t at = 0; (at = line.find_first_not_of(" \r", at)) != line.npos;) {
    const std::size_t end = std::min(line.find_first_of(" \r", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

bool is_finite_number(std::string_view word) {
  const std::string text(word);
  char* end = nullptr;
  return std::isfinite(std::strtod(text.c_str(), &end)) && end == text.c_str() + text.size();
}

class ObjCheck {
 public:
  explicit ObjCheck(const FileText& file) : file_(file), text_(file.view()) {}

  std::string run() {
    join_lines();
    for_each_line("v", [&](std::size_t at, const Words& words) { check_point(at, words); });
    const std::int64_t total = std::exchange(points_, 0);
    for_each_line("", [&](std::size_t at, const Words& words) {
      if (words[0] == "v") ++points_;
      if (words[0] == "f") check_face(at, words, total);
      if (words[0] == "l") std::fill_n(text_.begin() + at, line_.size(), ' ');
    });
    return std::move(text_);
  }

 private:
  // Tabs become spaces, and so does the end of a line that a '\' carries on.
  void join_lines() {
    std::ranges::replace(text_, '\t', ' ');
    for (std::size_t at = 0; (at = text_.find('\\', at)) != text_.npos; ++at) {
      const std::size_t end = at + 1 + (text_.compare(at + 1, 1, "\r") == 0 ? 1 : 0);
      if (text_.compare(end, 1, "\n") == 0) std::fill(&text_[at], &text_[end] + 1, ' ');
    }
  }

  // visit(where the line begins, its words), for the lines that begin with `key`, or all.
  template <class Visit>
  void for_each_line(std::string_view key, Visit visit) {
    for (std::size_t at = 0; at < text_.size(); at += line_.size() + 1) {
      line_ = std::string_view(text_).substr(at, text_.find('\n', at) - at);
      const Words words = words_of(line_);
      if (!words.empty() && (key.empty() || words[0] == key)) visit(at, words);
    }
  }

  void check_point(std::size_t at, const Words& words) {
    ++points_;
    for (std::size_t i = 1; i < 4; ++i) {
      if (i == words.size())
        fail(at, "a point has three numbers, here are " + std::to_string(i - 1));
      if (!is_finite_number(words[i]))
        fail(at, "expected a finite number, found " + in_quotes(words[i]));
    }
  }

  void check_face(std::size_t at, const Words& words, std::int64_t total) const {
    for (std::size_t i = 1; i < words.size(); ++i) {
      const std::string_view word = words[i].substr(0, words[i].find('/'));
      std::int64_t point = 0;
      const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), point);
      if (error != std::errc{} || stop != word.data() + word.size())
        fail(at, "expected the number of a point, found " + in_quotes(words[i]));
      if (point < -points_ || point == 0 || point > total)
        fail(at, "a face has the point " + std::to_string(point) + "; the " + grouped(total) +
                     " points are numbered from 1");
    }
  }

  [[noreturn]] void fail(std::size_t at, const std::string& what) const {
    file_.fail_at_line(file_.begin() + at, what);
  }

  const FileText& file_;
  std::string text_;
  std::string_view line_;
  std::int64_t points_ = 0;
};

}  // namespace

std::string check_obj(const FileText& file) { return ObjCheck(file).run(); }

}  // namespace suture
