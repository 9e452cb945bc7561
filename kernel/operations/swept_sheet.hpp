// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "kernel/contact/element_finder.hpp"
#include "kernel/operations/cut_along.hpp"
#include "kernel/operations/edge_samples.hpp"
#include "kernel/operations/own_slit.hpp"

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
// Tissue trembles at an edge and is dragged by it. The sheet grows forwards only: where the edge
// goes back, or sideways, by less than an element, it waits at the row where the edge was farthest
// (Stroke::waiting). From an element on, the blade has turned: sideways, the sheet bends;
// backwards, another stroke begins there.

namespace suture {

class SweptSheet final {
 public:
  /// `edge`: the polyline in tissue coordinates at first, which says how finely it is traced, m.
  SweptSheet(const CellComplex& complex, Attributes& attributes, const std::vector<Vec3>& edge);

  /// The edge is at these points now, after the last call. Returns the blade along which the body
  /// at rest is to be cut, until the next call; null where nothing would be divided: it has
  /// advanced by less than half an element. `is_last`: it does not go on. 1 ns per vertex and 1 us
  /// per point of the edge.
  std::unique_ptr<Blade> advance(const std::vector<Vec3>& points, double time, bool is_last);
  /// When advance() was last called, s.
  double time() const { return time_; }
  /// When it must be called for an edge that moves straight between two times: at least at the
  /// second one. A way, and an edge, that are long beside the body are traced near it only.
  std::vector<double> times_between(double from, const std::vector<Vec3>& at_first, double to,
                                    const std::vector<Vec3>& at_last) const;
  /// Call after each cut along the blade of advance(), before elements are divided, with its
  /// heights.
  void keep(const std::vector<double>& heights, std::span<const Index> divided);
  /// Call instead if there was no such cut, because it could not be made.
  void give_up_rows();
  void follow(const TopologyChange& change);
  double element_size() const { return size_; }  ///< the longest edge at rest, m
  /// At the front, between cuts along this.
  std::vector<Tie>& ties() { return ties_; }

  void state(Archive& archive);

 private:
  class Front;
  using Points = std::vector<Vec3>;
  struct Row {
    double time = 0;  ///< s
    Points points;    ///< of the edge, m
    void state(Archive& archive);
  };
  /// Where in the tissue an edge is: by its points, and for those that are in none, as at the
  /// nearest one with some.
  struct Tissue {
    std::vector<Index> elements;
    Points at;      ///< in them
    Points places;  ///< of the tissue, m
    Points shifts;  ///< from where the points are to where the tissue is at rest, m
    void copy(std::size_t from, std::size_t to);
    void add(const Tissue& other, std::size_t point);
    void state(Archive& archive);
  };
  enum class Turn { ahead, aside, back };
  /// A way through the tissue, which begins when the edge enters it.
  struct Stroke {
    Tissue tissue;             ///< where the edge was last in it
    Points inside;             ///< where that is at rest
    std::vector<Row> rows;     ///< of the sheet, at rest; at least one
    std::size_t new_rows = 0;  ///< the last of them, since the last cut
    std::vector<Row> waiting;  ///< where the edge has gone from the last row, not forwards; at rest

    Vec3 heading(std::size_t point, double length) const;
    Turn turn(const Row& row, double length) const;
    Points ahead(Points points, double length) const;
    void wait(Row row, double spacing);
    void add(Row row);
    std::vector<Box> new_boxes() const;
    void state(Archive& archive);
  };

  std::optional<Tissue> find_tissue(const Row& row);
  void follow_tissue(Tissue& tissue) const;
  static Row at_rest(Row row, const Points& shifts);
  void approach(Row row);
  Stroke begin(const Row& now, const Tissue& tissue);
  std::optional<Row> row_before(const Row& first, const Row& now, const Tissue& tissue) const;
  std::unique_ptr<Blade> grow(Row row, bool is_last);
  std::unique_ptr<Blade> new_front() const;
  void cover(const Points& points);
  Box body_box() const;
  double spacing() const;

  const CellComplex& complex_;
  Attributes& attributes_;
  ElementFinder finder_;
  double size_;  ///< the longest edge of an element at rest, m
  EdgeSamples samples_;
  std::vector<Row> approach_;  ///< where the edge was before the stroke
  Row before_;                 ///< the last of these, however near
  std::optional<Stroke> stroke_;
  double time_ = 0;   ///< of the last call, s
  Index number_ = 0;  ///< of the stroke
  OwnSlit slit_;
  std::vector<Tie> ties_;
};

}  // namespace suture
