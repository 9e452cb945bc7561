// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/python/views.hpp"

#include <memory>

namespace suture::python {
namespace {

const double* data_of(Column& column) {
  return column.dimension() == 0 ? column.rows() : std::as_const(column).block(0);
}

struct Layout {
  std::vector<py::ssize_t> shape, strides;  ///< in bytes
};

Layout layout_of(const Column& column) {
  constexpr py::ssize_t bytes = sizeof(double), lanes = Column::lanes;
  const auto size = static_cast<py::ssize_t>(column.size());
  const auto components = static_cast<py::ssize_t>(column.spec().components);
  if (column.dimension() == 0) {
    const py::ssize_t row = column.stride() * bytes;
    if (components == 1) return {{size}, {row}};
    return {{size, components}, {row, bytes}};
  }
  if (components == 1) return {{size}, {column.is_constant() ? 0 : bytes}};
  const auto blocks = static_cast<py::ssize_t>(column.block_count());
  return {{blocks, lanes, components},
          {column.is_constant() ? 0 : components * lanes * bytes, bytes, lanes * bytes}};
}

}  // namespace

/// What an array refers to once its column has moved on.
struct Views::Memory {
  Column::Values kept;
};

Views::Views(Body& body) { body.add_follower(*this); }

Views::~Views() { hand_over(); }

py::array Views::of(Column& column) {
  if (column.has_trial()) {
    const Layout layout = layout_of(column);
    return {py::dtype::of<double>(), layout.shape, layout.strides, data_of(column)};
  }
  View& view = views_[&column];
  if (!view.array || view.data != data_of(column) || view.size != column.size())
    view = make(column);
  return view.array;
}

Views::View Views::make(Column& column) {
  View view;
  auto memory = std::make_unique<Memory>();
  view.memory = memory.get();
  view.data = data_of(column);
  view.size = column.size();
  const py::capsule owner(memory.release(), [](void* m) { delete static_cast<Memory*>(m); });
  const double* data = view.data;
  if (column.is_constant()) {  // it moves when a value is set, and a copy costs nothing
    view.memory->kept.assign(data, data + column.spec().components * Column::lanes);
    data = view.memory->kept.data();
  }
  const Layout layout = layout_of(column);
  view.array = py::array(py::dtype::of<double>(), layout.shape, layout.strides, data, owner);
  py::detail::array_proxy(view.array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return view;
}

void Views::before(const ComingOperation&) {
  if (!views_.empty()) hand_over();
}

void Views::hand_over() {
  const py::gil_scoped_acquire lock;
  for (auto& [column, view] : views_) {
    const bool is_held = view.array && view.array.ref_count() > 1;
    if (is_held && view.memory->kept.empty()) view.memory->kept = column->hand_over();
  }
  views_.clear();
}

}  // namespace suture::python
