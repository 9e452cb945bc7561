// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/swept_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "kernel/base/archive.hpp"
#include "kernel/base/rows.hpp"
#include "kernel/parts/embedding.hpp"

namespace suture {
namespace {

// The distances between points of the edge, and between rows of the sheet; in elements.
constexpr double between_points = 0.5, between_rows = 0.25;
// Points of all rows that the edge passes in a step, beyond which it is looked where the body is;
// and rows near it.
constexpr double most_traced = 1e7, most_rows = 1e5;
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
// Where the edge has come from is seen so far back, and it has turned when it has gone so far
// elsewhere; in elements.
constexpr double seen_back = 1, turned_at = 1;
// So near the tissue, an edge that comes to it is known to come from outside; in elements.
constexpr double entry = 1.5;
// The least part of a way that leads forwards: 45 degrees.
constexpr double forwards = 0.7071;

/// The farthest that a point has moved.
double way(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  double farthest = 0;
  for (std::size_t i = 0; i < to.size(); ++i)
    farthest = std::max(farthest, norm(minus(to[i], from[i])));
  return farthest;
}

/// How far the points of a row have moved, beside it. An edge that mostly slides along itself, as a
/// saw does, sweeps only what it moves across itself.
class Steps {
 public:
  Steps(const std::vector<Vec3>& row, const std::vector<Vec3>& to) : row_(row) {
    double along = 0, across = 0;
    for (std::size_t i = 0; i < to.size(); ++i) {
      steps_.push_back(minus(to[i], row[i]));
      along += norm(steps_[i]);
      across += norm(without_tangent(i, steps_[i]));
    }
    slides_ = across < least_across * along;
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      steps_[i] = (*this)(i, steps_[i]);
      farthest_ = std::max(farthest_, norm(steps_[i]));
    }
  }
  const Vec3& operator[](std::size_t point) const { return steps_[point]; }
  double farthest() const { return farthest_; }
  /// The part that counts of another way of a point.
  Vec3 operator()(std::size_t point, const Vec3& way) const {
    return slides_ ? without_tangent(point, way) : way;
  }

 private:
  static constexpr double least_across = 0.5;

  Vec3 without_tangent(std::size_t i, const Vec3& way) const {
    const Vec3 tangent = minus(row_[std::min(i + 1, row_.size() - 1)], row_[i > 0 ? i - 1 : 0]);
    const double squared = dot(tangent, tangent);
    return squared > 0 ? minus(way, scaled(dot(way, tangent) / squared, tangent)) : way;
  }

  const std::vector<Vec3>& row_;
  std::vector<Vec3> steps_;
  bool slides_ = false;
  double farthest_ = 0;
};

/// The triangles between the points of rows: rows k and k + 1 and points i and i + 1 of the edge
/// make two. A point that stays where it was is the same point in both rows; others are not,
/// wherever they are. So no edge has three triangles, however the rows lie.
template <class Rows>
TriangleSurface triangles_between(const Rows& rows) {
  TriangleSurface surface{"blade", {}, {}};
  const auto count = static_cast<Index>(rows[0].points.size());
  std::vector<Index> numbers(count), before(count);
  const auto add = [&](Index a, Index b, Index c) {
    const std::vector<Vec3>& x = surface.points;
    if (norm(cross(minus(x[b], x[a]), minus(x[c], x[a]))) > 0)
      surface.triangles.push_back({a, b, c});
  };
  for (std::size_t k = 0; k < rows.size(); ++k) {
    before.swap(numbers);
    for (Index i = 0; i < count; ++i) {
      const bool stays = k > 0 && rows[k].points[i] == rows[k - 1].points[i];
      numbers[i] = stays ? Index{before[i]} : static_cast<Index>(surface.points.size());
      if (!stays) surface.points.push_back(rows[k].points[i]);
    }
    if (k == 0) continue;
    for (Index i = 0; i + 1 < count; ++i) {
      add(before[i], numbers[i], numbers[i + 1]);
      add(before[i], numbers[i + 1], before[i + 1]);
    }
  }
  return surface;
}

}  // namespace

/// The sheet behind the edge, as the blade of a cut. It lies in the tissue at rest: rows of places
/// are those there. Heights are known near what has been swept since the last cut.
class SweptSheet::Front final : public Blade {
 public:
  Front(TriangleSurface surface, std::vector<Box> boxes, double size, const OwnSlit& slit,
        Index stroke)
      : sheet_(std::move(surface), size),
        boxes_(std::move(boxes)),
        size_(size),
        slit_(slit),
        stroke_(stroke) {}

  std::vector<double> heights(const CellComplex& complex, const double* rest,
                              std::size_t stride) const override {
    return slit_.snapped(
        sheet_.heights_in(boxes_, seen_within * size_, complex, rest, stride, near_sheet * size_),
        stroke_);
  }
  bool is_endless() const override { return false; }
  bool holds(const Vec3& place, double reach) const override { return sheet_.holds(place, reach); }
  bool is_measured() const override { return false; }
  Earlier earlier_cut(Index element, const std::vector<double>& heights) const override {
    return slit_.earlier_cut(element, heights, stroke_);
  }

 private:
  SurfacePatch sheet_;
  std::vector<Box> boxes_;
  double size_;
  const OwnSlit& slit_;
  Index stroke_;
};

SweptSheet::SweptSheet(const CellComplex& complex, Attributes& attributes,
                       const std::vector<Vec3>& edge)
    : complex_(complex),
      attributes_(attributes),
      finder_(complex, attributes),
      size_(longest_edge(complex, attributes.rest().rows(), 4)),
      samples_(edge, between_points * size_),
      slit_(complex, size_) {}

double SweptSheet::spacing() const { return between_rows * size_; }

Box SweptSheet::body_box() const {
  Box box = no_box;
  for (Index v = 0; v < complex_.count(0); ++v)
    if (complex_.exists(0, v)) include(box, row(attributes_.position().rows(), v));
  for (std::size_t c = 0; c < 3; ++c) {
    box.low[c] -= (kept_behind + 1) * size_;
    box.high[c] += (kept_behind + 1) * size_;
  }
  return box;
}

// ------------------------------------------------------------------ the edge at rest --

/// A step that is far too long for its rows is looked at where the body is.
std::vector<double> SweptSheet::times_between(double from, const Points& at_first, double to,
                                              const Points& at_last) const {
  double first = 0, last = 1,
         rows = std::max(std::ceil(Steps(at_first, at_last).farthest() / spacing()), 1.0);
  if (!(rows * static_cast<double>(samples_.count()) <= most_traced)) {
    const auto near = shares_in(at_first, at_last, body_box());
    if (!near) return {to};
    std::tie(first, last) = *near;
    rows = std::clamp(std::ceil(rows * (last - first)), 1.0, most_rows);
  }
  std::vector<double> times;
  for (double i = first > 0 ? 0 : 1; i <= rows; ++i)
    times.push_back(from + (to - from) * (first * rows + (last - first) * i) / rows);
  if (last < 1) times.push_back(to);
  times.back() = to;
  return times;
}

/// None if no point is in tissue.
std::optional<SweptSheet::Tissue> SweptSheet::find_tissue(const Row& row) {
  Box box = no_box;
  for (const Vec3& p : row.points) include(box, p);
  finder_.update(box, row.time - time_, searched * size_);
  time_ = row.time;
  const double *rest = attributes_.rest().rows(), *now = attributes_.position().rows();
  const std::size_t count = row.points.size();
  std::vector<std::size_t> inside;
  Tissue found{std::vector<Index>(count), Points(count), Points(count), Points(count)};
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_found = finder_.any_around(row.points[i], [&](Index e, const Vec3& at) {
      const Hexahedron& nodes = complex_.vertices_of(e);
      found.elements[i] = e;
      found.at[i] = at;
      found.places[i] = place_in(nodes, at, now, 4);
      found.shifts[i] = minus(place_in(nodes, at, rest, 4), row.points[i]);
      return true;
    });
    if (is_found) inside.push_back(i);
  }
  if (inside.empty()) return {};
  const auto away = [](std::size_t i, std::size_t j) { return j > i ? j - i : i - j; };
  for (std::size_t i = 0, k = 0; i < count; ++i) {
    while (k + 1 < inside.size() && away(i, inside[k + 1]) < away(i, inside[k])) ++k;
    found.copy(inside[k], i);
  }
  return found;
}

void SweptSheet::Tissue::copy(std::size_t from, std::size_t to) {
  elements[to] = Index{elements[from]};
  at[to] = Vec3(at[from]);
  places[to] = Vec3(places[from]);
  shifts[to] = Vec3(shifts[from]);
}

/// An edge outside the tissue moves on beside what was at it: one may have left the other.
void SweptSheet::follow_tissue(Tissue& tissue) const {
  for (std::size_t i = 0; i < tissue.elements.size(); ++i) {
    if (!complex_.exists(3, tissue.elements[i])) continue;
    const Vec3 now = place_in(complex_.vertices_of(tissue.elements[i]), tissue.at[i],
                              attributes_.position().rows(), 4);
    tissue.shifts[i] = plus(tissue.shifts[i], minus(tissue.places[i], now));
    tissue.places[i] = now;
  }
}

SweptSheet::Row SweptSheet::at_rest(Row row, const Points& shifts) {
  for (std::size_t i = 0; i < row.points.size(); ++i)
    row.points[i] = plus(row.points[i], shifts[i]);
  return row;
}

std::unique_ptr<Blade> SweptSheet::advance(const std::vector<Vec3>& points, double time,
                                           bool is_last) {
  if (samples_.is_long()) cover(points);
  const Row now{time, samples_.places(points)};
  std::optional<Tissue> tissue = find_tissue(now);
  if (!stroke_ && !tissue) {
    approach(now);
    return {};
  }
  if (!stroke_) stroke_ = begin(now, *tissue);
  Stroke& stroke = *stroke_;
  if (tissue)
    stroke.tissue = std::move(*tissue);
  else
    follow_tissue(stroke.tissue);
  Row traced = at_rest(now, stroke.tissue.shifts);
  if (tissue) {
    stroke.inside = traced.points;
  } else if (Steps(stroke.inside, traced.points).farthest() > kept_outside * size_) {
    if (std::unique_ptr<Blade> rest = new_front()) return rest;  // first; then the stroke ends
    stroke_.reset();
    ++number_;
    approach(now);
    return {};
  }
  return grow(std::move(traced), is_last);
}

/// The edge comes nearer, or goes elsewhere.
void SweptSheet::approach(Row row) {
  before_ = row;
  if (!approach_.empty() && way(approach_.back().points, row.points) < spacing()) return;
  approach_.push_back(std::move(row));
  if (static_cast<double>(approach_.size()) * between_rows > kept_behind)
    approach_.erase(approach_.begin());
}

SweptSheet::Stroke SweptSheet::begin(const Row& now, const Tissue& tissue) {
  Stroke stroke;
  stroke.tissue = tissue;
  for (const Row& row : approach_) stroke.rows.push_back(at_rest(row, tissue.shifts));
  if (stroke.rows.empty())
    stroke.rows.push_back(at_rest(now, tissue.shifts));
  else if (auto before = row_before(stroke.rows[0], at_rest(now, tissue.shifts), tissue))
    stroke.rows.insert(stroke.rows.begin(), std::move(*before));
  stroke.inside = stroke.rows.back().points;
  stroke.new_rows = stroke.rows.size();
  approach_.clear();
  return stroke;
}

/// Where the edge has hardly moved, the tissue has come to it: the first row would lie in the
/// tissue already. The way of the last step goes on backwards from there.
std::optional<SweptSheet::Row> SweptSheet::row_before(const Row& first, const Row& now,
                                                      const Tissue& tissue) const {
  if (way(first.points, now.points) > entry * size_) return {};
  const double dt = now.time - before_.time;
  Points steps(now.points.size());  // of the edge, beside the tissue
  double longest = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Vec3 velocity = place_in(complex_.vertices_of(tissue.elements[i]), tissue.at[i],
                                   attributes_.velocity().rows(), 4);
    steps[i] = minus(minus(minus(now.points[i], tissue.shifts[i]), before_.points[i]),
                     scaled(dt, velocity));
    longest = std::max(longest, norm(steps[i]));
  }
  if (!(longest > 1e-9 * size_)) return {};
  Row before = first;
  for (std::size_t i = 0; i < steps.size(); ++i)
    before.points[i] = minus(before.points[i], scaled(entry * size_ / longest, steps[i]));
  return before;
}

// ----------------------------------------------------------------------- the sheet --

/// What the blade cuts when the edge has come to a row.
std::unique_ptr<Blade> SweptSheet::grow(Row row, bool is_last) {
  Stroke& stroke = *stroke_;
  const double least = is_last ? 0 : spacing();
  const auto rest = [&] { return is_last ? new_front() : nullptr; };
  const auto has_left = [&](const Row& to, double by) {
    return Steps(stroke.rows.back().points, to.points).farthest() > by;
  };
  if (!has_left(row, least)) {
    stroke.waiting.clear();
    return rest();
  }
  const Turn turn = stroke.turn(row, seen_back * size_);
  if (turn == Turn::ahead) {
    stroke.waiting.clear();
    row.points = stroke.ahead(std::move(row.points), seen_back * size_);
    if (!has_left(row, least)) return rest();
  } else if (!has_left(row, turned_at * size_)) {
    stroke.wait(std::move(row), spacing());
    return rest();
  } else if (turn == Turn::back) {
    if (std::unique_ptr<Blade> first = new_front()) return first;
    stroke.rows.erase(stroke.rows.begin(), stroke.rows.end() - 1);
    stroke.new_rows = 0;
    ++number_;
  }
  for (Row& waiting : stroke.waiting) stroke.add(std::move(waiting));
  stroke.waiting.clear();
  stroke.add(std::move(row));
  return is_last || stroke.new_rows >= rows_per_cut ? new_front() : nullptr;
}

/// From where a point of the edge has come to the last row: at least so long, or zero if it has
/// stood.
Vec3 SweptSheet::Stroke::heading(std::size_t point, double length) const {
  Vec3 heading{};
  for (std::size_t k = rows.size() - 1; k > 0 && norm(heading) < length; --k)
    heading = minus(rows.back().points[point], rows[k - 1].points[point]);
  return heading;
}

SweptSheet::Turn SweptSheet::Stroke::turn(const Row& row, double length) const {
  const Steps steps(rows.back().points, row.points);
  double on = 0, moved = 0;
  for (std::size_t i = 0; i < row.points.size(); ++i) {
    const Vec3 from = steps(i, heading(i, length));
    const double distance = norm(steps[i]), before = norm(from);
    moved += distance;
    on += before > 0 ? dot(steps[i], from) / before : distance;
  }
  if (on >= forwards * moved) return Turn::ahead;
  return on < 0 ? Turn::back : Turn::aside;
}

/// Points of an edge that turns may go back where the whole of it goes on: they stay.
SweptSheet::Points SweptSheet::Stroke::ahead(Points points, double length) const {
  const Steps steps(rows.back().points, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 from = steps(i, heading(i, length));
    if (dot(steps[i], from) < -forwards * norm(steps[i]) * norm(from))
      points[i] = rows.back().points[i];
  }
  return points;
}

/// Where the edge comes back to one of the rows that wait, it has not left it.
void SweptSheet::Stroke::wait(Row row, double spacing) {
  for (std::size_t k = 0; k < waiting.size(); ++k)
    if (way(waiting[k].points, row.points) < spacing) return waiting.resize(k + 1);
  waiting.push_back(std::move(row));
}

void SweptSheet::Stroke::add(Row row) {
  rows.push_back(std::move(row));
  ++new_rows;
  if (static_cast<double>(rows.size()) * between_rows > kept_behind) rows.erase(rows.begin());
}

/// Null if nothing has been swept since the last cut.
std::unique_ptr<Blade> SweptSheet::new_front() const {
  if (stroke_->new_rows == 0) return {};
  TriangleSurface surface = triangles_between(stroke_->rows);
  if (surface.triangles.empty()) return {};
  return std::make_unique<Front>(std::move(surface), stroke_->new_boxes(), size_, slit_, number_);
}

/// Around neighbouring points of the new rows and of the one before them.
std::vector<Box> SweptSheet::Stroke::new_boxes() const {
  const std::size_t count = rows[0].points.size();
  std::vector<Box> boxes((count + points_per_box - 1) / points_per_box, no_box);
  for (std::size_t k = rows.size() - std::min(rows.size(), new_rows + 1); k < rows.size(); ++k)
    for (std::size_t i = 0; i < count; ++i) include(boxes[i / points_per_box], rows[k].points[i]);
  return boxes;
}

// ----------------------------------------------------------------------- long edges --

/// Adds samples where the edge has come near the body, to all that is known of it.
void SweptSheet::cover(const Points& points) {
  const auto lie = samples_.cover(points, body_box());
  if (!lie) return;
  const auto adapt = [&](Points& old) {
    Points now;
    now.reserve(lie->size());
    for (const auto& [low, high, share] : *lie)
      now.push_back(plus(scaled(1 - share, old[low]), scaled(share, old[high])));
    old = std::move(now);
  };
  for (Row& row : approach_) adapt(row.points);
  if (!before_.points.empty()) adapt(before_.points);
  if (!stroke_) return;
  for (std::vector<Row>* rows : {&stroke_->rows, &stroke_->waiting})
    for (Row& row : *rows) adapt(row.points);
  adapt(stroke_->inside);
  Tissue now;
  for (const auto& [low, high, share] : *lie) now.add(stroke_->tissue, share < 0.5 ? low : high);
  stroke_->tissue = std::move(now);
}

void SweptSheet::Tissue::add(const Tissue& other, std::size_t point) {
  elements.push_back(other.elements[point]);
  at.push_back(other.at[point]);
  places.push_back(other.places[point]);
  shifts.push_back(other.shifts[point]);
}

// ------------------------------------------------------------------------------ cuts --

void SweptSheet::keep(const std::vector<double>& heights, std::span<const Index> divided) {
  give_up_rows();
  slit_.keep(heights, divided, number_);
}

void SweptSheet::give_up_rows() {
  if (stroke_) stroke_->new_rows = 0;
}

/// The tissue at the edge is in a copy now: in any one, they have not moved yet.
void SweptSheet::follow(const TopologyChange& change) {
  slit_.follow(change);
  finder_.follow(change);
  if (!stroke_) return;
  for (Index& e : stroke_->tissue.elements) {
    if (complex_.exists(3, e)) continue;
    const auto copy = std::ranges::find(change.copies, e, &Split::old_cell);
    if (copy != change.copies.end()) e = copy->new_cell;
  }
}

void SweptSheet::Row::state(Archive& archive) {
  archive("time", time);
  archive("points", points);
}

void SweptSheet::Tissue::state(Archive& archive) {
  archive("elements", elements);
  archive("at", at);
  archive("places", places);
  archive("shifts", shifts);
}

void SweptSheet::Stroke::state(Archive& archive) {
  archive("tissue", tissue);
  archive("inside", inside);
  archive.each("rows", rows);
  archive("new rows", new_rows);
  archive.each("waiting", waiting);
}

void SweptSheet::state(Archive& archive) {
  archive("samples", samples_);
  archive.each("approach", approach_);
  archive("before", before_);
  archive("stroke", stroke_);
  archive("time", time_);
  archive("number", number_);
  if (archive.has_cells()) {
    archive("slit", slit_);
    archive.rows<Dart>("ties", ties_);
  }
  if (archive.loads()) finder_.forget();
}

}  // namespace suture
