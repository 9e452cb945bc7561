// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/results/tensor_fields.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/attributes/mean_gradient.hpp"
#include "kernel/base/zeroed_vector.hpp"
#include "kernel/plugin_host/output_fields.hpp"
#include "kernel/results/nodal_stress.hpp"
#include "kernel/results/stress_groups.hpp"

namespace suture {
namespace {

using On = FieldChoice::On;

constexpr double no_tensor = std::numeric_limits<double>::quiet_NaN();

HexahedronNodes positions(const CellComplex& complex, const Column& column, Index element) {
  HexahedronNodes x;
  for (std::size_t n = 0; n < x.size(); ++n) {
    const double* row = column.rows() + std::size_t{4} * complex.vertices_of(element)[n];
    x[n] = {row[0], row[1], row[2]};
  }
  return x;
}

SymmetricTensor strain_of(BuiltScene& built, Index element) {
  const CellComplex& complex = built.body().complex();
  Attributes& attributes = built.body().attributes();
  const HexahedronNodes rest = attributes.rest_places(complex).of(element);
  const PartMoments* const part = attributes.parts().of(element);
  return green_lagrange(mean_gradient(positions(complex, attributes.position(), element),
                                      reciprocals(mean_edges(rest, part)), part));
}

/// Descending; NaN for a tensor that is not finite.
Vec3 principal_values(const SymmetricTensor& t) {
  if (!std::ranges::all_of(t, [](double c) { return std::isfinite(c); }))
    return {no_tensor, no_tensor, no_tensor};
  Eigen::Matrix3d matrix;
  matrix << t[0], t[3], t[5], t[3], t[1], t[4], t[5], t[4], t[2];
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(matrix, Eigen::EigenvaluesOnly);
  const Eigen::Vector3d& ascending = solver.eigenvalues();
  return {ascending[2], ascending[1], ascending[0]};
}

// sqrt(3/2 s:s) with the deviator s
double von_mises(const SymmetricTensor& t) {
  const double mean = (t[0] + t[1] + t[2]) / 3;
  double diagonal = 0, off = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    diagonal += (t[a] - mean) * (t[a] - mean);
    off += t[3 + a] * t[3 + a];
  }
  return std::sqrt(1.5 * (diagonal + 2 * off));
}

SymmetricTensor row(const FrameField& field, std::size_t i) {
  SymmetricTensor tensor;
  std::copy_n(field.values.data() + 6 * i, 6, tensor.begin());
  return tensor;
}

FieldChoice strain() {
  FieldChoice field{"strain", On::cells, false, {}};
  field.components = 6;
  field.value = [](BuiltScene& built, const Vec3&, Index e, int c) {
    return strain_of(built, e)[static_cast<std::size_t>(c)];
  };
  field.fill = [](const FieldRequest& at, FrameField& out) {
    const ShownCells elements = at.elements();
    out.components = 6;
    out.values.assign(std::size_t{6} * elements.size(), no_tensor);
    for (Index i = 0; i < elements.size(); ++i)
      if (at.complex().exists(3, elements[i]))
        std::ranges::copy(strain_of(at.built, elements[i]), out.values.data() + std::size_t{6} * i);
  };
  return field;
}

FieldChoice principal(const FieldChoice& tensor, std::string name) {
  FieldChoice field{std::move(name), tensor.on, tensor.needs_force, {}};
  field.runs_functors = tensor.runs_functors;
  field.components = 3;
  field.principal = true;
  field.unit = tensor.unit;
  field.fill = [fill = tensor.fill](const FieldRequest& at, FrameField& out) {
    FrameField tensors;
    fill(at, tensors);
    const std::size_t count = tensors.values.size() / 6;
    out.components = 3;
    out.values.resize(3 * count);
    for (std::size_t i = 0; i < count; ++i)
      std::ranges::copy(principal_values(row(tensors, i)), out.values.data() + 3 * i);
  };
  return field;
}

/// The stresses of the wanted elements, by element; the rows of others take no memory.
ZeroedVector<double> by_element(const FieldRequest& at, const FrameField& stress) {
  ZeroedVector<double> rows(std::size_t{6} * at.complex().element_count());
  const ShownCells elements = at.elements();
  for (Index i = 0; i < elements.size(); ++i)
    std::ranges::copy(row(stress, i), rows.data() + std::size_t{6} * elements[i]);
  return rows;
}

FieldChoice stress_at_nodes(const FieldChoice& stress) {
  FieldChoice field{"nodal_stress", On::points, stress.needs_force, {}};
  field.runs_functors = true;
  field.components = 6;
  field.unit = stress.unit;
  field.from = FieldChoice::From::near;
  field.fill = [fill = stress.fill](const FieldRequest& at, FrameField& out) {
    PieceCells near;
    FieldRequest around = at;
    if (at.piece) {
      near.elements = at.piece->elements_near(at.complex());
      around.piece = &near;
    }
    FrameField elements;
    fill(around, elements);
    ZeroedVector<double> rows;
    if (at.piece) rows = by_element(around, elements);
    const std::span<const double> stresses =
        at.piece ? std::span<const double>(rows) : elements.values;
    out.components = 6;
    out.values =
        nodal_stress(at.complex(), at.attributes().position(), stresses,
                     stress_groups(at.complex(), at.attributes(), stresses, around.elements()),
                     at.built.body().models().workers(), at.vertices());
  };
  return field;
}

FieldChoice von_mises_at_nodes(const FieldChoice& at_nodes) {
  FieldChoice field = at_nodes;
  field.name = "nodal_von_mises";
  field.components = 1;
  field.fill = [fill = at_nodes.fill](const FieldRequest& at, FrameField& out) {
    FrameField tensors;
    fill(at, tensors);
    out.components = 1;
    out.values.resize(tensors.values.size() / 6);
    for (std::size_t v = 0; v < out.values.size(); ++v) out.values[v] = von_mises(row(tensors, v));
  };
  return field;
}

}  // namespace

std::vector<FieldChoice> strain_fields() {
  const FieldChoice tensor = strain();
  FieldChoice values = principal(tensor, "principal_strain");
  values.value = [](BuiltScene& built, const Vec3&, Index e, int c) {
    return principal_values(strain_of(built, e))[static_cast<std::size_t>(c)];
  };
  return {tensor, values};
}

std::vector<FieldChoice> fields_of_stress(const std::vector<FieldChoice>& fields) {
  const auto stress = std::ranges::find_if(fields, [](const FieldChoice& f) {
    return f.name == "stress" && f.on == On::cells && f.components == 6;
  });
  if (stress == fields.end()) return {};
  const FieldChoice at_nodes = stress_at_nodes(*stress);
  return {principal(*stress, "principal_stress"), at_nodes, von_mises_at_nodes(at_nodes)};
}

}  // namespace suture
