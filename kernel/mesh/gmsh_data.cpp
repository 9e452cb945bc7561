// SPDX-License-Identifier: GPL-3.0-or-later
//
// $NodeData and $ElementData of Gmsh's formats 2 and 4.1: manual 4.11, section 10.1. The tags in
// front of the values are text in binary files, too.
#include <algorithm>

#include "kernel/mesh/gmsh_scanner.hpp"

namespace suture {
namespace {

std::uint64_t number_of_tags(GmshScanner& in, const char* what) {
  const auto count = in.text.integer<std::uint64_t>(what);
  in.text.require_room(count, 1, what);
  return count;
}

/// A name in quotes, which may hold spaces.
std::string quoted_name(GmshScanner& in) {
  if (!in.text.skip_space()) in.fail("the name of the data is missing: the file is truncated");
  const std::string_view line = in.text.skip_line();
  const std::size_t open = line.find('"'), close = line.rfind('"');
  if (open == line.npos || close == open) in.fail("the name of the data is not in quotes");
  return std::string(line.substr(open + 1, close - open - 1));
}

}  // namespace

GmshData read_gmsh_data_header(GmshScanner& in, bool of_elements) {
  GmshData data;
  data.array.of_elements = of_elements;
  const std::uint64_t names = number_of_tags(in, "number of names of the data");
  for (std::uint64_t i = 0; i < names; ++i) {
    const std::string name = quoted_name(in);
    if (i == 0) data.array.name = name;
  }
  const std::uint64_t reals = number_of_tags(in, "number of real tags of the data");
  for (std::uint64_t i = 0; i < reals; ++i) in.text.any_real("real tag of the data");
  const std::uint64_t integers = number_of_tags(in, "number of integer tags of the data");
  std::uint64_t shape[3] = {0, 1, 0};  // time step, components, entries
  for (std::uint64_t i = 0; i < integers; ++i) {
    const auto tag = in.text.integer<std::int64_t>("integer tag of the data");
    if (i < 3) shape[i] = static_cast<std::uint64_t>(std::max<std::int64_t>(tag, 0));
  }
  if (shape[1] < 1 || shape[1] > 9)
    in.fail("the data have " + std::to_string(shape[1]) + " components; expected 1, 3 or 9");
  data.array.components = shape[1];
  data.count = shape[2];
  return data;
}

void read_gmsh_data(GmshScanner& in, GmshData& data) {
  const std::size_t n = data.array.components;
  if (in.binary) in.end_of_line();
  in.require_room(data.count, 1 + n, 4 + 8 * n, "values of the data");
  data.tags.reserve(data.count);
  data.array.values.reserve(n * data.count);
  for (std::uint64_t i = 0; i < data.count; ++i) {
    const std::int64_t tag =
        in.binary ? in.int32("tag of a value") : in.text.integer<std::int64_t>("tag of a value");
    if (tag < 0) in.fail("a value has the tag " + std::to_string(tag));
    data.tags.push_back(static_cast<std::uint64_t>(tag));
    for (std::size_t c = 0; c < n; ++c) data.array.values.push_back(in.any_real("a value"));
  }
}

}  // namespace suture
