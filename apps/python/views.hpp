// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/numpy.h>

#include <unordered_map>

#include "kernel/dynamics/body.hpp"

namespace suture::python {

namespace py = pybind11;

/// Columns of a body as numpy arrays on the kernel's own memory, read-only.
///
/// An array never dangles: before an operation, and when the simulation ends, the memory of every
/// column of which Python still holds an array is handed over to that array, which from then on
/// keeps the values of that moment; the column continues on a copy. A column of which nobody holds
/// an array is not copied.
class Views final : private Follower {
 public:
  explicit Views(Body& body);
  ~Views() override;
  Views(const Views&) = delete;
  Views& operator=(const Views&) = delete;

  /// The array of a column: (n, components) on vertices; (n,) for one component; on edges, faces
  /// and elements with several components (blocks, 8, components), row r at [r // 8, r % 8].
  /// A column with a trial copy, which changes its memory in every step, is copied.
  py::array of(Column& column);
  /// Arrays that Python holds keep their values from now on, whatever happens to the columns.
  void hand_over();

 private:
  struct Memory;
  struct View {
    py::array array;
    Memory* memory = nullptr;  ///< owned by the array
    const double* data = nullptr;
    Index size = 0;
  };
  void before(const ComingOperation& operation) override;
  void follow(const CellComplex&, const TopologyChange&) override {}
  static View make(Column& column);

  std::unordered_map<Column*, View> views_;
};

}  // namespace suture::python
