// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/topology/import.hpp"

/// A small model written as C tables, so that the loops are tested without any
/// plugin: springs on edges and on the four inner diagonals of elements, and one
/// functor per shape of element. Forces are plain formulas; reference_forces()
/// computes the same with one cell at a time.
namespace spring_model {

enum Parameter { edge_stiffness, edge_damping, diagonal_stiffness, density, fail_from, fail_how };

const suture_model& model();

/// A block with optionally distorted elements and an instance on a region.
struct Body {
  explicit Body(suture::BoxOptions box, bool distorted = false);
  /// `skip`: leave out what adds nothing.
  suture::Instance& add(std::vector<double> parameters, std::vector<suture::Index> region = {},
                        bool skip = true);
  void initialise();
  /// Positions moved and velocities set at random (seeded), up to `amount`.
  void shake(double amount, unsigned seed);
  /// Cuts `count` inner faces chosen at random.
  suture::TopologyChange cut_random(unsigned count, unsigned seed);

  suture::Diagnostics diagnostics;
  suture::Imported mesh;
  std::unique_ptr<suture::Attributes> attributes;
};

/// Parameters: all springs on, no damping, density 1000, never failing.
std::vector<double> defaults();

/// Forces of one instance, cell after cell, straight from the complex.
std::vector<suture::Vec3> reference_forces(Body& body, suture::Instance& instance);

double reference_energy(Body& body, suture::Instance& instance);

}  // namespace spring_model
