// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/model_check/sample_body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "kernel/base/vec3.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/model_check/gather_cells.hpp"
#include "kernel/model_check/sample_parts.hpp"

namespace suture {
namespace {

constexpr double edge = 0.05;  // m

using Rotation = std::array<Vec3, 3>;

/// The shear of parallelepipeds.
constexpr Rotation skew{{{1, 0.3, -0.2}, {0.1, 1, 0.25}, {-0.15, 0.2, 1}}};

std::vector<HexahedronNodes> corners_of(const Mesh& mesh) {
  std::vector<HexahedronNodes> corners(mesh.hexahedra.size());
  for (std::size_t e = 0; e < corners.size(); ++e)
    for (std::size_t n = 0; n < hexahedron::vertices; ++n)
      corners[e][n] = mesh.points[mesh.hexahedra[e][n]];
  return corners;
}

/// Boxes with three different edges, graded along x.
Mesh sample_mesh(const SampleOptions& options) {
  Mesh mesh = make_box(
      {.size = {2 * edge, 1.8 * edge, 2.5 * edge}, .cells = {2, 2, 2}, .grading = {1.3, 1, 1}});
  std::mt19937_64 random(options.seed * 3 + 1);
  for (Vec3& x : mesh.points) {
    if (options.shape != SampleShape::boxes) x = rotated(skew, x);
    if (is_of_general_hexahedra(options.shape))
      for (double& c : x) c += between(random, -0.12, 0.12) * edge;
  }
  mesh.points[13][0] += options.irregular * edge;  // the node in the middle
  for (Vec3& x : mesh.points) {
    x = rotated(options.rotation, x);
    for (double& c : x) c *= options.scale;
  }
  const bool is_general = is_of_general_hexahedra(options.shape) || options.irregular != 0;
  if (is_of_parts(options.shape))
    mesh.parts = is_general ? sample_parts(corners_of(mesh)) : sample_parts();
  return mesh;
}

Imported import_sample(const SampleOptions& options) {
  Diagnostics diagnostics;
  ImportOptions import;
  import.renumber = false;  // so that samples of the same kind have the same numbers
  return import_mesh(sample_mesh(options), import, diagnostics);
}

Vec3 row_of(const Column& column, Index v) {
  return {column.get(v, 0), column.get(v, 1), column.get(v, 2)};
}

}  // namespace

double between(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

Vec3 rotated(const Rotation& rotation, const Vec3& v) {
  return {dot(rotation[0], v), dot(rotation[1], v), dot(rotation[2], v)};
}

Rotation random_rotation(std::mt19937_64& random) {
  double q[4], square = 0;
  do {
    square = 0;
    for (double& x : q) {
      x = between(random, -1, 1);
      square += x * x;
    }
  } while (square > 1 || square < 0.1);
  for (double& x : q) x /= std::sqrt(square);
  const auto [w, x, y, z] = q;
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
           {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
           {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
}

SampleBody::SampleBody(const suture_model& model, const SampleOptions& options)
    : options_(options), model_(model), random_(options.seed), body_(import_sample(options)) {
  if (options.halves) {
    add_model(model, {0, 2, 4, 6});
    add_model(model, {1, 3, 5, 7});
  } else {
    add_model(model, {});
  }
  body_.compile(diagnostics_, 1);
  open_lips();
  give_mass();
  deform();
}

void SampleBody::add_model(const suture_model& model, std::vector<Index> elements) {
  const bool is_second = !elements.empty() && elements[0] != 0;
  auto instance = std::make_unique<Instance>(model, is_second ? "checked-2" : "checked",
                                             parameters(), diagnostics_, true, given_columns());
  if (acts_on_lips(model)) {
    elements = !options_.halves ? std::vector<Index>{0, 2, 4, 6}
               : is_second      ? std::vector<Index>{2, 6}
                                : std::vector<Index>{0, 4};
    instance->lips = faces_between(body_.complex(), elements,
                                   {false, true, false, true, false, true, false, true});
  }
  body_.attributes().add(std::move(instance), body_.complex(), std::move(elements));
}

void SampleBody::open_lips() {
  const std::vector<Dart> faces = faces_to_open(body_.attributes());
  if (!faces.empty()) body_.cut(faces);
}

/// NaN for those that differ.
std::vector<double> SampleBody::parameters() const {
  std::vector<double> values = options_.set.values;
  for (std::size_t p = 0; p < values.size(); ++p)
    if (options_.set.differs && (model_.parameters[p].flags & SUTURE_PER_ELEMENT) != 0)
      values[p] = std::numeric_limits<double>::quiet_NaN();
  return values;
}

/// Directions, and the values that differ.
std::vector<GivenColumn> SampleBody::given_columns() const {
  std::vector<GivenColumn> columns;
  for (std::uint32_t a = 0; a < model_.attribute_count; ++a) {
    const suture_attribute& attribute = model_.attributes[a];
    if ((attribute.flags & SUTURE_PARAMETER) == 0) continue;
    std::uint32_t p = 0;
    while (std::string_view(model_.parameters[p].name) != attribute.name) ++p;
    const double value = options_.set.values[p];
    if (model_.parameters[p].type == SUTURE_DIRECTION) {
      const Vec3 direction = rotated(options_.rotation, {0.48, 0.6, 0.64});
      columns.push_back({a, false, {direction.begin(), direction.end()}});
    } else if (options_.set.differs) {
      GivenColumn column{a, true, {}};
      for (Index e = 0; e < 8; ++e) column.values.push_back(value * (1 - 0.04 * ((3 * e + p) % 8)));
      columns.push_back(std::move(column));
    }
  }
  return columns;
}

/// Functors that divide by the mass need one, whoever gives it.
void SampleBody::give_mass() {
  Column& mass = body_.attributes().mass();
  for (Index v = 0; v < mass.size(); ++v) gives_mass_ = gives_mass_ || mass.get(v, 0) != 0;
  for (Index v = 0; v < mass.size(); ++v)
    if (mass.get(v, 0) == 0) mass.set(v, 0, 0.1);
}

/// A homogeneous deformation and a motion of each node.
void SampleBody::deform() {
  Rotation gradient{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (Vec3& row : gradient)
    for (double& x : row) x += between(random_, -0.1, 0.1);
  Attributes& attributes = body_.attributes();
  const Rotation back{
      {{options_.rotation[0][0], options_.rotation[1][0], options_.rotation[2][0]},
       {options_.rotation[0][1], options_.rotation[1][1], options_.rotation[2][1]},
       {options_.rotation[0][2], options_.rotation[1][2], options_.rotation[2][2]}}};
  for (Index v = 0; v < attributes.vertex_count(); ++v) {
    Vec3 x = rotated(gradient, rotated(back, row_of(attributes.rest(), v))), velocity{};
    for (std::size_t c = 0; c < 3; ++c) {
      x[c] += between(random_, -0.04, 0.04) * edge;
      velocity[c] = between(random_, -1, 1) * edge;
    }
    x = rotated(options_.rotation, x);
    for (double& c : x) c *= options_.stretch;
    velocity = rotated(options_.rotation, velocity);
    for (int c = 0; c < 3; ++c) {
      attributes.position().set(v, c, x[static_cast<std::size_t>(c)]);
      attributes.velocity().set(v, c, velocity[static_cast<std::size_t>(c)]);
    }
  }
  vary_fields();
}

/// About their initial value, by up to 2 % of it, at least 0.02.
void SampleBody::vary_fields() {
  std::mt19937_64 random(options_.seed * 5 + 2);
  for (VertexField& field : body_.attributes().fields()) {
    const double initial = field.values->spec().initial;
    const double amount = 0.02 * std::max(1.0, std::abs(initial));
    for (Index v = 0; v < field.values->size(); ++v)
      for (int c = 0; c < field.values->spec().components; ++c)
        field.values->set(v, c, initial + between(random, -amount, amount));
  }
}

void SampleBody::go_to_rest() {
  options_.time = 0;
  Attributes& attributes = body_.attributes();
  for (Index v = 0; v < attributes.vertex_count(); ++v)
    for (int c = 0; c < 3; ++c) attributes.position().set(v, c, attributes.rest().get(v, c));
  for (VertexField& field : attributes.fields()) field.values->fill(field.values->spec().initial);
  stop();
}

std::vector<Dart> SampleBody::inner_faces() {
  const CellComplex& complex = body_.complex();
  std::vector<Dart> faces;
  for (Index e = 0; e < complex.element_count(); ++e)
    for (const Dart d : sides_of(e))
      if (complex.can_cut(d) && complex.beta3(d) > d) faces.push_back(d);
  return faces;
}

void SampleBody::stop() {
  Column& velocity = body_.attributes().velocity();
  for (Index v = 0; v < velocity.size(); ++v)
    for (int c = 0; c < 3; ++c) velocity.set(v, c, 0);
}

std::vector<const suture_functor*> SampleBody::functors() {
  std::vector<const suture_functor*> functors;
  for (std::uint32_t i = 0; i < model_.functor_count; ++i) {
    if (!instance().functor(i).runs) continue;
    const suture_functor* const on_parts = instance().part_functor(i);
    functors.push_back(on_parts ? on_parts : &model_.functors[i]);
  }
  return functors;
}

std::vector<Index> SampleBody::cells_of(const suture_functor& functor) {
  const int dimension = static_cast<int>(functor.dimension);
  const CellSet& set = instance().table(dimension).cells;
  std::vector<Index> cells;
  for (Index row = 0; row < set.size(); ++row) {
    const Index cell = set.cell(row);
    if (acts_on_lips(functor) && lips_at(instance(), body_.complex(), cell) == nullptr) continue;
    const bool is_general = dimension == 3 && instance().is_general(row);
    const bool is_boundary =
        dimension == 2 && body_.complex().beta3(body_.complex().dart_of(2, cell)) == none;
    if (functor.shape == SUTURE_PARALLELEPIPED && is_general) continue;
    if (functor.shape == SUTURE_GENERAL && !is_general) continue;
    if (dimension == 2 && functor.faces == SUTURE_BOUNDARY_FACES && !is_boundary) continue;
    if (dimension == 2 && functor.faces == SUTURE_INTERIOR_FACES && is_boundary) continue;
    cells.push_back(cell);
  }
  return cells;
}

std::vector<CellBatch> SampleBody::batches(const suture_functor& functor, std::size_t count) {
  std::vector<Index> cells = cells_of(functor);
  const std::vector<double> times = sample_times(model_, options_.set);
  std::vector<CellBatch> batches;
  for (std::size_t i = 0; i < count && !cells.empty(); ++i) {
    std::ranges::shuffle(cells, random_);
    batches.push_back(gather_cells(body_, instance(), functor, cells));
    batches.back().time = times[(i + static_cast<std::size_t>(options_.shape)) % times.size()];
  }
  // Small parts alone: beside others, their forces would be lost in rounding.
  if (is_of_parts(options_.shape) && functor.dimension == 3 && !cells.empty())
    for (const Index cell : {Index{4}, Index{7}}) {
      batches.push_back(gather_cells(body_, instance(), functor, {&cell, 1}));
      batches.back().time = times[0];
    }
  return batches;
}

std::vector<double> SampleBody::at_vertices(Column& column, int components) const {
  std::vector<double> values;
  for (Index v = 0; v < column.size(); ++v)
    for (int c = 0; c < components; ++c) values.push_back(column.get(v, c));
  return values;
}

std::vector<double> SampleBody::forces() {
  Column& force = body_.attributes().force();
  std::fill(force.rows(), force.rows() + std::size_t{force.size()} * 4, 0.0);
  body_.models().add_forces(options_.time, 0);
  return at_vertices(force);
}

}  // namespace suture
