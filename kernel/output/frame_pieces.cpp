// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/frame_pieces.hpp"

#include <algorithm>
#include <utility>

#include "kernel/output/frame_file.hpp"
#include "kernel/vtk/xml_attribute.hpp"

namespace suture {
namespace {

/// Piece `number` of `size` things: [begin, end).
struct PieceRange {
  std::size_t begin, end;
  PieceRange(std::size_t size, std::size_t number, std::size_t count)
      : begin(size * std::min(number, count) / count),
        end(size * std::min(number + 1, count) / count) {}
};

/// What is in a range of the list that begins with `before` other cells.
template <class Cell>
std::vector<Cell> cells_in(const std::vector<Cell>& cells, std::size_t before,
                           const PieceRange& range) {
  const auto at = [&](std::size_t place) {
    const std::size_t here = std::clamp(place, before, before + cells.size()) - before;
    return cells.begin() + static_cast<std::ptrdiff_t>(here);
  };
  return {at(range.begin), at(range.end)};
}

template <class Cells, class Visit>
void visit_corners(Cells& cells, Visit visit) {
  for (auto& cell : cells)
    for (auto& corner : cell)
      if (corner != none) visit(corner);
}

template <class AFrame, class Visit>
void visit_all_corners(AFrame& frame, Visit visit) {
  visit_corners(frame.hexahedra, visit);
  visit_corners(frame.tetrahedra, visit);
  visit_corners(frame.cells, visit);
}

template <class Value>
std::vector<Value> rows_at(const std::vector<Value>& all, std::span<const std::size_t> rows,
                           std::size_t width) {
  std::vector<Value> result;
  if (all.empty()) return result;
  result.reserve(rows.size() * width);
  for (const std::size_t row : rows) {
    const auto from = all.begin() + static_cast<std::ptrdiff_t>(row * width);
    result.insert(result.end(), from, from + static_cast<std::ptrdiff_t>(width));
  }
  return result;
}

std::vector<FrameField> fields_at(const std::vector<FrameField>& fields,
                                  std::span<const std::size_t> rows) {
  std::vector<FrameField> result;
  for (const FrameField& field : fields) {
    const auto width = static_cast<std::size_t>(field.components);
    result.push_back({field.name, field.components, rows_at(field.values, rows, width),
                      rows_at(field.ids, rows, width), field.global_ids, field.principal});
  }
  return result;
}

std::string array_line(const FrameField& field, bool is_integer) {
  std::string line = std::string("      <PDataArray type=\"") + (is_integer ? "Int64" : "Float64") +
                     "\" Name=\"" + in_attribute(field.name) + "\" NumberOfComponents=\"" +
                     std::to_string(field.components) + '"';
  const auto names = names_of_components(field);
  for (std::size_t c = 0; c < names.size(); ++c)
    line += " ComponentName" + std::to_string(c) + "=\"" + names[c] + '"';
  return line + "/>\n";
}

std::string lines_of_section(const std::string& name, std::span<const FrameField> fields,
                             std::size_t rows, std::string lines = "") {
  std::string text = "    <" + name;
  for (const FrameField& field : fields) {
    if (field.global_ids) text += " GlobalIds=\"" + in_attribute(field.name) + '"';
    lines += array_line(field, rows > 0 && field.values.empty());
  }
  return text + ">\n" + lines + "    </" + name + ">\n";
}

/// Value by value of the rows of a piece, at their places in the frame.
template <class Value>
void put(std::vector<Value>& all, const std::vector<Value>& rows,
         std::span<const std::int64_t> places, std::size_t points, std::size_t width) {
  if (rows.empty()) return;
  all.resize(points * width);
  for (std::size_t i = 0; i < places.size(); ++i)
    std::copy_n(rows.begin() + static_cast<std::ptrdiff_t>(i * width), width,
                all.begin() + places[i] * static_cast<std::ptrdiff_t>(width));
}

template <class Value>
void append(std::vector<Value>& all, const std::vector<Value>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

std::size_t count_pieces(std::size_t cells, unsigned processes) {
  return std::clamp<std::size_t>(cells, 1, processes);
}

Frame piece_of(const Frame& frame, std::size_t number, std::size_t count) {
  const std::size_t hexahedra = frame.hexahedra.size();
  const PieceRange range(cell_count(frame), number, count);
  Frame piece;
  piece.number = frame.number;
  piece.time = frame.time;
  piece.is_surface = frame.is_surface;
  piece.field_data_provenance = frame.field_data_provenance;
  if (frame.cells.empty()) {
    piece.hexahedra = cells_in(frame.hexahedra, 0, range);
    piece.tetrahedra = cells_in(frame.tetrahedra, hexahedra, range);
  } else {
    piece.cells = cells_in(frame.cells, 0, range);
  }

  std::vector<bool> is_used(frame.points.size(), number == 0);
  if (number == 0) visit_all_corners(frame, [&](Index corner) { is_used[corner] = false; });
  visit_all_corners(piece, [&](Index corner) { is_used[corner] = true; });
  std::vector<std::size_t> points, cells;
  std::vector<Index> place(frame.points.size());
  for (std::size_t v = 0; v < frame.points.size(); ++v) {
    if (!is_used[v]) continue;
    place[v] = static_cast<Index>(points.size());
    points.push_back(v);
  }
  visit_all_corners(piece, [&](Index& corner) { corner = place[corner]; });
  for (std::size_t c = range.begin; c < range.end; ++c) cells.push_back(c);
  piece.points = rows_at(frame.points, points, 1);
  piece.point_fields = fields_at(frame.point_fields, points);
  piece.cell_fields = fields_at(frame.cell_fields, cells);
  make_piece(piece, {points.begin(), points.end()}, count);
  return piece;
}

void make_piece(Frame& frame, std::vector<std::int64_t> points, std::size_t count) {
  FrameField& numbers = frame.point_fields.emplace_back();
  numbers.name = point_in_frame;
  numbers.ids = std::move(points);
  frame.pieces = count;
}

void add_piece(Frame& frame, Frame piece) {
  const std::vector<std::int64_t> places = std::move(piece.point_fields.back().ids);
  piece.point_fields.pop_back();
  visit_all_corners(piece, [&](Index& corner) { corner = static_cast<Index>(places[corner]); });
  std::size_t points = frame.points.size();
  for (const std::int64_t place : places)
    points = std::max(points, static_cast<std::size_t>(place) + 1);
  if (frame.points.empty()) {
    const auto header = [](const std::vector<FrameField>& fields) { return fields_at(fields, {}); };
    frame.number = piece.number;
    frame.time = piece.time;
    frame.is_surface = piece.is_surface;
    frame.field_data_provenance = piece.field_data_provenance;
    frame.point_fields = header(piece.point_fields);
    frame.cell_fields = header(piece.cell_fields);
  }
  put(frame.points, piece.points, places, points, 1);
  for (std::size_t i = 0; i < frame.point_fields.size(); ++i) {
    FrameField& all = frame.point_fields[i];
    const auto width = static_cast<std::size_t>(all.components);
    put(all.values, piece.point_fields[i].values, places, points, width);
    put(all.ids, piece.point_fields[i].ids, places, points, width);
  }
  append(frame.hexahedra, piece.hexahedra);
  append(frame.tetrahedra, piece.tetrahedra);
  append(frame.cells, piece.cells);
  for (std::size_t i = 0; i < frame.cell_fields.size(); ++i) {
    append(frame.cell_fields[i].values, piece.cell_fields[i].values);
    append(frame.cell_fields[i].ids, piece.cell_fields[i].ids);
  }
}

std::string list_of_pieces(const Frame& piece, std::span<const std::string> files) {
  const std::string type = piece.is_surface ? "PPolyData" : "PUnstructuredGrid";
  const std::span fields(piece.point_fields);
  std::string text =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"" +
      type +
      "\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "  <" +
      type + " GhostLevel=\"0\">\n" +
      lines_of_section("PPointData", fields.first(fields.size() - 1), piece.points.size(),
                       array_line({point_in_frame}, true)) +
      lines_of_section("PCellData", piece.cell_fields, cell_count(piece)) +
      "    <PPoints>\n"
      "      <PDataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"/>\n"
      "    </PPoints>\n";
  for (const std::string& file : files) text += "    <Piece Source=\"" + file + "\"/>\n";
  return text + "  </" + type + ">\n</VTKFile>\n";
}

std::vector<std::string> pieces_in(std::string_view text) {
  constexpr std::string_view key = "<Piece Source=\"";
  std::vector<std::string> files;
  for (std::size_t at = 0; (at = text.find(key, at)) != text.npos;) {
    at += key.size();
    files.emplace_back(text.substr(at, text.find('"', at) - at));
  }
  return files;
}

}  // namespace suture
