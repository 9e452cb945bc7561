// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/contact/surface_points.hpp"

namespace suture {

/// The contacts of a step in flat arrays, for sweeps of Gauss and Seidel over points that are
/// combinations of vertices. Velocities are changes since the sweeps began.
///
/// A contact with a plane pushes along a normal n that does not change in the step:
///   dv_n = max(0, lacking - n . v),   dv_t = - u_t min(1, mu dv_n / |u_t|)
/// with v the change of the velocity of the point by all other contacts. Other contacts are pushed
/// by the caller (change_by_others(), set_change()).
class PointSweeps {
 public:
  using Row = std::array<double, 4>;  ///< the last is 0
  static Row row_of(const Vec3& a) { return {a[0], a[1], a[2], 0}; }
  static Vec3 vec_of(const Row& a) { return {a[0], a[1], a[2]}; }
  /// Two lines of a cache hold all that a sweep needs of a vertex.
  struct alignas(64) Vertex {
    Row change;        ///< m/s
    Row inverse_mass;  ///< 0 in components that are held, 1/kg
  };
  /// Rows are aligned as clang takes references to vectors of four doubles to be.
  struct alignas(32) Contact {
    Row velocity{};  ///< relative to the obstacle before the sweeps, m/s
    Row normal{};
    Row mass{};    ///< by component; where the point is fixed, as if it were free, kg
    Row change{};  ///< what it does to the velocity of the point, m/s
    double lacking = 0,
           friction = 0;              ///< the gap that it lacks before the sweeps, over dt, m/s
    double pressed = 0, sliding = 0;  ///< dv_n and |u_t|, m/s
    const Index* vertices = nullptr;
    const double* weights = nullptr;
    std::uint32_t count = 0;  ///< of these
    std::uint8_t fixed = 0;   ///< bits of components in which hardly anything is free
    bool is_plane = false;
  };
  /// What a sweep has changed: the largest squared, m^2/s^2; the norm by the energy, and that of
  /// all that the contacts do now, J.
  struct Changes {
    double largest = 0, energy = 0, all = 0;
  };

  void clear(Index vertex_count) {
    contacts.clear();
    vertices.resize(vertex_count);
  }
  /// Call before the contacts of a vertex are added. `held`: bits.
  void add_vertex(Index vertex, double mass, unsigned held);
  /// After its vertices, whose masses (kg) are given.
  void add(const ContactPoint& point, const double* masses);

  /// Sweeps over contacts with planes.
  void sweep(std::span<const std::uint32_t> order, Changes& changes);
  Vec3 change_by_others(const Contact& contact) const;
  /// Replaces what a contact does.
  void set_change(Contact& contact, const Vec3& change, Changes& changes);
  /// Adds to it, without a law.
  void add_change(Contact& contact, const Vec3& change);

  /// Conjugate gradients: keep() before a sweep; go_on() after it goes on by `factor` times the
  /// direction so far, then adds the changes of the sweep to the direction.
  void begin_directions(std::span<const std::uint32_t> order, std::span<const Index> of_vertices);
  void keep(std::span<const std::uint32_t> order, std::span<const Index> of_vertices);
  void go_on(double factor, std::span<const std::uint32_t> order,
             std::span<const Index> of_vertices);

  std::vector<Vertex> vertices;  ///< of the body
  std::vector<Contact> contacts;

 private:
  struct alignas(32) Direction {
    Row direction{}, before{};
  };
  std::vector<Direction> of_vertices_, of_contacts_;
};

}  // namespace suture
