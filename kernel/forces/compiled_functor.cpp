// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/compiled_functor.hpp"

#include <algorithm>

#include "kernel/attributes/inspection.hpp"
#include "kernel/attributes/lips.hpp"
#include "kernel/base/archive.hpp"
#include "kernel/base/bulk.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/plugin_host/part_functors.hpp"

namespace suture {
namespace {

/// The three local edges (1) or faces (2) at the vertex where a dart starts.
template <int Dimension>
constexpr auto locals_at = [] {
  std::array<std::array<hexahedron::Local, 3>, hexahedron::darts> result{};
  for (std::size_t d = 0; d < result.size(); ++d)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto dart = hexahedron::vertex_darts[hexahedron::dart_vertex[d]][i];
      result[d][i] = Dimension == 1
                         ? hexahedron::dart_edge[dart]
                         : static_cast<hexahedron::Local>(dart / hexahedron::darts_per_face);
    }
  return result;
}();

/// Those of the dart's element.
template <int Dimension>
std::array<Index, 3> cells_at(const CellComplex& complex, Dart dart) {
  const Index element = dart / hexahedron::darts;
  const auto& [a, b, c] = locals_at<Dimension>[dart % hexahedron::darts];
  if constexpr (Dimension == 1) {
    const auto& edges = complex.edges_of(element);
    return {edges[a], edges[b], edges[c]};
  } else {
    const auto& faces = complex.faces_of(element);
    return {faces[a], faces[b], faces[c]};
  }
}

}  // namespace

RowNodes::RowNodes(const Instance& instance, const suture_functor& functor, const RestPlaces& rest)
    : instance_(instance),
      cells_(instance.table(static_cast<int>(functor.dimension)).cells),
      dimension_(static_cast<int>(functor.dimension)),
      on_lips_(acts_on_lips(functor)),
      node_count_(static_cast<std::size_t>(nodes_of(functor))) {
  // Room for what cuts append: copying all rows for the first of them would cost more
  // than the cut. Pages that nobody touches take no memory.
  nodes_.reserve(cells_.size() * node_count_ * 3 / 2);
  nodes_.resize(cells_.size() * node_count_);
  prefer_large_pages(nodes_.data() + nodes_.size(),
                     (nodes_.capacity() - nodes_.size()) * sizeof(nodes_[0]));
  for (Index row = 0; row < cells_.size() && !on_lips_; ++row)
    if (cells_.is_live(row)) read_row(rest.complex(), row);
  if (on_lips_) read_lips(rest.complex());
}

void RowNodes::read_lips(const CellComplex& complex) {
  for (const Seam& lips : instance_.lips) {
    const Index face = face_of_lips(complex, lips);
    if (face == none || lips_at(instance_, complex, face) == nullptr) continue;
    Index* const nodes = nodes_.data() + cells_.row(face) * node_count_;
    const FunctorCorners corners = corners_of(lips);
    for (std::size_t n = 0; n < node_count_; ++n)
      nodes[n] = complex.vertices_of(corners[n].element)[corners[n].corner];
  }
}

void RowNodes::read_row(const CellComplex& complex, Index row) {
  cell_nodes(complex, dimension_, cells_.cell(row), nodes_.data() + row * node_count_);
}

void RowNodes::read_cell(const CellComplex& complex, Index cell) {
  const Index row = cells_.row(cell);
  if (row != none) read_row(complex, row);
}

void RowNodes::update(const RestPlaces& rest, const TopologyChange& change) {
  if (on_lips_) {
    nodes_.resize(cells_.size() * node_count_);
    return read_lips(rest.complex());
  }
  read_nodes(rest.complex(), change);
  // A vertex is at rest where the kernel's column says.
  if (dimension_ > 0 && !rest.own().empty()) read_rest(rest, change.elements);
}

/// Which end of an edge is the first depends on what was done.
void RowNodes::state(Archive& archive) {
  archive("nodes", nodes_);
  archive("rest_slots", rest_slot_);
  archive("own_rest", own_rest_);
  archive.require(nodes_.size() == cells_.size() * node_count_, "the rows differ");
}

void RowNodes::read_rest(const RestPlaces& rest, std::span<const Index> elements) {
  rest_slot_.resize(cells_.size(), none);
  for (const Index element : elements)
    for (const Index cell : cells_of_element(rest.complex(), dimension_, element))
      read_rest_of(rest, cell);
}

void RowNodes::read_rest_of(const RestPlaces& rest, Index cell) {
  const Index row = cells_.row(cell);
  if (row == none) return;
  std::array<hexahedron::Local, hexahedron::vertices> corners;
  const Index element = cell_corners(rest.complex(), dimension_, cell, corners.data());
  Index& slot = rest_slot_[row];
  if (rest.own().slot(element) == none) {
    slot = none;
    return;
  }
  if (slot == none) {
    slot = static_cast<Index>(own_rest_.size() / (4 * node_count_));
    own_rest_.resize(own_rest_.size() + 4 * node_count_);
  }
  double* out = own_rest_.data() + 4 * node_count_ * slot;
  for (std::size_t n = 0; n < node_count_; ++n, out += 4)
    std::copy_n(rest.corner(element, corners[n]), 3, out);
}

void RowNodes::read_nodes(const CellComplex& complex, const TopologyChange& change) {
  const auto rows_before = static_cast<Index>(nodes_.size() / node_count_);
  nodes_.resize(cells_.size() * node_count_);
  const bool only_split = change.faces_sewn == 0 && change.removed[3].empty();
  if (!only_split) return read_elements(complex, change.elements);
  if (cells_.is_all())
    for (Index row = rows_before; row < cells_.size(); ++row) read_row(complex, row);
  else  // an old row may describe a new cell
    for (const Index cell : change.stars[static_cast<std::size_t>(dimension_)].cells)
      read_cell(complex, cell);
  if (dimension_ == 1)
    follow_vertices<1>(complex, change, rows_before);
  else if (dimension_ == 2)
    follow_vertices<2>(complex, change, rows_before);
}

/// A cell that is what it was may have another vertex now, and a row may describe
/// another cell: every cell of every touched element is read again.
void RowNodes::read_elements(const CellComplex& complex, std::span<const Index> elements) {
  for (const Index element : elements)
    for (const Index cell : cells_of_element(complex, dimension_, element))
      read_cell(complex, cell);
}

/// After splits alone: cells around a new vertex, whose elements all are its own now, in
/// the first `rows` rows.
template <int Dimension>
void RowNodes::follow_vertices(const CellComplex& complex, const TopologyChange& change,
                               Index rows) {
  const Stars& stars = change.stars[0];
  auto split = change.splits[0].begin();
  for (std::size_t i = 0; i < stars.size() && split != change.splits[0].end(); ++i) {
    if (stars.cells[i] != split->new_cell) continue;  // in one order
    for (const Dart dart : stars[i])
      for (const Index cell : cells_at<Dimension>(complex, dart)) {
        const Index row = cells_.row(cell);
        if (row >= rows) continue;  // `none` too
        Index* const nodes = nodes_.data() + row * (std::size_t{1} << Dimension);
        for (int n = 0; n < 1 << Dimension; ++n)
          nodes[n] = nodes[n] == split->old_cell ? split->new_cell : nodes[n];
      }
    ++split;
  }
}

CompiledFunctor::CompiledFunctor(Instance& instance, const suture_functor& functor,
                                 const RowNodes* nodes, const suture_functor* on_parts)
    : instance_(instance),
      functor_(on_parts ? *on_parts : functor),
      on_parts_(on_parts != nullptr),
      function_(functor_.force),
      nodes_(nodes),
      dimension_(static_cast<int>(functor.dimension)) {
  const Instance::Enabled& answer =
      instance.functor(static_cast<std::size_t>(&functor - instance.model().functors));
  if (!answer.runs) reason_ = "its force is zero with these parameters";
  reads_ = functor_.reads & (answer.reads | ~functor.reads);
  cell_columns_.resize(functor_.cell_column_count);
  vertex_columns_.resize(functor_.vertex_column_count);
}

std::string CompiledFunctor::title() const {
  return instance_.title() + ", functor '" + functor_.name + "'";
}

Connectivity CompiledFunctor::connectivity(const CellComplex& complex) const {
  const auto count = static_cast<Index>(nodes_of(functor_));
  const std::uint8_t* live = cells().live().data();
  if (dimension_ != 3) return {nodes_->data(), nullptr, count, live};
  return {complex.vertices().data()->data(), cells().is_all() ? nullptr : cells().cells().data(),
          count, live};
}

/// Elements of the shape that the functor is written for, or all cells. A functor may treat a batch
/// of boxes by itself, so that other shapes are not to be among them.
std::vector<loops::Rows> CompiledFunctor::element_rows() const {
  const Index skewed = instance_.skewed_begin, general = instance_.general_begin,
              part = instance_.part_begin;
  if (dimension_ < 3) return {{0, cells().size()}};
  std::vector<loops::Rows> rows;
  if (!on_parts_ && functor_.shape == SUTURE_PARALLELEPIPED)
    rows = {{0, skewed}, {skewed, general}};
  else if (!on_parts_)
    rows = {{functor_.shape == SUTURE_GENERAL ? general : 0, part}};
  const std::vector<loops::Rows> more = rows_from(part);
  rows.insert(rows.end(), more.begin(), more.end());
  return rows;
}

/// The rows of the functor among parts, and elements that were parts, from a row on.
std::vector<loops::Rows> CompiledFunctor::rows_from(Index first) const {
  using Shape = Instance::RowShape;
  std::vector<loops::Rows> rows;
  Shape last = Shape::part;
  for (Index row = first; row < cells().size(); ++row) {
    const Shape shape = instance_.shape(row);
    const bool is_its = on_parts_ ? shape == Shape::part
                        : functor_.shape == SUTURE_ANY_SHAPE
                            ? shape != Shape::part
                            : shape != Shape::part &&
                                  (shape == Shape::general) == (functor_.shape == SUTURE_GENERAL);
    if (!is_its) continue;
    if (!rows.empty() && rows.back().end == row && shape == last)
      ++rows.back().end;
    else
      rows.push_back({row, row + 1});
    last = shape;
  }
  return rows;
}

bool CompiledFunctor::visits(const CellComplex& complex, Index row) const {
  if (skipped() || !admits(instance_, functor_, complex, row)) return false;
  return dimension_ < 3 || (instance_.shape(row) == Instance::RowShape::part) == on_parts_;
}

bool CompiledFunctor::visits_some_faces() const {
  return dimension_ == 2 && (functor_.faces != SUTURE_ALL_FACES || acts_on_lips(functor_));
}

std::vector<loops::Rows> CompiledFunctor::wanted_rows(const CellComplex& complex) const {
  if (visits_some_faces()) return wanted_faces(complex);
  std::vector<loops::Rows> rows = element_rows();
  std::erase_if(rows, [](const loops::Rows& range) { return range.begin == range.end; });
  return rows;
}

std::vector<loops::Rows> CompiledFunctor::wanted_faces(const CellComplex& complex) const {
  std::vector<loops::Rows> ranges;
  for (Index row = 0; row < cells().size(); ++row) {
    if (!admits(instance_, functor_, complex, row)) continue;
    if (!ranges.empty() && ranges.back().end == row)
      ++ranges.back().end;
    else
      ranges.push_back({row, row + 1});
  }
  return ranges;
}

void CompiledFunctor::build(const CellComplex& complex) {
  rows_ = cells().size();
  if (skipped()) return;
  const auto rows = wanted_rows(complex);
  if (rows.empty()) {
    // Faces may join after a cut, and elements may become parts; they never change their shape.
    const bool may_come = on_parts_ && instance_.may_get_parts();
    if (dimension_ == 3 && !may_come)
      reason_ = "no element of its region has the shape for which it is written";
    list_ = {};
    return;
  }
  list_ = BatchList(connectivity(complex), rows, complex.count(0));
  if (fixed_) list_.leave_out(connectivity(complex), *fixed_);
}

void CompiledFunctor::leave_out(const std::vector<bool>* fixed, const CellComplex& complex) {
  fixed_ = fixed;
  if (!skipped()) list_.leave_out(connectivity(complex), *fixed);
}

const BatchList& CompiledFunctor::list_without(const std::vector<bool>& others,
                                               const CellComplex& complex) {
  if (!list_without_) {
    list_without_ = list_;
    list_without_->leave_out(connectivity(complex), others);
  }
  return *list_without_;
}

void CompiledFunctor::update(const CellComplex& complex, const TopologyChange& change) {
  if (skipped() || change.empty()) return;
  const Index before = rows_;
  rows_ = cells().size();
  const bool may_append = !visits_some_faces();
  if (!may_append || !append(complex, before)) return build(complex);
  // Two vertices never meet in a third.
  if (dimension_ > 0 && !change.merges[0].empty() && !follow_merges(complex, change))
    build(complex);
}

/// Adds rows from `first` on; false if the list should be built again.
bool CompiledFunctor::append(const CellComplex& complex, Index first) {
  if (dimension_ < 3) return list_.append(connectivity(complex), first, rows_, complex.count(0));
  return std::ranges::all_of(rows_from(first), [&](const loops::Rows& rows) {
    return list_.append(connectivity(complex), rows.begin, rows.end, complex.count(0));
  });
}

void CompiledFunctor::state(Archive& archive, const std::vector<bool>* fixed) {
  bool skips = skipped();
  archive("skipped", skips);
  if (skips != skipped())
    archive.refuse(title() + (skips ? " was skipped in the earlier run but is needed here"
                                    : " is skipped here but was computed in the earlier run"));
  archive("rows", rows_);
  archive("list", list_);
  archive.require(skips || rows_ == cells().size(), "the rows differ");
  if (archive.loads()) fixed_ = fixed;
}

/// The rows at the vertex where the dart starts, in the dart's element.
std::vector<Index> CompiledFunctor::rows_at(const CellComplex& complex, Dart dart) const {
  if (dimension_ == 3) return {cells().row(dart / hexahedron::darts)};
  const auto around = dimension_ == 1 ? cells_at<1>(complex, dart) : cells_at<2>(complex, dart);
  std::vector<Index> rows;
  for (const Index cell : around) rows.push_back(cells().row(cell));
  return rows;
}

/// Chunks that share a vertex since vertices became one wait for each other. False if two
/// of them have one colour.
bool CompiledFunctor::follow_merges(const CellComplex& complex, const TopologyChange& change) {
  const ChunkFinder finder(list_);
  std::vector<Index> chunks, colours;
  for (std::size_t i = 0; i < change.stars[0].size(); ++i) {
    chunks.clear();
    colours.clear();
    for (const Dart dart : change.stars[0][i])
      for (const Index row : rows_at(complex, dart))
        if (const Index chunk = row == none ? none : finder.chunk(row); chunk != none)
          chunks.push_back(chunk);
    sort_unique(chunks);
    for (const Index chunk : chunks) colours.push_back(finder.colour(chunk));
    std::ranges::sort(colours);
    if (std::ranges::adjacent_find(colours) != colours.end()) return false;
    list_.meet(chunks);
  }
  return true;
}

const loops::Job& CompiledFunctor::job(Attributes& attributes, const CellComplex& complex,
                                       const LiveMask& live, double time, double dt,
                                       double* force) {
  const Connectivity nodes = connectivity(complex);
  job_.nodes = nodes.nodes;
  job_.cells = nodes.cells;
  job_.node_count = nodes.node_count;
  const bool users = dimension_ == 3 && !attributes.user_element.empty();
  job_.ids = users ? attributes.user_element.data() : nullptr;
  job_.row_ids = dimension_ != 3 && !cells().is_all() ? cells().cells().data() : nullptr;
  job_.rest = reads_ & SUTURE_READ_REST ? attributes.rest().rows() : nullptr;
  job_.position = reads_ & SUTURE_READ_POSITION ? attributes.position().rows() : nullptr;
  job_.velocity = reads_ & SUTURE_READ_VELOCITY ? attributes.velocity().rows() : nullptr;
  job_.force = force;
  job_.time = time;
  job_.dt = dt;
  job_.function = function_;
  job_.skewed_begin = dimension_ == 3 ? instance_.skewed_begin : 0;
  job_.live = live.data();
  const OwnRest& own = attributes.rest_places(complex).own();
  job_.rest_slots = dimension_ == 3 ? own.slots() : nodes_->rest_slots();
  job_.own_rest = dimension_ == 3 ? own.rows() : nodes_->own_rest();
  read_columns(attributes);
  return job_;
}

bool CompiledFunctor::has_states() const {
  const auto is_state = [&](std::uint32_t attribute) {
    return attribute != UINT32_MAX && !is_part_column(attribute) &&
           instance_.column(attribute) != nullptr && instance_.column(attribute)->has_trial();
  };
  return std::any_of(functor_.cell_columns, functor_.cell_columns + functor_.cell_column_count,
                     is_state) ||
         std::any_of(functor_.vertex_columns,
                     functor_.vertex_columns + functor_.vertex_column_count, is_state);
}

Index CompiledFunctor::components() const {
  const std::uint32_t field = functor_.field;
  return field == 0 ? 3 : static_cast<Index>(instance_.model().attributes[field - 1].components);
}

bool CompiledFunctor::reads_field() const {
  const std::span columns(functor_.vertex_columns, functor_.vertex_column_count);
  return std::ranges::any_of(columns, [&](std::uint32_t a) {
    return a != UINT32_MAX && (instance_.model().attributes[a].flags & SUTURE_FIELD) != 0;
  });
}

void CompiledFunctor::read_columns(Attributes& attributes) {
  job_.has_trial = 0;
  varying_columns_.clear();
  for (std::size_t i = 0; i < cell_columns_.size(); ++i) {
    if (is_part_column(functor_.cell_columns[i])) {
      const PartColumn& part = instance_.part_column(functor_.cell_columns[i]);
      cell_columns_[i] = {part.data(), nullptr, std::uint64_t{part.components()} * SUTURE_LANES,
                          part.components(), 0};
      varying_columns_.push_back(static_cast<std::uint32_t>(i));
      continue;
    }
    Column& column = *instance_.column(functor_.cell_columns[i]);
    const auto components = static_cast<std::uint32_t>(column.spec().components);
    const bool trial = column.has_trial();
    const auto stride = dimension_ == 0 ? static_cast<std::uint32_t>(column.stride()) : 0;
    cell_columns_[i] = {std::as_const(column).block(0), trial ? column.trial_block(0) : nullptr,
                        column.is_constant() ? 0 : std::uint64_t{components} * SUTURE_LANES,
                        components, stride};
    if (trial) job_.has_trial = 1;
    if (trial || !column.is_constant()) varying_columns_.push_back(static_cast<std::uint32_t>(i));
  }
  const CellSet& vertices = instance_.table(0).cells;
  for (std::size_t i = 0; i < vertex_columns_.size(); ++i) {
    const std::uint32_t attribute = functor_.vertex_columns[i];
    const bool mass = attribute == UINT32_MAX;
    const Column* const shared = mass ? &attributes.mass() : instance_.shared_column(attribute);
    const Column& column = shared ? *shared : *instance_.column(attribute);
    const Index* rows = shared || vertices.is_all() ? nullptr : vertices.rows().data();
    vertex_columns_[i] = {column.rows(), rows, static_cast<std::uint32_t>(column.spec().components),
                          static_cast<std::uint32_t>(column.stride())};
  }
  job_.cell_column_count = static_cast<std::uint32_t>(cell_columns_.size());
  job_.vertex_column_count = static_cast<std::uint32_t>(vertex_columns_.size());
  job_.varying_column_count = static_cast<std::uint32_t>(varying_columns_.size());
  job_.varying_columns = varying_columns_.data();
  job_.cell_columns = cell_columns_.data();
  job_.vertex_columns = vertex_columns_.data();
}

}  // namespace suture
