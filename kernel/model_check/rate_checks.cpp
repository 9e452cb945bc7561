// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rates of fields: conservation, derivatives, and what operations leave of the content.
#include <algorithm>
#include <cmath>

#include "kernel/model_check/checks.hpp"

namespace suture::checks {
namespace {

using Values = AlignedVector<double>;

/// The place of the field among the vertex columns of its functor.
std::size_t field_column(const suture_functor& functor) {
  const std::span columns(functor.vertex_columns, functor.vertex_column_count);
  return static_cast<std::size_t>(std::ranges::find(columns, functor.field - 1) - columns.begin());
}

/// The sum of the rates of a cell over the largest; those on vertices are sources.
Measured imbalance(const CellBatch& batch, const Values& rates) {
  Measured worst;
  for (std::size_t lane = 0; lane < batch.valid; ++lane) {
    double sum = 0, largest = 0;
    for (std::size_t n = 0; n < batch.nodes(); ++n) {
      const double rate = rates[CellBatch::place(n, 0, lane)];
      sum += rate;
      largest = std::max(largest, std::abs(rate));
    }
    if (largest > 0 && !(std::abs(sum) / largest <= worst.figure))
      worst = {std::abs(sum) / largest, "the rates of the nodes of cell " +
                                            std::to_string(batch.ids[lane]) + " sum to " +
                                            std::to_string(sum) +
                                            ", not to zero (write a source as a functor on "
                                            "vertices)"};
  }
  return worst;
}

/// The derivatives by the field at node `node`, by differences.
Values rate_difference(BatchCaller& caller, const CellBatch& batch, std::size_t node) {
  const std::size_t column = field_column(*batch.functor);
  const double step = 1e-4 * std::max(1.0, largest(batch.vertex_columns[column]));
  const auto at = [&](double h) {
    CellBatch changed = batch;
    for (std::size_t l = 0; l < SUTURE_LANES; ++l)
      changed.vertex_columns[column][node * SUTURE_LANES + l] += h;
    return caller.force(changed).force;
  };
  Values slope = at(step);
  const Values back = at(-step);
  for (std::size_t i = 0; i < slope.size(); ++i) slope[i] = (slope[i] - back[i]) / (2 * step);
  return slope;
}

Values rate_tangent(BatchCaller& caller, const CellBatch& batch, std::size_t node) {
  const Values zero(batch.vector_size());
  Values unit = zero;
  for (std::size_t l = 0; l < SUTURE_LANES; ++l) unit[CellBatch::place(node, 0, l)] = 1;
  return caller.tangent(batch, unit, zero);
}

/// sum C u for each field with a capacity.
std::vector<double> contents(SampleBody& sample) {
  std::vector<double> contents;
  for (const VertexField& field : sample.body().attributes().fields()) {
    if (!field.capacity) continue;
    contents.push_back(0);
    for (Index v = 0; v < field.values->size(); ++v)
      if (sample.body().complex().exists(0, v))
        contents.back() += field.capacity->get(v, 0) * field.values->get(v, 0);
  }
  return contents;
}

void require_capacities(SampleBody& sample) {
  for (const VertexField& field : sample.body().attributes().fields())
    for (Index v = 0; field.capacity && v < field.capacity->size(); ++v)
      if (sample.body().complex().exists(0, v) && !(field.capacity->get(v, 0) > 0))
        throw BrokenLaw("the capacity of a node for '" + field.name + "' is not positive");
}

}  // namespace

Result rates(const BatchCase& of) {
  const CellBatch& batch = of.batch;
  if (batch.functor->field == 0) return {};
  BatchCaller caller(of.instance);
  const Values rates = caller.force(batch).force;
  Measured worst = batch.functor->dimension == 0 ? Measured{} : imbalance(batch, rates);
  std::vector<Values> tangents;
  double scale = 0;
  for (std::size_t n = 0; n < batch.nodes(); ++n) {
    tangents.push_back(rate_tangent(caller, batch, n));
    scale = std::max(scale, largest(tangents.back()));
  }
  if (scale == 0) return worst;
  const auto keep_worse = [&](const Measured& found) {
    if (!(found.figure <= worst.figure)) worst = found;
  };
  for (std::size_t n = 0; n < batch.nodes(); ++n) {
    const Values expected = rate_difference(caller, batch, n);
    keep_worse(compare(batch, tangents[n], expected, scale, "the derivative of the rate"));
    for (std::size_t m = 0; m < n; ++m)
      for (std::size_t lane = 0; lane < batch.valid; ++lane)
        keep_worse({std::abs(tangents[n][CellBatch::place(m, 0, lane)] -
                             tangents[m][CellBatch::place(n, 0, lane)]) /
                        scale,
                    "the derivatives of the rates at nodes " + std::to_string(m) + " and " +
                        std::to_string(n) + " are not symmetric"});
  }
  return worst;
}

// Every face inside is opened, and one is closed again between other values.
Result field_cut(const BodyCase& of) {
  Body& body = of.sample.body();
  const std::vector<double> whole = contents(of.sample);
  if (whole.empty()) return {};
  const std::vector<Dart> faces = of.sample.inner_faces();
  const Seam seam{faces.front(), body.complex().beta3(faces.front())};
  body.cut(faces);
  require_capacities(of.sample);
  const double lost_by_cut = relative_difference(contents(of.sample), whole);
  of.sample.vary_fields();
  const std::vector<double> open = contents(of.sample);
  body.sew({seam});
  const double lost_by_seam = relative_difference(contents(of.sample), open);
  if (!(lost_by_cut <= lost_by_seam))
    return Measured{lost_by_cut, "a cut changes the content of a field by this part"};
  return Measured{lost_by_seam, "a seam changes the content of a field by this part"};
}

}  // namespace suture::checks
