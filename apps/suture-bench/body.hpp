// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kernel/dynamics/dynamics.hpp"
#include "kernel/plugin_host/plugin_host.hpp"
#include "kernel/spectrum/step_limits.hpp"

namespace suture::bench {

/// A block of one model as a run has it: gravity, one end held, by default symplectic Euler
/// at half the bound of the stable step.
struct BodyOptions {
  std::string model;
  std::map<std::string, double> parameters{};  ///< by name, over E, nu, rho
  std::array<Index, 3> cells{10, 10, 40};
  bool distorted = false;  ///< general hexahedra: points moved by up to 10 %
  unsigned threads = 1;
  double cell = 0.025;       ///< m, edge of the cubes; that of the paper's Fig. 8
  double ramp = 0;           ///< s, of gravity
  double safety = 0.5;       ///< dt over the stable step, or over its bound
  bool search = false;       ///< for the stable step: where dt matters, not only the rate
  Vec3 gravity{0, -9.8, 0};  ///< m/s^2
  double held = 0;           ///< m along z that is held, from the end
  bool skip = true;          ///< false: compute also what adds nothing
  bool may_divide = false;   ///< cuts along blades may divide elements
  std::string integrator = "symplectic-euler";
  double dt = 0;               ///< s; 0: `safety` times the stable step
  double damping = 0;          ///< 1/s
  IntegratorOptions solver{};  ///< of implicit integrators
};

/// Wall clock of the parts of building a body, s.
struct BodyTimes {
  double plugin = 0;  ///< not of BenchBody
  double mesh = 0, map = 0, attributes = 0, loops = 0, stable_step = 0;
};

/// In declared order; the paper's material (E = 400 kPa, nu = 0.3, rho = 1000), but
/// for what is wanted.
std::vector<double> parameters_of(const suture_model& model,
                                  const std::map<std::string, double>& wanted);

class BenchBody {
 public:
  BenchBody(PluginHost& host, const BodyOptions& options);

  /// Performs one step and advances the time.
  void step();
  /// `count` cuts, one after the other, each of one inner face chosen at random.
  /// Returns the seconds they took.
  double cut_random(unsigned count, unsigned seed);

  Index element_count() const { return complex().element_count(); }
  Body& body() { return *body_; }
  Dynamics& dynamics() { return *dynamics_; }
  StepLimits& limits() { return *limits_; }
  const CellComplex& complex() const { return body_->complex(); }
  /// Faces of part `part` of `parts` of the middle plane across x, a strip over y,
  /// that are not open yet.
  std::vector<Dart> strip(int part, int parts) const;
  /// Opens faces, and everything follows.
  void cut(std::span<const Dart> faces);

  Attributes& attributes() { return body_->attributes(); }
  double dt() const { return dt_; }
  const BodyTimes& times() const { return times_; }
  /// Ids of edges and faces, whether a model needs them or not.
  void require_all_ids();

 private:
  Diagnostics diagnostics_;
  BodyTimes times_;
  std::unique_ptr<Body> body_;
  std::unique_ptr<Dynamics> dynamics_;
  std::unique_ptr<StepLimits> limits_;
  Vec3 length_{};  ///< m, of the block
  double dt_ = 0;
  double time_ = 0;
};

/// Near-cubic grid of about `elements` elements in the paper's proportions 1:1:4;
/// the 60 x 60 x 120 grid at 432,000.
std::array<Index, 3> grid_of(Index elements);

}  // namespace suture::bench
