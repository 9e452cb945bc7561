// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "kernel/contact/element_finder.hpp"
#include "kernel/operations/cut_along.hpp"

// A moving blade that divides elements
// ====================================
//
//   tissue now                       tissue at rest
//
//      |  /                             | | | | |
//      | /  edge at t      ------>      +-+-+-+-+  rows of the sheet: the edge at each quarter
//      |/                               | | | | |  of an element
//
// Each place of the edge is traced back to where its tissue is at rest. What it has swept there is
// a sheet that grows, and the body at rest is cut along the sheet as along any other surface: an
// element is divided as soon as the sheet holds its whole section. The opening therefore lags
// behind the edge by up to an element and a half.
//
// The heights of the nodes of a divided element are kept: where the sheet bends later, elements
// that are divided then agree with it on the faces that they share, and its copies are not cut
// again by a hair.

namespace suture {

class SweptSheet final : public Blade {
 public:
  /// `edge`: the polyline in tissue coordinates at first, which says how finely it is traced, m.
  /// Throws InputError if it is longer than 50,000 elements.
  SweptSheet(const CellComplex& complex, Attributes& attributes, const std::vector<Vec3>& edge);

  /// The edge is at these points now, after the last call. Returns true if a cut may have something
  /// to do: it has advanced by half an element, or `is_last`. 1 ns per vertex
  /// and 1 us per point of the edge.
  bool advance(const std::vector<Vec3>& points, double time, bool is_last);
  /// When advance() was last called, s.
  double time() const { return time_; }
  /// How often it must be called for an edge that moves so far: at least once. Throws InputError if
  /// more than ten million points would be traced.
  int rows_between(const std::vector<Vec3>& from, const std::vector<Vec3>& to) const;
  /// Call after each cut along this, before elements are divided, with its heights.
  void keep(const std::vector<double>& heights, std::span<const Index> divided);
  void follow(const TopologyChange& change);
  /// Call after a rollback to `time`; nothing was divided since then.
  void roll_back(double time);
  /// At the front, between cuts along this.
  std::vector<Tie>& ties() { return ties_; }

  /// The sheet lies in the tissue at rest: `rest` are the places there. Known near what has been
  /// swept since the last cut.
  std::vector<double> heights(const CellComplex& complex, const double* rest,
                              std::size_t stride) const override;
  bool is_endless() const override { return false; }
  bool holds(const Vec3& place) const override { return sheet().holds(place); }
  bool has_divided(Index element, const std::vector<double>& heights) const override;
  void state(Archive& archive);

 private:
  struct Row {
    double time = 0;           ///< s
    std::vector<Vec3> points;  ///< of the edge, m
    void state(Archive& archive);
  };
  Row refined(const std::vector<Vec3>& points, double time) const;
  bool find_shifts(const Row& row);
  Row at_rest(Row row) const;
  bool turns_back(const Row& row) const;
  void approach(Row row);
  void add(Row row);
  std::vector<Box> new_boxes() const;
  const SurfacePatch& sheet() const;

  const CellComplex& complex_;
  Attributes& attributes_;
  ElementFinder finder_;
  double size_;                   ///< the longest edge of an element at rest, m
  std::vector<Index> divisions_;  ///< of each segment of the polyline
  /// From where the tissue at each point of the edge is to where it is at rest; where there is
  /// none, as at the nearest point of the edge with some, or as it was last.
  std::vector<Vec3> shifts_;
  std::vector<Row> approach_;                    ///< before the edge is in tissue, where it is
  std::vector<Row> rows_;                        ///< of the sheet, at rest
  std::size_t new_rows_ = 0;                     ///< the last of them, since the last cut
  Row last_inside_;                              ///< where the edge was when it was last in tissue
  double time_ = 0;                              ///< of the last call, s
  mutable std::unique_ptr<SurfacePatch> sheet_;  ///< of the rows; null: not made yet
  /// Heights that are kept, by vertex, m: NaN without one; and in which stroke they were.
  std::vector<double> kept_;
  std::vector<Index> stroke_of_;
  std::vector<std::uint8_t> times_divided_;  ///< by element; of copies, with their originals
  Index stroke_ = 0;
  std::vector<Tie> ties_;
};

}  // namespace suture
