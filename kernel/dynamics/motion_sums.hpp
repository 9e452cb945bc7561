// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/base/archive.hpp"
#include "kernel/dynamics/constraints.hpp"
#include "kernel/forces/loops/loops.hpp"

namespace suture {

/// The sums over one step of an implicit scheme, by the trapezoidal rule, J.
struct StepSums {
  double work = 0;     ///< of all forces
  double damped = 0;   ///< by mass damping
  double driven = 0;   ///< of prescribed motion, without its inertia (DrivenWork::work)
  double kinetic = 0;  ///< at the end
};

/// The sums of the passes over the vertices in each step, chunk by chunk in a fixed order (bitwise
/// identical for any number of threads): the work of all forces by the trapezoidal rule, and the
/// apparent frequency of the motion.
///
/// With the accelerations a_n at t_n, the velocities v- and v+ half a step earlier and later (dx =
/// h v), and the masses M,
///
///   A_n = sum m a_n . v-,   B_n = sum m a_n . v+,   C_n = sum m v+ . v+
///
///   work of all forces       W = sum over n of (h- A_n + h+ B_n) / 2
///   taken by mass damping    D = W + prescribed motion - (C_n - C_0) / 2, without what operations
///                                and other jumps between steps change of C
///   apparent frequency       w^2 = - (A_n - B_{n-1}) / (h C_{n-1}) = - dx.df / (dx . M dx)
///
/// (Park and Underwood, A variable-step central difference method for structural dynamics
/// analysis, CMAME 22 (1980) 241-258.) An unstable mode changes sign in every step and
/// drives h w to 2 wherever it prevails; smooth motion stays below 1.3.
class MotionSums {
 public:
  static constexpr Index chunk = 1024;  ///< vertices: 0.1 MB of columns, 5 us

  /// Stores the sums of one chunk, from the pass that read its v- and the one that computed its v+.
  /// May be called on any thread.
  void note_before(std::size_t part, const loops::PassSums& sums, const DrivenWork& driven) {
    chunks_[part].before = sums.before;
    chunks_[part].driven_before = driven.work;
  }
  void note_after(std::size_t part, const loops::PassSums& sums, const DrivenWork& driven) {
    chunks_[part].after = sums.after;
    chunks_[part].inertia = sums.inertia;
    chunks_[part].driven = driven;
  }
  /// Adds to the sums of a vertex's chunk: its velocity changed after the pass.
  void correct_after(Index vertex, double after, double inertia) {
    chunks_[vertex / chunk].after += after;
    chunks_[vertex / chunk].inertia += inertia;
  }
  static constexpr std::size_t width = 8;  ///< numbers per chunk
  /// Those of all chunks, for processes that make the passes over some.
  std::span<double> numbers() {
    return {reinterpret_cast<double*>(chunks_.data()), chunks_.size() * width};
  }
  /// A_n and the work of driven vertices noted for the next step; 0 if there are none.
  double noted_before() const;
  double noted_driven() const;

  void resize(Index vertices);
  /// Resets all sums to zero; call resize() next.
  void restart();
  /// Call when the step is complete: `before` and `now` are the lengths h- and h+, s; `damps`: mass
  /// damping was active; `contact`: the work of contact in it, which is not in the sums, J.
  void finish_step(double before, double now, bool damps, double contact = 0);
  /// Adds a step that no pass has made.
  void add_step(const StepSums& sums);
  /// Call when cells were removed or joined, or vertices fell asleep: the sums of the previous step
  /// do not belong to the current vertices.
  void forget_last();
  /// Call when such a change has added this to the sum of m v- . v-, J.
  void shift_inertia(double difference) { last_inertia_ += difference; }
  /// Call before a step whose length differs from that before it. W is then (h+^2 - h-^2)/8 sum
  /// F^2/m more than the kinetic energy gains: this difference, J, is not damping.
  void change_step(double difference) { last_inertia_ -= 2 * difference; }
  /// Call when vertices were split: only the sums over the whole body continue.
  void forget_chunks() { whole_body_only_ = true; }

  /// The largest h w of any chunk in the last step; 0 if nothing moves by more than rounding.
  double apparent_frequency() const { return frequency_; }
  /// The chunk with the largest h w; `none` if only the whole body was evaluated.
  Index fastest_chunk() const { return fastest_; }
  /// Chunks with C h^2 below this are ignored, kg m^2.
  void set_noise(double inertia) { noise_ = inertia; }

  double work() const { return work_; }           ///< W, J
  double damped() const { return damped_; }       ///< D, J; only summed with damping
  double driven_work() const { return driven_; }  ///< sum of DrivenWork::work, J
  /// The largest sum m v+ . v+ / 2 of any step, J.
  double largest_kinetic() const { return largest_kinetic_; }
  void state(Archive& archive);

 private:
  struct Chunk {
    double before = 0, after = 0, inertia = 0;  ///< A_n, B_n, C_n
    double driven_before = 0;
    DrivenWork driven;
    double last_after = 0, last_inertia = 0;  ///< B_{n-1}, C_{n-1}
  };
  static_assert(sizeof(Chunk) == width * sizeof(double));
  double squared_frequency(double before, double last_after, double last_inertia, double h) const;

  std::vector<Chunk> chunks_;
  bool has_last_ = false, whole_body_only_ = false;
  bool has_inertia_ = false;
  double last_inertia_ = 0;  ///< C_{n-1} of the whole body, and what jumps have changed
  double noise_ = 0, frequency_ = 0;
  Index fastest_ = none;
  double work_ = 0, damped_ = 0, driven_ = 0, largest_kinetic_ = 0;
};

}  // namespace suture
