// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/forces/time_ramp.hpp"
#include "kernel/forces/vertex_selection.hpp"

namespace suture {

class Archive;

/// External forces besides gravity. Every load is kept per corner of an element,
/// which no cut changes: a vertex receives what the corners of its elements
/// carry, so the parts of a split vertex share its load in proportion to their
/// volumes and the total stays; vertices that are sewn add up. What a removed element
/// carried is gone with it. A traction or a pressure on a face that is sewn ends there,
/// for good: a cut that opens the face again makes another surface.
class Loads {
 public:
  /// `total` newtons on `vertices`: shared in proportion to the boundary area
  /// around each (faces all of whose vertices are in the set), or equally if the
  /// set holds a vertex without such a face. Throws InputError for no vertices.
  void add_force(const CellComplex& complex, Attributes& attributes,
                 std::span<const Index> vertices, const Vec3& total, const TimeRamp& ramp);

  /// Force per rest area (Pa) on faces, whose direction and amount stay: a dead
  /// load. `faces`: any dart of each, on the side of the element that carries it.
  /// Throws InputError for no faces.
  void add_traction(const CellComplex& complex, Attributes& attributes, std::span<const Dart> faces,
                    const Vec3& traction, const TimeRamp& ramp);

  /// Pressure (Pa, positive inward) on faces, normal to them as they deform.
  ///   f_a = p  integral of N_a  dx/dr x dx/ds  dr ds,   2 x 2 points: exact
  void add_pressure(const CellComplex& complex, std::span<const Dart> faces, double pressure,
                    const TimeRamp& ramp);

  /// Adds all loads at `time` to `rows` (4 per vertex) of the vertices that are `live`.
  /// O(loaded vertices, faces).
  void add_to(double* rows, const double* position, double time, const LiveMask& live = {}) const;

  /// Adds what they give at the vertices of a selection to `forces`, in its order.
  /// O(selected log loaded, faces).
  void add_at(const VertexSelection& selection, std::span<const Index> vertices,
              const double* position, double time, std::vector<Vec3>& forces) const;

  /// The same, and books the work since the last call by the trapezoid: forces of both times
  /// times the way between them.
  void add_and_book(double* rows, const double* position, double time, const LiveMask& live);

  /// The work that loads have done, and what booking it needs of the last call.
  struct Book {
    struct Dead {
      double value = 0, ramp = 0;  ///< sum f . (x - X), and the ramp
    };
    struct Face {
      std::array<Vec3, 4> position, force;
    };
    double dead = 0, pressure = 0;  ///< J since the start: forces and tractions; pressures
    std::vector<Dead> of_dead;      ///< by load; empty before the first call
    std::vector<std::vector<Face>> of_pressure;
    void state(Archive& archive);
  };
  const Book& book() const { return book_; }
  void set_book(Book book) { book_ = std::move(book); }
  /// Positions or faces jump: nothing is booked between the last call and the next.
  void forget_last() { book_.of_dead.clear(), book_.of_pressure.clear(); }

  /// Potential of the dead loads, - sum f . (x - X) over the corners, J. A pressure
  /// that follows the surface has none.
  double potential(const double* position, double time) const;

  /// After a change: corners have other vertices. O(corners loaded).
  void update(const RestPlaces& rest);

  /// To be loaded where the same loads were added. Of a motion the book alone.
  void state(Archive& archive);

  bool empty() const { return dead_.empty() && pressures_.empty(); }
  bool has_pressure() const { return !pressures_.empty(); }
  double settled_after() const;  ///< time when the last ramp ends, s

 private:
  struct Corner {
    Index element;
    std::uint32_t node;
    Vec3 force;
    Dart face = none;  ///< whose boundary carries it, if it is on one
  };
  struct Nodal {
    Index vertex;
    Vec3 force;
    double at_rest;  ///< sum of f . X
  };
  struct DeadLoad {
    std::vector<Corner> corners;
    std::vector<Nodal> nodal;  ///< the same, summed per vertex as they are now
    TimeRamp ramp;
    void state(Archive& archive);
  };
  struct PressureLoad {
    double pressure;
    std::vector<Dart> faces;
    std::vector<std::array<Index, 4>> nodes;  ///< as they are now
    TimeRamp ramp;
    void state(Archive& archive);
  };

  static void add_at_vertex(DeadLoad& load, const RestPlaces& rest, Index vertex,
                            const Vec3& force);
  static void sum_corners(DeadLoad& load, const RestPlaces& rest);

  static double value(const DeadLoad& load, const double* position);
  void book_dead(const double* position, double time);
  /// on_face(load, face, corner forces) for each face under pressure.
  template <class OnFace>
  void add(double* rows, const double* position, double time, const LiveMask& live,
           OnFace on_face) const;
  /// visit(face number, corner forces) for each face of a pressure.
  template <class Visit>
  static void for_each_face(const PressureLoad& load, const double* position, double time,
                            Visit visit);

  std::vector<DeadLoad> dead_;
  std::vector<PressureLoad> pressures_;
  Book book_;
};

}  // namespace suture
