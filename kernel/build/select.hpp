// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

#include "kernel/attributes/column.hpp"
#include "kernel/build/translate.hpp"
#include "kernel/geometry/element_blocks.hpp"
#include "kernel/parts/surface_triangle.hpp"
#include "kernel/scene/scene.hpp"
#include "kernel/topology/import.hpp"

namespace suture {

/// The names and numbers in the file, kept when a mesh is imported because the complex has its own
/// numbers.
struct MeshNames {
  std::map<std::string, std::vector<Index>> point_sets;
  std::map<std::string, std::vector<Index>> element_sets;
  std::vector<std::uint64_t> point_ids;  ///< empty: 0, 1, 2, ...
  std::vector<std::uint64_t> element_ids;
  std::vector<MeshArray> arrays;
  Mixtures mixtures;
  std::size_t point_count = 0, element_count = 0;

  static MeshNames of(const Mesh& mesh);
  std::uint64_t element_id(Index position) const {
    return element_ids.empty() ? position : element_ids[position];
  }
  std::uint64_t point_id(Index position) const {
    return point_ids.empty() ? position : point_ids[position];
  }
};

/// Converts the selections of a scene to existing cells of the complex, by their positions at rest.
/// Results are ascending. Throws InputError with the JSON path of the selection if it is empty or
/// names an unknown set or id. O(cells).
///
/// A partial element is where the centroid of its material is. A node outside the material is
/// selected by place if the surface crosses an edge from it in the selection.
class Selector {
 public:
  /// `rest`: the rest positions of all vertices, in `frame` like all selections. `parts`: by
  /// elements of the complex. `sets`: of the scene, of cells at rest; each may use earlier ones.
  Selector(const Imported& imported, const MeshNames& names, const Column& rest,
           const BodyFrame& frame, const Parts& parts, const std::vector<NamedSelection>& sets);

  std::vector<Index> vertices(const Selection& selection) const;
  /// The same during a run, by where vertex v is then: rows[4 v]. May be empty.
  std::vector<Index> vertices_now(const Selection& selection, const double* rows) const;
  std::vector<Index> vertices_now(const Selection& selection) const {
    return vertices_now(selection, rest_.rows());
  }
  bool mesh_has_set(const std::string& name) const {
    return names_.point_sets.contains(name) || names_.element_sets.contains(name);
  }
  /// Elements whose centroid is selected (for ids and sets, the named elements). With the blocks
  /// `at_rest`, only those nearby are looked at.
  std::vector<Index> elements(const Selection& selection,
                              const ElementBlocks* at_rest = nullptr) const;
  /// The same for ids and sets; empty for other selections, and for an empty set.
  std::vector<Index> listed_elements(const Selection& selection) const;
  /// The same during a run: the remaining elements, by their centroids, where vertex v is at rows[4
  /// v]. Copies of named elements are named, too. May be empty. With `blocks`, of the vertices
  /// there, only those nearby are looked at.
  std::vector<Index> elements_now(const Selection& selection, const double* rows,
                                  const ElementBlocks* blocks = nullptr) const;
  /// One dart of each boundary face whose four vertices are selected.
  std::vector<Dart> boundary_faces(const Selection& selection) const;
  /// The triangles of the embedded surface whose three corners are selected, by their places or as
  /// combinations of listed nodes.
  std::vector<SurfaceTriangle> surface_triangles(const Selection& selection) const;
  /// Whether loads on the surface act on surface_triangles() rather than boundary_faces().
  bool has_parts() const { return !parts_.empty(); }

  /// The element of the complex with this user id, or `none`.
  Index element_with_id(std::uint64_t id) const;
  /// The user's id of an element of the complex.
  std::uint64_t element_id(Index e) const { return names_.element_id(imported_.user_element[e]); }
  Index element_count() const { return imported_.complex.element_count(); }

  double diagonal() const { return diagonal_; }  ///< of the mesh at rest, m

 private:
  std::string bounds_text() const;
  bool contains(const Selection& selection, const Vec3& p) const;
  Vec3 centroid_of(Index e, const double* rows) const;
  std::vector<Index> located_vertices(const Selection& selection, const double* rows) const;
  template <class Place>
  std::vector<Index> located(const Selection& selection, Index count, const ElementBlocks* blocks,
                             Place place) const;
  std::vector<Index> located_elements(const Selection& selection, const double* rows,
                                      const ElementBlocks* blocks = nullptr) const;
  std::vector<Index> listed_vertices(const Selection& selection) const;
  std::vector<char> point_mask(const Selection& selection, const EmbeddedPoints& points) const;
  std::vector<char> vertex_mask(const Selection& selection, const double* rows) const;
  std::vector<Index> named_vertices(const Selection& selection, const std::string& set) const;
  std::vector<Index> named_elements(const Selection& selection, const std::string& set) const;
  /// The selection that a set of the scene stands for, or nullptr.
  const Selection* defined(const Selection& selection) const;
  std::vector<char> element_mask(const Selection& selection, const double* rows) const;

  const Imported& imported_;
  const MeshNames& names_;
  const Column& rest_;
  const BodyFrame& frame_;
  const Parts& parts_;
  const std::vector<NamedSelection>& sets_;
  double diagonal_;                                                   ///< of the mesh at rest, m
  std::map<std::uint64_t, Index> point_position_, element_position_;  ///< only if the file has ids
};

}  // namespace suture
