// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/python/python_term.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>

#include "kernel/base/box.hpp"
#include "kernel/base/error.hpp"

namespace suture::python {
namespace {

constexpr double difference = 1e-6;  // of the body's size: half the digits of a double
constexpr int power_iterations = 12;
constexpr double power_margin = 1.2;  // of an eigenvalue that they approach from below

double size_of(Attributes& attributes) {
  Box box = no_box;
  const double* row = attributes.rest().rows();
  for (Index v = 0; v < attributes.vertex_count(); ++v, row += 4)
    include(box, {row[0], row[1], row[2]});
  return std::hypot(box.length(0), box.length(1), box.length(2));
}

/// Adds 3 numbers per vertex to rows of 4.
void add_to_rows(const std::vector<double>& f, const LiveMask& live, double* rows) {
  for (std::size_t v = 0; 3 * v < f.size(); ++v)
    if (live[static_cast<Index>(v)])
      for (std::size_t c = 0; c < 3; ++c) rows[4 * v + c] += f[3 * v + c];
}

double largest_of(const double* values, std::size_t count) {
  double largest = 0;
  for (std::size_t i = 0; i < count; ++i) largest = std::max(largest, std::abs(values[i]));
  return largest;
}

}  // namespace

PythonTerm::PythonTerm(PythonForce force, Attributes& attributes)
    : force_(std::move(force)), attributes_(attributes), size_(size_of(attributes)) {
  report_->name = force_.name;
}

PythonTerm::PythonTerm(const PythonTerm& other, Attributes& attributes)
    : force_(other.force_),
      attributes_(attributes),
      size_(size_of(attributes)),
      has_functions_(false),
      report_(other.report_) {}

// ----------------------------------------------------------------- the call --

PythonTerm::Array PythonTerm::copy_of(const Column& column) const {
  Array array({static_cast<py::ssize_t>(attributes_.vertex_count()), py::ssize_t{3}});
  double* to = array.mutable_data();
  const double* row = column.rows();
  for (Index v = 0; v < attributes_.vertex_count(); ++v, row += 4, to += 3) std::copy_n(row, 3, to);
  return array;
}

PythonTerm::Array PythonTerm::call(const Array& x, const Array& v, double time) {
  const auto start = std::chrono::steady_clock::now();
  Array f({x.shape(0), py::ssize_t{3}});
  std::fill_n(f.mutable_data(), f.size(), 0.0);
  const py::object result = force_.force(x, v, time, f);
  if (!result.is_none() && !result.is(f))
    throw py::type_error("the force function '" + force_.name +
                         "' returned a value; add the forces to its last argument, f[...] += ..., "
                         "and return nothing");
  ++report_->calls;
  report_->seconds +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double* values = f.data();
  const auto bad = std::find_if_not(values, values + f.size(),
                                    [](double value) { return std::isfinite(value); });
  if (bad != values + f.size())
    throw py::value_error("the force function '" + force_.name +
                          "' gave a force that is not finite, on vertex " +
                          std::to_string((bad - values) / 3) + "; no step was made");
  return f;
}

/// 3 numbers per vertex, at the current state; empty without functions.
std::vector<double> PythonTerm::evaluate(double time) {
  if (!has_functions_) return {};
  const py::gil_scoped_acquire lock;
  const Array f = call(copy_of(attributes_.position()), copy_of(attributes_.velocity()), time);
  return {f.data(), f.data() + f.size()};
}

void PythonTerm::add_forces(double time, const LiveMask& live, double* rows) {
  add_to_rows(evaluate(time), live, rows);
}

void PythonTerm::add_forces_in_step(const StepTimes& step, const LiveMask& live, double* rows) {
  const std::vector<double> f = evaluate(step.time);
  add_to_rows(f, live, rows);
  if (!force_.energy) book_work(f);
}

/// Around operations, which an exception must not interrupt: the next step raises it.
void PythonTerm::add_forces_at(const VertexSelection&, std::span<const Index> vertices, double time,
                               std::vector<Vec3>& forces) {
  std::vector<double> f;
  try {
    f = evaluate(time);
  } catch (const std::exception& error) {
    throw NumericalError(error.what());
  }
  if (f.empty()) return;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) forces[i][c] += f[3 * std::size_t{vertices[i]} + c];
}

// --------------------------------------------------------------- derivatives --

/// (f(x + h dx d, v + h dv d) - f(x - h dx d, v - h dv d)) / 2h
void PythonTerm::add_tangent(const double* d, double dx, double dv, const TangentTime& at,
                             double* out) {
  const std::size_t count = 3 * std::size_t{attributes_.vertex_count()};
  const double largest = largest_of(d, count) * std::max(std::abs(dx), std::abs(dv));
  if (!has_functions_ || largest == 0) return;
  const double h = difference * size_ / largest;
  const py::gil_scoped_acquire lock;
  for (const double side : {1.0, -1.0}) {
    Array x = copy_of(attributes_.position()), v = copy_of(attributes_.velocity());
    double *to_x = x.mutable_data(), *to_v = v.mutable_data();
    for (std::size_t i = 0; i < count; ++i) {
      to_x[i] += side * h * dx * d[i];
      to_v[i] += side * h * dv * d[i];
    }
    const Array f = call(x, v, at.time);
    for (std::size_t i = 0; i < count; ++i) out[i] += side * f.data()[i] / (2 * h);
  }
}

void PythonTerm::add_tangent_for_step(const double* d, double dx, double dv, const TangentTime& at,
                                      double* out) {
  if (!force_.stiffness) return add_tangent(d, dx, dv, at, out);
  const std::size_t count = 3 * std::size_t{attributes_.vertex_count()};
  for (std::size_t i = 0; i < count; ++i) out[i] -= *force_.stiffness * dx * d[i];
}

/// The largest eigenvalue of -df/dx, by power iteration from a random direction.
double PythonTerm::largest_stiffness(double time) {
  std::mt19937 random;  // the same direction in every run
  std::vector<double> d(3 * std::size_t{attributes_.vertex_count()}), image(d.size());
  for (double& value : d) value = (random() - 2147483647.5) / 4294967296.0;
  double length = 0;
  for (int i = 0; i < power_iterations; ++i) {
    std::fill(image.begin(), image.end(), 0.0);
    add_tangent(d.data(), 1, 0, {time}, image.data());
    double squared = 0, before = 0;
    for (std::size_t k = 0; k < d.size(); ++k) {
      squared += image[k] * image[k];
      before += d[k] * d[k];
    }
    length = std::sqrt(squared / before);
    if (!(length > 0)) return 0;
    d.swap(image);
  }
  return power_margin * length;
}

void PythonTerm::add_bounds(double time, const AddBounds& sums) {
  bound_ = force_.stiffness ? *force_.stiffness : largest_stiffness(time);
  const double k[6] = {bound_, bound_, bound_, 0, 0, 0}, c[6] = {};
  for (Index v = 0; v < attributes_.vertex_count(); ++v) sums(v, k, c);
}

/// An operation moves no vertex: the bound of before holds.
void PythonTerm::add_bounds_at(const VertexSelection&, std::span<const Index> vertices, double,
                               const AddBounds& sums) {
  const double k[6] = {bound_, bound_, bound_, 0, 0, 0}, c[6] = {};
  for (const Index v : vertices) sums(v, k, c);
}

// ------------------------------------------------------------ energy and work --

double PythonTerm::energy(double time) {
  if (!force_.energy || !has_functions_) return 0;
  const py::gil_scoped_acquire lock;
  const auto value = (*force_.energy)(copy_of(attributes_.position()), time).cast<double>();
  if (std::isfinite(value)) return value;
  throw py::value_error("the energy of the force function '" + force_.name + "' is not finite");
}

/// W += (f + f') . (x' - x) / 2, which is 0 for a second call in the same state.
void PythonTerm::book_work(const std::vector<double>& forces) {
  std::vector<double> x(forces.size());
  const double* row = attributes_.position().rows();
  for (std::size_t v = 0; 3 * v < x.size(); ++v) std::copy_n(row + 4 * v, 3, &x[3 * v]);
  if (last_x_.size() == x.size())
    for (std::size_t i = 0; i < x.size(); ++i)
      report_->work += (last_f_[i] + forces[i]) / 2 * (x[i] - last_x_[i]);
  last_x_ = std::move(x);
  last_f_ = forces;
}

void PythonTerm::book(double time) {
  if (!force_.energy && has_functions_) book_work(evaluate(time));
}

void PythonTerm::restart() {
  report_->work = 0;
  forget_last();
}

void PythonTerm::state(Archive& archive) {
  archive("work", report_->work);
  archive("bound", bound_);
  archive("last positions", last_x_);
  archive("last forces", last_f_);
}

int PythonTerm::traverse(visitproc visit, void* argument) const {
  if (!has_functions_) return 0;
  if (const int stop = visit(force_.force.ptr(), argument)) return stop;
  return force_.energy ? visit(force_.energy->ptr(), argument) : 0;
}

void PythonTerm::clear() {
  has_functions_ = false;
  force_.force = py::function();
  force_.energy.reset();
}

}  // namespace suture::python
