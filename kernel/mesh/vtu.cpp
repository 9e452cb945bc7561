// SPDX-License-Identifier: GPL-3.0-or-later
//
// VTK's XML files, read by VTK behind its module. Its reader believes the counts
// of a file and takes some truncated ones for whole, so both are checked here.
#include <algorithm>

#include "kernel/base/error.hpp"
#include "kernel/mesh/readers.hpp"
#include "kernel/mesh/vtk_mesh.hpp"
#include "kernel/vtk/vtk_module.hpp"

namespace suture {
namespace {

// The value of name="value" at or after `from`; moves `from` behind it.
std::string_view attribute(std::string_view text, std::string_view name, std::size_t& from) {
  const std::string key = std::string(1, ' ').append(name).append("=\"");
  const std::size_t begin = text.find(key, from);
  if (begin == text.npos) return {};
  const std::size_t end = text.find('"', begin + key.size());
  if (end == text.npos) return {};
  from = end;
  return text.substr(begin + key.size(), end - begin - key.size());
}

void check_type(const FileText& file, std::string_view xml) {
  std::size_t at = xml.find("<VTKFile");
  if (at == xml.npos) file.fail_at_line(file.begin(), "there is no element <VTKFile>");
  const std::size_t start = at;
  const std::string_view type = attribute(xml, "type", at);
  if (type != "UnstructuredGrid") {
    file.fail_at_line(file.begin() + start, "the data set is " + in_quotes(type) +
                                                "; an UnstructuredGrid with hexahedra is needed");
  }
  const std::string_view whole = file.view();
  if (whole.substr(whole.size() - std::min<std::size_t>(whole.size(), 256)).find("</VTKFile>") ==
      whole.npos) {
    file.fail_at_byte(file.end(), "the file does not end with </VTKFile>: it is truncated");
  }
}

// Sum of a count over the pieces. 24 bytes of a point compress to 1/1,032 at best.
std::uint64_t declared(const FileText& file, std::string_view xml, std::string_view name) {
  std::uint64_t sum = 0;
  for (std::size_t at = 0;;) {
    const std::string_view word = attribute(xml, name, at);
    if (word.empty()) return sum;
    std::uint64_t count = 0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), count);
    if (error != std::errc{} || stop != word.data() + word.size() ||
        count > 50 * file.view().size()) {
      file.fail_at_line(word.data(), std::string(name) + " is " + in_quotes(word) +
                                         ", which a file of " + grouped(file.view().size()) +
                                         " bytes cannot hold");
    }
    sum += count;
  }
}

}  // namespace

Mesh read_vtu(const FileText& file, Diagnostics& diagnostics) {
  const std::string_view xml = file.view().substr(0, file.view().find("<AppendedData"));
  check_type(file, xml);
  const std::uint64_t points = declared(file, xml, "NumberOfPoints");
  const std::uint64_t cells = declared(file, xml, "NumberOfCells");
  VtkGrid grid;
  const std::string error = vtk_module().read_vtu(file.name(), grid);
  if (!error.empty()) throw InputError(file.name() + ": " + error);
  if (grid.points.size() != points || grid.types.size() != cells) {
    throw InputError(file.name() + ": " + grouped(points) + " points and " + grouped(cells) +
                     " cells are announced, " + grouped(grid.points.size()) + " and " +
                     grouped(grid.types.size()) + " could be read: the file is damaged");
  }
  return mesh_from_vtk(std::move(grid), file, diagnostics);
}

}  // namespace suture
