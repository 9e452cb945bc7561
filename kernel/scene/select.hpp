// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

#include "kernel/attributes/column.hpp"
#include "kernel/scene/translate.hpp"
#include "kernel/topology/import.hpp"

namespace suture {

/// What the file calls things: kept aside when a mesh is imported, because the
/// complex has numbers of its own.
struct MeshNames {
  std::map<std::string, std::vector<Index>> point_sets;
  std::map<std::string, std::vector<Index>> element_sets;
  std::vector<std::uint64_t> point_ids;  ///< empty: 0, 1, 2, ...
  std::vector<std::uint64_t> element_ids;
  std::size_t point_count = 0, element_count = 0;

  static MeshNames of(const Mesh& mesh);
  std::uint64_t element_id(Index position) const {
    return element_ids.empty() ? position : element_ids[position];
  }
  std::uint64_t point_id(Index position) const {
    return point_ids.empty() ? position : point_ids[position];
  }
};

/// Turns the selections of a scene into cells of the complex that exist, where they are
/// at rest. Results are ascending. A selection that selects nothing, an unknown set or
/// an unknown id throws InputError with the selection's JSON path. O(cells).
class Selector {
 public:
  /// `rest`: the rest positions of all vertices, in `frame` like all selections.
  Selector(const Imported& imported, const MeshNames& names, const Column& rest,
           const BodyFrame& frame);

  std::vector<Index> vertices(const Selection& selection) const;
  /// Elements whose centroid is selected (ids and sets: the elements named).
  std::vector<Index> elements(const Selection& selection) const;
  /// The same while it runs: of the elements that are left, by their centroids where
  /// vertex v is at rows[4 v]. Maybe none.
  std::vector<Index> elements_now(const Selection& selection, const double* rows) const;
  /// One dart of each boundary face whose four vertices are selected.
  std::vector<Dart> boundary_faces(const Selection& selection) const;

  /// Element of the complex with the user's id, or `none`.
  Index element_with_id(std::uint64_t id) const;

  double diagonal() const { return diagonal_; }  ///< of the mesh at rest, m

 private:
  std::string bounds_text() const;
  std::vector<Index> listed_elements(const Selection& selection) const;
  bool contains(const Selection& selection, const Vec3& p) const;
  template <class Exists, class At>
  std::vector<Index> located(const Selection& selection, Index count, Exists exists, At at) const;
  std::vector<Index> located_elements(const Selection& selection, const double* rows) const;
  std::vector<Index> listed_vertices(const Selection& selection) const;
  std::vector<char> vertex_mask(const Selection& selection) const;
  std::vector<Index> named_vertices(const Selection& selection, const std::string& set) const;

  const Imported& imported_;
  const MeshNames& names_;
  const Column& rest_;
  const BodyFrame& frame_;
  double diagonal_;                                                   ///< of the mesh at rest, m
  std::map<std::uint64_t, Index> point_position_, element_position_;  ///< only where ids are given
};

}  // namespace suture
