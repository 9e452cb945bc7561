// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/swept_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "kernel/base/archive.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/rows.hpp"
#include "kernel/geometry/cube_size.hpp"
#include "kernel/parts/embedding.hpp"

namespace suture {
namespace {

// The distances between points of the edge, and between rows of the sheet; in elements.
constexpr double between_points = 0.5, between_rows = 0.25;
// Points of an edge, and of all rows that it passes in a step.
constexpr double most_points = 1e5, most_traced = 1e7;
// How many rows are waited for before the body is cut along them.
constexpr std::size_t rows_per_cut = 2;
// The corners of an element that is divided are so near to the new rows, behind which the opening
// lags, and so near to the sheet; in elements.
constexpr double seen_within = 2, near_sheet = 2;
// Points of a row that are near each other.
constexpr std::size_t points_per_box = 5;
// How much of the sheet is kept behind the edge, and how far the edge goes on outside the tissue
// before its sheet ends; in elements.
constexpr double kept_behind = 3, kept_outside = 2;
// Around the edge, in elements.
constexpr double searched = 2;
// In another stroke, of an element: what is nearer to an earlier sheet is on it.
constexpr double on_earlier = 0.15;
// All strokes divide an element by one slit, and another one that begins in it or crosses it.
// Tissue that trembles at an edge would be shredded without a limit.
constexpr unsigned most_divisions = 2;
constexpr double no_height = std::numeric_limits<double>::quiet_NaN();

/// The farthest that a point has moved.
double way(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  double farthest = 0;
  for (std::size_t i = 0; i < to.size(); ++i)
    farthest = std::max(farthest, norm(minus(to[i], from[i])));
  return farthest;
}

}  // namespace

SweptSheet::SweptSheet(const CellComplex& complex, Attributes& attributes,
                       const std::vector<Vec3>& edge)
    : complex_(complex),
      attributes_(attributes),
      finder_(complex, attributes),
      size_(longest_edge(complex, attributes.rest().rows(), 4)),
      kept_(complex.count(0), no_height),
      stroke_of_(complex.count(0), 0),
      times_divided_(complex.element_count()) {
  double total = 0;
  for (std::size_t i = 0; i + 1 < edge.size(); ++i) total += norm(minus(edge[i + 1], edge[i]));
  if (!(total <= most_points * between_points * size_))
    throw InputError("the edge of the blade is " + number_text(total) + " m long, " +
                     number_text(total / size_) + " elements; at most " +
                     number_text(most_points * between_points) +
                     " elements are traced: let it end near the body");
  for (std::size_t i = 0; i + 1 < edge.size(); ++i) {
    const double length = norm(minus(edge[i + 1], edge[i]));
    divisions_.push_back(static_cast<Index>(std::ceil(length / (between_points * size_)) + 1));
  }
}

SweptSheet::Row SweptSheet::refined(const std::vector<Vec3>& points, double time) const {
  Row row{time, {points[0]}};
  for (std::size_t i = 0; i + 1 < points.size(); ++i)
    for (Index k = 1; k <= divisions_[i]; ++k) {
      const double part = static_cast<double>(k) / divisions_[i];
      row.points.push_back(plus(scaled(1 - part, points[i]), scaled(part, points[i + 1])));
    }
  return row;
}

// ------------------------------------------------------------------ the edge at rest --

/// Returns false, and changes nothing, if no point is in tissue.
bool SweptSheet::find_shifts(const Row& row) {
  Box box = no_box;
  for (const Vec3& p : row.points) include(box, p);
  finder_.update(box, row.time - time_, searched * size_);
  time_ = row.time;
  const double* rest = attributes_.rest().rows();
  std::vector<std::size_t> inside;
  std::vector<Vec3> found(row.points.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const bool is_found = finder_.any_around(row.points[i], [&](Index e, const Vec3& at) {
      found[i] = minus(place_in(complex_.vertices_of(e), at, rest, 4), row.points[i]);
      return true;
    });
    if (is_found) inside.push_back(i);
  }
  if (inside.empty()) return false;
  for (std::size_t i = 0; i < found.size(); ++i)
    found[i] = found[*std::ranges::min_element(
        inside, {}, [i](std::size_t j) { return j > i ? j - i : i - j; })];
  shifts_ = std::move(found);
  return true;
}

int SweptSheet::rows_between(const std::vector<Vec3>& from, const std::vector<Vec3>& to) const {
  const double rows = std::max(std::ceil(way(from, to) / (between_rows * size_)), 1.0);
  const double points = 1 + std::accumulate(divisions_.begin(), divisions_.end(), 0.0);
  if (!(rows * points <= most_traced))
    throw InputError("the blade moves " + number_text(way(from, to)) + " m in this step, " +
                     number_text(rows * between_rows) + " elements, with an edge of " +
                     number_text(points) + " points; at most " + number_text(most_traced) +
                     " points are traced in a step: let its path begin and end near the body");
  return static_cast<int>(rows);
}

SweptSheet::Row SweptSheet::at_rest(Row row) const {
  for (std::size_t i = 0; i < row.points.size(); ++i)
    row.points[i] = plus(row.points[i], shifts_[i]);
  return row;
}

bool SweptSheet::advance(const std::vector<Vec3>& points, double time, bool is_last) {
  const Row now = refined(points, time);
  const bool is_inside = find_shifts(now);
  if (!is_inside && rows_.empty()) {
    approach(now);
    return false;
  }
  if (rows_.empty())
    for (const Row& row : approach_) add(at_rest(row));
  approach_.clear();
  const Row traced = at_rest(now);
  const double least = is_last ? 0 : between_rows * size_;
  if (!rows_.empty() && way(rows_.back().points, traced.points) <= least)
    return rows_.size() > 1 && is_last && new_rows_ > 0;
  if (turns_back(traced)) {  // another stroke, once the body is cut along this one
    if (new_rows_ > 0) return true;
    rows_.erase(rows_.begin(), rows_.end() - 1);
    ++stroke_;
  }
  add(traced);
  if (is_inside) last_inside_ = now;
  if (way(last_inside_.points, now.points) > kept_outside * size_) {
    rows_.clear();
    new_rows_ = 0;
    ++stroke_;
  }
  return rows_.size() > 1 && (is_last || new_rows_ >= rows_per_cut);
}

/// It comes nearer, or goes elsewhere.
void SweptSheet::approach(Row row) {
  const double least = between_rows * size_;
  if (!approach_.empty() && way(approach_.back().points, row.points) < least) return;
  approach_.push_back(std::move(row));
  if (static_cast<double>(approach_.size()) * between_rows > kept_behind)
    approach_.erase(approach_.begin());
}

bool SweptSheet::turns_back(const Row& row) const {
  if (rows_.size() < 2) return false;
  const std::vector<Vec3>&last = rows_.back().points, &before = rows_[rows_.size() - 2].points;
  double sum = 0;
  for (std::size_t i = 0; i < last.size(); ++i)
    sum += dot(minus(row.points[i], last[i]), minus(last[i], before[i]));
  return sum < 0;
}

void SweptSheet::add(Row row) {
  rows_.push_back(std::move(row));
  ++new_rows_;
  if (static_cast<double>(rows_.size()) * between_rows > kept_behind) rows_.erase(rows_.begin());
  sheet_.reset();
}

void SweptSheet::roll_back(double time) {
  for (std::vector<Row>* rows : {&rows_, &approach_})
    while (!rows->empty() && rows->back().time > time) {
      rows->pop_back();
      if (rows == &rows_ && new_rows_ > 0) --new_rows_;
    }
  time_ = time;
  sheet_.reset();
  finder_.forget();
}

// ----------------------------------------------------------------------- the sheet --

std::vector<double> SweptSheet::heights(const CellComplex& complex, const double* rest,
                                        std::size_t stride) const {
  std::vector<double> heights = sheet().heights_in(new_boxes(), seen_within * size_, complex, rest,
                                                   stride, near_sheet * size_);
  const auto is_kept = [&](Index v) { return !std::isnan(heights[v]) && !std::isnan(kept_[v]); };
  double agreement = 0;  // the sheet may run the other way than in an earlier stroke
  for (Index v = 0; v < heights.size(); ++v)
    if (is_kept(v)) agreement += heights[v] * kept_[v];
  const double sign = agreement < 0 ? -1 : 1;
  for (Index v = 0; v < heights.size(); ++v) {
    heights[v] *= sign;
    if (is_kept(v) &&
        (stroke_of_[v] == stroke_ || std::abs(kept_[v] - heights[v]) < on_earlier * size_))
      heights[v] = kept_[v];
  }
  return heights;
}

/// Around neighbouring points of the new rows and of the one before them.
std::vector<Box> SweptSheet::new_boxes() const {
  const std::size_t count = rows_[0].points.size();
  std::vector<Box> boxes((count + points_per_box - 1) / points_per_box, no_box);
  for (std::size_t k = rows_.size() - std::min(rows_.size(), new_rows_ + 1); k < rows_.size(); ++k)
    for (std::size_t i = 0; i < count; ++i) include(boxes[i / points_per_box], rows_[k].points[i]);
  return boxes;
}

/// Rows k and k + 1 and points i and i + 1 of the edge make two triangles.
const SurfacePatch& SweptSheet::sheet() const {
  if (sheet_) return *sheet_;
  TriangleSurface surface{"blade", {}, {}};
  const auto count = static_cast<Index>(rows_[0].points.size());
  for (const Row& row : rows_)
    surface.points.insert(surface.points.end(), row.points.begin(), row.points.end());
  for (Index k = 0; k + 1 < rows_.size(); ++k)
    for (Index i = 0; i + 1 < count; ++i) {
      const Index a = k * count + i, b = a + count;
      surface.triangles.push_back({a, b, b + 1});
      surface.triangles.push_back({a, b + 1, a + 1});
    }
  sheet_ = std::make_unique<SurfacePatch>(std::move(surface), size_);
  return *sheet_;
}

void SweptSheet::keep(const std::vector<double>& heights, std::span<const Index> divided) {
  new_rows_ = 0;
  for (const Index e : divided) {
    ++times_divided_[e];
    for (const Index v : complex_.vertices_of(e)) {
      kept_[v] = heights[v];
      stroke_of_[v] = stroke_;
    }
  }
}

bool SweptSheet::has_divided(Index element, const std::vector<double>& heights) const {
  const unsigned times = times_divided_[element];
  return times >= most_divisions ||
         (times > 0 && std::ranges::all_of(complex_.vertices_of(element),
                                           [&](Index v) { return heights[v] == kept_[v]; }));
}

void SweptSheet::follow(const TopologyChange& change) {
  for (const Split& split : change.splits[0]) {
    kept_.push_back(double(kept_[split.old_cell]));
    stroke_of_.push_back(Index(stroke_of_[split.old_cell]));
  }
  for (const Split& copy : change.copies)
    times_divided_.push_back(std::uint8_t{times_divided_[copy.old_cell]});
  finder_.follow(change);
}

void SweptSheet::Row::state(Archive& archive) {
  archive("time", time);
  archive("points", points);
}

void SweptSheet::state(Archive& archive) {
  archive("shifts", shifts_);
  archive.each("approach", approach_);
  archive.each("rows", rows_);
  archive("new rows", new_rows_);
  archive("last inside", last_inside_);
  archive("time", time_);
  archive("kept", kept_);
  archive("stroke of", stroke_of_);
  archive("stroke", stroke_);
  archive("is divided", times_divided_);
  archive.rows<Dart>("ties", ties_);
  if (!archive.loads()) return;
  sheet_.reset();
  finder_.forget();
}

}  // namespace suture
