// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rates of fields: conservation, derivatives, and what operations leave of the content.
#include <algorithm>
#include <cmath>
#include <random>

#include "kernel/model_check/checks.hpp"

namespace suture::checks {
namespace {

using Values = AlignedVector<double>;

/// What rates are differentiated by: a vertex column of the functor, in the tangent dx or dv.
struct Variable {
  std::size_t column;
  std::size_t components;
  bool is_rate;  ///< of the field (SUTURE_FIELD_RATE), not its value
};

std::vector<Variable> variables_of(const suture_model& model, const suture_functor& functor) {
  std::vector<Variable> variables;
  for (std::size_t i = 0; i < functor.vertex_column_count; ++i) {
    const std::uint32_t a = functor.vertex_columns[i];
    if (a == UINT32_MAX) continue;
    const std::size_t components = model.attributes[a].components;
    if (a == functor.field - 1) variables.push_back({i, components, false});
    if ((model.attributes[a].flags & SUTURE_FIELD_RATE) != 0)
      variables.push_back({i, components, true});
  }
  return variables;
}

/// Whether the deformation feeds the field: elements that are a little larger have other rates.
/// Most functors read positions because that is the default.
bool feels_motion(BatchCaller& caller, const CellBatch& batch, const Values& rates) {
  CellBatch larger = batch;
  for (Values* values : {&larger.position, &larger.velocity})
    for (double& value : *values) value *= 1.015625;
  return caller.force(larger).force != rates;
}

/// The sum of the rates of a cell over the largest; those on vertices are sources.
Measured imbalance(const CellBatch& batch, const Values& rates) {
  Measured worst;
  for (std::size_t i = 0; i < 3 * batch.valid; ++i) {
    const std::size_t lane = i / 3;
    double sum = 0, largest = 0;
    for (std::size_t n = 0; n < batch.nodes(); ++n) {
      const double rate = rates[CellBatch::place(n, i % 3, lane)];
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

/// What the field loses in a cell that does not move, against the power that it dissipates:
///   sum_n u_n r_n = - D
Measured dissipation_error(BatchCaller& caller, const CellBatch& moving) {
  const auto* table = extension_of<suture_dissipation_1>(*moving.functor, SUTURE_DISSIPATION_1);
  if (table == nullptr) return {};
  CellBatch batch = moving;
  std::ranges::fill(batch.velocity, 0.0);
  const suture_functor& functor = *batch.functor;
  const auto place = std::span(functor.vertex_columns, functor.vertex_column_count).begin();
  const auto column = static_cast<std::size_t>(
      std::find(place, place + functor.vertex_column_count, functor.field - 1) - place);
  const Values& field = batch.vertex_columns[column];
  const std::size_t components = field.size() / (batch.nodes() * SUTURE_LANES);
  const Values rates = caller.force(batch).force;
  const auto power = caller.dissipation(batch);
  Measured worst;
  for (std::size_t lane = 0; lane < batch.valid; ++lane) {
    double lost = 0, scale = std::abs(power[lane]);
    for (std::size_t i = 0; i < batch.nodes() * components; ++i) {
      const double part = field[i * SUTURE_LANES + lane] *
                          rates[CellBatch::place(i / components, i % components, lane)];
      lost -= part;
      scale = std::max(scale, std::abs(part));
    }
    if (scale > 0 && !(std::abs(lost - power[lane]) / scale <= worst.figure))
      worst = {std::abs(lost - power[lane]) / scale,
               "cell " + std::to_string(batch.ids[lane]) + " dissipates " +
                   std::to_string(power[lane]) + " W, and its field loses " + std::to_string(lost)};
  }
  return worst;
}

/// The derivatives by number `number` of the variable, node by node, by differences.
Values rate_difference(BatchCaller& caller, const CellBatch& batch, std::size_t column,
                       std::size_t number, double part) {
  const double step = part * std::max(1.0, largest(batch.vertex_columns[column]));
  const auto at = [&](double h) {
    CellBatch changed = batch;
    for (std::size_t l = 0; l < SUTURE_LANES; ++l)
      changed.vertex_columns[column][number * SUTURE_LANES + l] += h;
    return caller.force(changed).force;
  };
  Values slope = at(step);
  const Values back = at(-step);
  for (std::size_t i = 0; i < slope.size(); ++i) slope[i] = (slope[i] - back[i]) / (2 * step);
  return slope;
}

Values rate_tangent(BatchCaller& caller, const CellBatch& batch, const Variable& by,
                    std::size_t number) {
  const Values zero(batch.vector_size());
  Values unit = zero;
  for (std::size_t l = 0; l < SUTURE_LANES; ++l)
    unit[CellBatch::place(number / by.components, number % by.components, l)] = 1;
  return by.is_rate ? caller.tangent(batch, zero, unit) : caller.tangent(batch, unit, zero);
}

/// The tangent against differences over this part of the largest value, and its symmetry.
Measured tangent_error(BatchCaller& caller, const CellBatch& batch, const Variable& by,
                       double part) {
  std::vector<Values> tangents;
  double scale = 0;
  const std::size_t numbers = batch.nodes() * by.components;
  for (std::size_t n = 0; n < numbers; ++n) {
    tangents.push_back(rate_tangent(caller, batch, by, n));
    scale = std::max(scale, largest(tangents.back()));
  }
  Measured worst;
  if (scale == 0) return worst;
  const auto keep_worse = [&](const Measured& found) {
    if (!(found.figure <= worst.figure)) worst = found;
  };
  const auto place = [&](std::size_t number, std::size_t lane) {
    return CellBatch::place(number / by.components, number % by.components, lane);
  };
  for (std::size_t n = 0; n < numbers; ++n) {
    const Values expected = rate_difference(caller, batch, by.column, n, part);
    keep_worse(compare(batch, tangents[n], expected, scale, "the derivative of the rate"));
    for (std::size_t m = 0; m < n; ++m)
      for (std::size_t lane = 0; lane < batch.valid; ++lane)
        keep_worse({std::abs(tangents[n][place(m, lane)] - tangents[m][place(n, lane)]) / scale,
                    "the derivatives of the rates at nodes " + std::to_string(m / by.components) +
                        " and " + std::to_string(n / by.components) + " are not symmetric"});
  }
  return worst;
}

/// sum C u for each component of a field with a capacity.
std::vector<double> contents(SampleBody& sample) {
  std::vector<double> contents;
  for (const VertexField& field : sample.body().attributes().fields()) {
    if (!field.capacity) continue;
    for (int c = 0; c < field.values->spec().components; ++c) {
      contents.push_back(0);
      for (Index v = 0; v < field.values->size(); ++v)
        if (sample.body().complex().exists(0, v))
          contents.back() += field.capacity->get(v, 0) * field.values->get(v, c);
    }
  }
  return contents;
}

/// Everywhere, unless the parameters leave none to a field that follows the motion.
void require_capacities(SampleBody& sample) {
  const CellComplex& complex = sample.body().complex();
  for (const FieldEquation& equation : sample.body().fields()) {
    const VertexField& field = equation.field();
    if (!field.capacity) continue;
    bool has_some = false, has_none = false;
    for (Index v = 0; v < field.capacity->size(); ++v)
      if (complex.exists(0, v)) (field.capacity->get(v, 0) > 0 ? has_some : has_none) = true;
    if (has_none && (has_some || !equation.feels_motion()))
      throw BrokenLaw("the capacity of a node for '" + field.name + "' is not positive");
  }
}

/// (f(h) - f(-h)) / 2 h, where `column` has `direction` times h more. The column keeps its values.
template <class Values>
std::vector<double> difference(Column& column, int components, const std::vector<double>& direction,
                               double h, Values values) {
  const auto move = [&](double step) {
    for (std::size_t i = 0; i < direction.size(); ++i) {
      const auto row = static_cast<Index>(i / static_cast<std::size_t>(components));
      const auto c = static_cast<int>(i % static_cast<std::size_t>(components));
      column.set(row, c, column.get(row, c) + step * direction[i]);
    }
  };
  move(h);
  std::vector<double> slope = values();
  move(-2 * h);
  const std::vector<double> back = values();
  move(h);
  for (std::size_t i = 0; i < slope.size(); ++i) slope[i] = (slope[i] - back[i]) / (2 * h);
  return slope;
}

double product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

std::vector<double> random_values(std::size_t count, double size, std::mt19937_64& random) {
  std::vector<double> values(count);
  for (double& value : values) value = between(random, -size, size);
  return values;
}

}  // namespace

// The power that the motion gives to the field is what the field takes from the motion: with an
// energy E(x, u), f = -dE/dx and r = -dE/du, df/du and dr/dx are transposes; where r follows the
// velocity, df/du and -dr/dv are.
Result coupling(const BodyCase& of) {
  Body& body = of.sample.body();
  if (body.fields().empty() || !body.fields().front().feels_motion()) return {};
  of.sample.stop();
  FieldEquation& field = body.fields().front();
  Attributes& attributes = body.attributes();
  const double time = of.sample.options().time;
  const auto forces = [&] { return of.sample.forces(); };
  const auto rates = [&] {
    AlignedVector<double> rows(std::size_t{attributes.vertex_count()} * 4);
    field.rates().add_forces(time, 0, ForceLoop::Part::all, rows.data());
    std::vector<double> values;
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (i % 4 < field.components()) values.push_back(rows[i]);
    return values;
  };
  std::mt19937_64 random(of.sample.options().seed);
  const std::size_t count = attributes.vertex_count() * field.components();
  const auto way = random_values(std::size_t{3} * attributes.vertex_count(), 1, random),
             change = random_values(count, 1, random);
  constexpr double step = 1e-6;
  const double of_force =
      product(way, difference(*attributes.fields().front().values,
                              static_cast<int>(field.components()), change, 1e-4, forces));
  const double of_rate = product(change, difference(attributes.position(), 3, way, step, rates)) -
                         product(change, difference(attributes.velocity(), 3, way, 1, rates));
  const double scale = std::max(std::abs(of_force), std::abs(of_rate));
  if (scale == 0) return {};
  return Measured{std::abs(of_force - of_rate) / scale,
                  "the forces change with the field by " + std::to_string(of_force) +
                      ", the rates with the motion by " + std::to_string(of_rate)};
}

Result rates(const BatchCase& of) {
  const CellBatch& batch = of.batch;
  if (batch.functor->field == 0) return {};
  BatchCaller caller(of.instance);
  const Values values = caller.force(batch).force;
  const bool has_source = batch.functor->dimension == 0 || feels_motion(caller, batch, values);
  Measured worst = has_source ? Measured{} : imbalance(batch, values);
  if (const Measured lost = dissipation_error(caller, batch); !(lost.figure <= worst.figure))
    worst = lost;
  for (const Variable& by : variables_of(of.instance.model(), *batch.functor)) {
    // Beside a source by the motion, the rates of small changes are rounding.
    Measured found = tangent_error(caller, batch, by, 1e-4);
    for (const double part : {1e-2, 1.0, 1e2}) {
      const Measured longer = tangent_error(caller, batch, by, part);
      if (longer.figure < found.figure) found = longer;
    }
    if (!(found.figure <= worst.figure)) worst = found;
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
