// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/dynamics/body.hpp"
#include "kernel/mesh/box.hpp"

/// A small model written as C tables, so that the loops are tested without any
/// plugin: springs on edges and on the four inner diagonals of elements, and one
/// functor per shape of element. Forces are plain formulas; reference_forces()
/// computes the same with one cell at a time.
namespace spring_model {

enum Parameter { edge_stiffness, edge_damping, diagonal_stiffness, density, fail_from, fail_how };

const suture_model& model();

/// A box of cubes with edges of 0.1.
suture::BoxOptions box(suture::Index x, suture::Index y, suture::Index z);

/// A block with optionally distorted elements and an instance on a region.
struct Body : suture::Body {
  explicit Body(const suture::BoxOptions& box, bool distorted = false);
  using suture::Body::add;
  /// `skip`: leave out what adds nothing.
  suture::Instance& add(std::vector<double> parameters, std::vector<suture::Index> region = {},
                        bool skip = true);
  void compile(unsigned threads = 0) { suture::Body::compile(diagnostics, threads); }
  /// Positions moved and velocities set at random (seeded), up to `amount`.
  void shake(double amount, unsigned seed);
  /// Cuts `count` inner faces chosen at random.
  suture::TopologyChange cut_random(unsigned count, unsigned seed);

  suture::Diagnostics diagnostics;
};

/// Vertices whose rest position has the component `where`.
std::vector<suture::Index> vertices_at(suture::Body& body, int axis, double where);
std::vector<suture::Index> all_vertices(const suture::Body& body);
/// A dart of every face of the boundary.
std::vector<suture::Dart> boundary_faces(const suture::Body& body);
/// The volume of all elements as they are now, m^3.
double volume(suture::Body& body);

/// Rows of 4 that the loop adds, also left in the column `force`.
std::vector<double> forces_of(suture::Body& body, suture::ForceLoop& loop);
/// The largest of a component, over the largest of the reference.
double largest_difference(const std::vector<double>& rows,
                          const std::vector<suture::Vec3>& reference);

/// Parameters: all springs on, no damping, density 1000, never failing.
std::vector<double> defaults();

/// Springs on edges only, with damping: the diagonals offer neither energy nor bounds.
std::vector<double> edges_only();

/// Two regions that overlap, cuts and holes, in a deformed state; of edges_only().
struct Worn : Body {
  Worn();
};

/// Forces of one instance, cell after cell, straight from the complex.
std::vector<suture::Vec3> reference_forces(Body& body, suture::Instance& instance);

double reference_energy(Body& body, suture::Instance& instance);

}  // namespace spring_model
