// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/tear.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "kernel/attributes/cell_nodes.hpp"
#include "kernel/base/archive.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/forces/loops/dispatch.hpp"
#include "kernel/operations/refused_operation.hpp"
#include "kernel/plugin_host/output_fields.hpp"

namespace suture {
namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// The margin for rounding in the bound of the first pass.
constexpr double slack = 1e-9;

/// Rows per task of a thread, and rows below which one thread does all.
constexpr Index rows_per_task = 8192;

ColumnSpec metric_spec(const Tear& tear) {
  ColumnSpec spec;
  spec.name = "metric";
  spec.components = tear.by == Tear::By::elongation ? 12 : 9;
  return spec;
}

/// Mean of what two elements say; of one, if the other has nothing to say.
double mean(double a, double b) {
  if (std::isnan(a)) return b;
  return std::isnan(b) ? a : (a + b) / 2;
}

bool declares_field(const suture_model& model, const std::string& name) {
  return std::ranges::any_of(
      std::span(model.attributes, model.attribute_count),
      [&](const suture_attribute& a) { return (a.flags & SUTURE_FIELD) != 0 && a.name == name; });
}

/// Null unless the model that is torn by declares the field on vertices.
const double* vertex_values(const Attributes& attributes, const Tear& tear) {
  for (const auto& instance : attributes.instances())
    if (instance->name() == tear.model && declares_field(instance->model(), tear.field))
      return std::ranges::find(attributes.fields(), tear.field, &VertexField::name)->values->rows();
  return nullptr;
}

void add_face(const CellComplex& complex, Dart face, std::vector<Dart>& faces) {
  faces.push_back(std::min(face_of(face), face_of(complex.beta3(face))));
}

}  // namespace

struct TearCheck::Snapshot {
  const CellComplex& complex;
  Attributes& attributes;
  Body& body;
  double time;

  HexahedronNodes nodes(const Column& places, Index e) const {
    HexahedronNodes x;
    const Hexahedron& vertices = complex.vertices_of(e);
    for (std::size_t n = 0; n < hexahedron::vertices; ++n) {
      const double* row = places.rows() + places.offset(vertices[n]);
      x[n] = {row[0], row[1], row[2]};
    }
    return x;
  }
  HexahedronNodes now(Index e) const { return nodes(attributes.position(), e); }
  HexahedronNodes rest(Index e) const { return attributes.rest_places(complex).of(e); }
  AxisValue strain(Index e) const {
    return principal_strain(now(e), reciprocals(mean_edges(rest(e))));
  }
};

TearCheck::TearCheck(const Tear& tear, std::span<const Index> elements, std::string path)
    : tear_(tear), path_(std::move(path)), metric_(metric_spec(tear), 3) {
  chosen_count_ = static_cast<Index>(elements.size());
  if (!elements.empty()) first_chosen_ = elements.front();
  for (const Index e : elements) choose(e);
}

/// Ascending, from the first on.
void TearCheck::choose(Index element) {
  is_chosen_.resize(element - first_chosen_ + std::size_t{1});
  is_chosen_.back() = 1;
}

void TearCheck::invalidate(std::span<const Split> copies) {
  is_built_ = false;
  for (const Split& copy : copies)
    if (!is_chosen_.empty() && takes_part(copy.old_cell)) choose(copy.new_cell);
}

// ------------------------------------------------------- the first pass --

Column TearCheck::make_metric(const Snapshot& snapshot) const {
  Column metric(metric_spec(tear_), 3);
  metric.resize(row_count_);
  metric.expand();
  for (Index row = 0; row < row_count_; ++row) {
    const HexahedronNodes rest = snapshot.rest(rows_.empty() ? row : rows_[row]);
    if (tear_.by == Tear::By::elongation) {
      for (int e = 0; e < hexahedron::edges; ++e) {
        const double limit =
            edge_length(rest, static_cast<std::size_t>(e)) * (1 + tear_.above) * (1 - slack);
        metric.set(row, e, limit * limit);
      }
    } else {
      const auto G = reciprocals(mean_edges(rest));
      for (int c = 0; c < 9; ++c)
        metric.set(row, c, G[static_cast<std::size_t>(c / 3)][static_cast<std::size_t>(c % 3)] / 4);
    }
  }
  metric.pad();
  metric.compress(slack / 100);
  return metric;
}

void TearCheck::build(const Snapshot& snapshot) {
  if (is_built_) return;
  const Index count = snapshot.complex.element_count(), first = first_chosen_;
  const Index last = is_chosen_.empty() ? count : first + static_cast<Index>(is_chosen_.size());
  rows_.clear();
  for (Index e = first; e < last; ++e)
    if (takes_part(e) && snapshot.complex.exists(3, e)) rows_.push_back(e);
  row_count_ = static_cast<Index>(rows_.size());
  if (row_count_ == count) rows_ = std::vector<Index>();
  if (tear_.by != Tear::By::field) metric_ = make_metric(snapshot);
  is_built_ = true;
}

/// Rows' elements that may be above the threshold, ascending.
std::vector<Index> TearCheck::stretched(const Snapshot& snapshot) const {
  loops::Stretch job{};
  job.nodes = snapshot.complex.vertices().front().data();
  job.cells = rows_.empty() ? nullptr : rows_.data();
  job.position = snapshot.attributes.position().rows();
  job.metric = metric_.block(0);
  job.block = metric_.is_constant() ? 0 : std::uint64_t{8} * metric_.spec().components;
  // E > above  <=>  F^T F > 1 + 2 above
  job.bound = (1 + 2 * tear_.above) * (1 - slack);
  const auto test = tear_.by == Tear::By::elongation ? hot_loops().elongated : hot_loops().strained;

  const Index tasks = (row_count_ + rows_per_task - 1) / rows_per_task;
  std::vector<std::vector<Index>> found(tasks);
  const auto one = [&](std::size_t task) {
    const auto begin = static_cast<Index>(task) * rows_per_task;
    const Index end = std::min(begin + rows_per_task, row_count_);
    Index out[rows_per_task];
    const Index n = test(&job, begin, end, out);
    found[task].assign(out, out + n);
  };
  if (tasks > 4)
    snapshot.body.models().workers().parallel_for(tasks, one);
  else
    for (Index task = 0; task < tasks; ++task) one(task);

  std::vector<Index> elements;
  for (const auto& part : found)
    for (const Index row : part) elements.push_back(rows_.empty() ? row : rows_[row]);
  return elements;
}

// ------------------------------------------------------------- the faces --

/// `values`: of every element, or null: the strain itself.
std::vector<Dart> TearCheck::by_principal(const Snapshot& snapshot,
                                          const std::vector<double>* values) {
  const CellComplex& complex = snapshot.complex;
  const auto value_of = [&](Index e) { return values ? (*values)[e] : snapshot.strain(e).value; };
  std::vector<Index> candidates;
  if (values) {
    for (Index row = 0; row < row_count_; ++row) {
      const Index e = rows_.empty() ? row : rows_[row];
      if ((*values)[e] > tear_.above) candidates.push_back(e);
    }
  } else {
    candidates = stretched(snapshot);
  }
  std::vector<Dart> faces;
  for (const Index e : candidates) {
    const AxisValue strain = snapshot.strain(e);
    const double value = values ? (*values)[e] : strain.value;
    if (!(value > tear_.above)) continue;
    for (const int f : faces_of_axis[static_cast<std::size_t>(strain.axis)]) {
      const Index other = complex.neighbour(e, f);
      if (other == none || !takes_part(other)) continue;
      const double others = value_of(other);
      if (others > value) continue;  // then it is the other that says which face
      if (mean(value, others) > tear_.above) add_face(complex, face_dart(e, f), faces);
    }
  }
  return faces;
}

/// `values`: of every vertex. Where the element beyond the face is strained more, that one decides;
/// an element that is open there tears no more.
std::vector<Dart> TearCheck::by_vertices(const Snapshot& snapshot, const double* values) {
  const CellComplex& complex = snapshot.complex;
  std::vector<Dart> faces;
  for (Index row = 0; row < row_count_; ++row) {
    const Index e = rows_.empty() ? row : rows_[row];
    const Hexahedron& vertices = complex.vertices_of(e);
    const auto mean_of = [&](const auto& nodes) {
      double sum = 0;
      for (const auto n : nodes) sum += values[vertices[n]];
      return sum / static_cast<double>(std::size(nodes));
    };
    static constexpr std::array<std::uint8_t, 8> all{0, 1, 2, 3, 4, 5, 6, 7};
    if (!(mean_of(all) > tear_.above)) continue;
    const AxisValue strain = snapshot.strain(e);
    const auto& pair = faces_of_axis[static_cast<std::size_t>(strain.axis)];
    const auto is_open = [&](int f) {
      return complex.neighbour(e, f) == none && mean_of(suture_hexahedron_faces[f]) > tear_.above;
    };
    if (std::ranges::any_of(pair, is_open)) continue;
    const auto [low, high] = pair;
    const bool is_low =
        mean_of(suture_hexahedron_faces[low]) >= mean_of(suture_hexahedron_faces[high]);
    const int torn = is_low ? low : high;
    const Index other = complex.neighbour(e, torn);
    if (other == none || !takes_part(other) || snapshot.strain(other).value > strain.value)
      continue;
    add_face(complex, face_dart(e, torn), faces);
  }
  return faces;
}

/// `values`: of every edge, or null: the elongation.
std::vector<Dart> TearCheck::by_edges(const Snapshot& snapshot, const std::vector<double>* values) {
  const CellComplex& complex = snapshot.complex;
  const auto value_of = [&](Index e) {
    if (!values) return elongations(snapshot.now(e), snapshot.rest(e));
    std::array<double, 3> most{no_value, no_value, no_value};
    for (std::size_t i = 0; i < hexahedron::edges; ++i) {
      const double value = (*values)[complex.edges_of(e)[i]];
      if (!(value <= most[i / 4]) && !std::isnan(value)) most[i / 4] = value;
    }
    return most;
  };
  std::vector<Index> candidates;
  if (!values) {
    candidates = stretched(snapshot);
  } else if (rows_.empty()) {
    candidates.resize(row_count_);
    for (Index e = 0; e < row_count_; ++e) candidates[e] = e;
  } else {
    candidates = rows_;
  }
  std::vector<Dart> faces;
  for (const Index e : candidates) {
    const std::array<double, 3> value = value_of(e);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!(value[axis] > tear_.above)) continue;
      for (const int f : faces_of_axis[axis]) {
        const Dart face = face_dart(e, f);
        const Dart mate = complex.beta3(face);
        if (mate == none || !takes_part(element_of(mate))) continue;
        const auto across = static_cast<std::size_t>(axis_of_face[local_face(mate)]);
        if (mean(value[axis], value_of(element_of(mate))[across]) > tear_.above)
          add_face(complex, face, faces);
      }
    }
  }
  return faces;
}

/// 3 if elements have the field, 1 if edges have it.
int TearCheck::field_dimension(const Snapshot& snapshot) const {
  for (const auto& instance : snapshot.attributes.instances()) {
    if (instance->name() != tear_.model) continue;
    const suture_model& model = instance->model();
    for (const suture_functor& functor : std::span(model.functors, model.functor_count)) {
      for (const suture_field& field : output_fields(functor))
        if (field.name == tear_.field && field.components == 1)
          return static_cast<int>(functor.dimension);
    }
  }
  throw PluginError(path_ + "/by: no model named '" + tear_.model + "' provides the field '" +
                    tear_.field + "'");
}

/// The field by cell of the complex; NaN where there is none.
std::vector<double> TearCheck::field_values(const Snapshot& snapshot, int dimension) const {
  std::vector<double> values(snapshot.complex.count(dimension), no_value);
  for (const auto& instance : snapshot.attributes.instances()) {
    if (instance->name() != tear_.model) continue;
    const CellSet& cells = instance->table(dimension).cells;
    std::vector<double> rows(cells.size(), no_value);
    if (!snapshot.body.models().compute_field(*instance, dimension, tear_.field, snapshot.time,
                                              rows)) {
      throw PluginError(path_ + "/by: model '" + tear_.model + "' does not compute '" +
                        tear_.field + "' with these parameters");
    }
    for (Index row = 0; row < cells.size(); ++row)
      if (cells.row(cells.cell(row)) == row) values[cells.cell(row)] = rows[row];
  }
  return values;
}

std::vector<Dart> TearCheck::find(const Snapshot& snapshot) {
  build(snapshot);
  if (row_count_ == 0) return {};
  std::vector<Dart> faces;
  if (tear_.by == Tear::By::principal_strain) {
    faces = by_principal(snapshot, nullptr);
  } else if (tear_.by == Tear::By::elongation) {
    faces = by_edges(snapshot, nullptr);
  } else if (const double* const u = vertex_values(snapshot.attributes, tear_)) {
    faces = by_vertices(snapshot, u);
  } else {
    const int dimension = field_dimension(snapshot);
    const std::vector<double> values = field_values(snapshot, dimension);
    faces = dimension == 1 ? by_edges(snapshot, &values) : by_principal(snapshot, &values);
  }
  sort_unique(faces);
  return faces;
}

// ------------------------------------------------------------ the answer --

void TearCheck::check_share(const CellComplex& complex, std::size_t torn) const {
  std::size_t faces = 0;
  for (Index row = 0; row < row_count_; ++row) {
    const Index e = rows_.empty() ? row : rows_[row];
    for (int f = 0; f < hexahedron::faces; ++f) {
      const Index other = complex.neighbour(e, f);
      faces += other != none && e < other && takes_part(other);
    }
  }
  if (static_cast<double>(torn) <= tear_.max_fraction * static_cast<double>(faces)) return;
  std::ostringstream text;
  text << path_ << ": would tear " << torn << " of " << faces
       << " faces at once, more than 'most' allows (" << 100 * tear_.max_fraction
       << " %); nothing was torn. Raise 'above', ramp the load, restrict it with 'where', or raise "
          "'most'";
  throw RefusedOperation(text.str());
}

std::vector<Dart> TearCheck::faces(Body& body, double time) {
  const std::vector<Dart> faces = find({body.complex(), body.attributes(), body, time});
  if (!faces.empty()) check_share(body.complex(), faces.size());
  return faces;
}

void TearCheck::state(Archive& archive) {
  if (!archive.has_cells()) return;
  Index first = first_chosen_, count = chosen_count_;
  archive("first chosen", first);
  archive("chosen count", count);
  std::vector<char> chosen = is_chosen_;
  archive("chosen", chosen);
  const auto common = std::min(std::ssize(chosen), std::ssize(is_chosen_));  // without copies
  archive.require(first == first_chosen_ && count == chosen_count_ &&
                      std::equal(chosen.begin(), chosen.begin() + common, is_chosen_.begin()),
                  "the elements that may tear differ");
  if (!archive.loads()) return;
  is_chosen_ = std::move(chosen);  // with those of copies
  invalidate();
}

}  // namespace suture
