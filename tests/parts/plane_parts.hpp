// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <random>
#include <span>
#include <vector>

#include "kernel/mesh/box.hpp"
#include "kernel/mesh/mesh.hpp"

/// Bodies cut out of grids for tests, by means that the kernel does not use: every element is six
/// tetrahedra, which are clipped one level set after the other.
namespace parts_test {

using suture::Index;
using suture::Mesh;
using suture::PartMoments;
using suture::Vec3;

using Tetrahedron = std::array<Vec3, 4>;
/// Negative in the material; exact if it is linear in each tetrahedron.
using Level = std::function<double(const Vec3&)>;

/// n . x - d
Level half_space(const Vec3& normal, const Vec3& point);

/// The material of the cube [-1, 1]^3.
std::vector<Tetrahedron> clipped_cube(std::span<const Level> levels);
double volume(const Tetrahedron& t);
/// The moments of a part in [-1, 1]^3, from exact integrals over its tetrahedra.
PartMoments moments_of(std::span<const Tetrahedron> part);
/// The integral over a part of the gradient in the cube of shape function `node`, exact: a
/// quadrature of degree 2 on each tetrahedron.
Vec3 gradient_integral(std::span<const Tetrahedron> part, int node);

/// The levels as functions of the place in the cube of an element.
std::vector<Level> local_levels(std::span<const Level> levels, const Vec3& low, const Vec3& size);

/// A box of which only the material between the level sets is kept: elements without any are left
/// out, the others are parts or full.
Mesh cut_box(const suture::BoxOptions& box, std::span<const Level> levels);
/// The same of any mesh, in which level sets are linear in the tetrahedra of reference cubes.
Mesh cut_mesh(Mesh mesh, std::span<const Level> levels);
/// Moves all points at random by up to `most` along each axis, at an end of the x axis in its
/// plane.
Mesh warped(Mesh mesh, double most);
/// The volume of the material of a mesh of boxes, m^3.
double volume(const Mesh& mesh);

double between(std::mt19937_64& random, double low, double high);
/// A plane through a random point of the box.
Level random_plane(std::mt19937_64& random, const Vec3& size);

}  // namespace parts_test
