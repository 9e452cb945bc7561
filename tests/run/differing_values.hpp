// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <functional>

#include "kernel/build/built_scene.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/run/beam.hpp"

namespace suture::test {

/// x >= 0.5.
Selection right_half();
/// The place of a parameter in the model's list.
std::uint32_t index_of(const suture_model& model, const std::string& parameter);
/// Lets the model's parameter differ from element to element.
CellValues& vary(ModelUse& use, const std::string& parameter);
/// The beam without gravity, of mu = 100 kPa; the direction of its fibres is still to be given.
Scene fibres(Index nx, Index n, double k, double element = 1);
/// In equilibrium at time 1.
Scene statics(Scene scene);

/// A scene of a mesh file of four cubes with arrays; the values of a column of its only model.
class ColumnsOfMeshes : public testing::Test {
 protected:
  ColumnsOfMeshes();

  /// An array whose values follow from the place of a node, or of an element's first one.
  void add(const std::string& name, bool of_elements, std::size_t components,
           const std::function<double(const Vec3&, std::size_t)>& value);
  CellValues& use_array(const std::string& parameter, const std::string& array);
  std::vector<double> column(const std::string& name, int dimension = 3);
  /// By element, node or edge of the complex.
  static std::vector<double> values_of(Instance& instance, const std::string& name, int dimension);
  /// The error of building the scene; "" if there is none.
  std::string error();

  const TemporaryFolder folder_;
  Diagnostics diagnostics_;
  Mesh mesh_;
  Scene scene_;
};

}  // namespace suture::test
