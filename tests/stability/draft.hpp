// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <string>

#include "tests/stability/materials.hpp"
#include "tests/stability/trial.hpp"

namespace suture::test {

/// A body that a trial is made with: about 1 to 200 elements, x along its length.
struct Body {
  std::string name;
  Json mesh;
  std::string file;  ///< text of a Medit file that `mesh` names, or none
  std::array<double, 3> size{};
  std::array<int, 3> cells{};
  double scale = 1;
  bool is_of_cubes = false;  ///< springs fit

  double length() const { return size[0]; }
  double height() const { return size[1]; }
  double edge(int axis) const { return size[axis] / cells[axis]; }
};

/// The named body, `scale` m times as large as where its shortest cube has an edge of 1.
Body make_body(const std::string& name, double scale, Random& random);

/// The period of a body, s: L sqrt(rho / E).
double period_of(const Body& body, double young, double density);

/// A trial in the making. Lengths are those of the body, times are counted in its own period
/// L / c with c = sqrt(E / rho), loads in E.
class Draft {
 public:
  Draft(const Family& family, unsigned index, std::uint64_t seed);

  /// Body and material; then `stable()` is known. Without a list: any body.
  void choose(const std::vector<std::string>& bodies = {});
  void choose(const std::vector<std::string>& bodies, const std::vector<double>& nus,
              bool continuum_only = false);
  /// A given body and material instead; `end`: in periods.
  void start(const Body& given, const Material& material, double end);
  /// Once more where the material is another: the run's step and its length.
  void find_stable_step();

  Json x_end(int side) const;  ///< selection of the nodes at x = 0 or L
  void fix(int side, const char* components = "xyz");
  void move(int side, const Json& motion, const Json& ramp);
  void load(const char* kind, const Json& value, const Json& ramp = {});
  void load_on(const Json& where, const char* kind, const Json& value, const Json& ramp = {});
  void gravity(int axis, double gamma, bool sudden);  ///< gamma E / (rho L)
  void event(double time, Json operation);
  /// Linear or smooth, over 5 to 20 periods but not more than 0.3 of the run.
  Json slow_ramp();

  double period() const { return period_; }
  double end() const { return end_; }
  /// Springs bear a part of what a solid bears (formulas.md, 1.7).
  double bearable(double load) const { return is_springs_ ? 0.15 * load : load; }
  bool is_springs() const { return is_springs_; }
  void settle(double time) { trial.settled = std::max(trial.settled, time); }
  void note(const std::string& text) { trial.title += " " + text; }

  const unsigned index;
  Random random;
  Trial trial;
  Body body;
  double young = 0, poisson = 0, density = 0;

 private:
  void choose_material(const std::vector<double>& nus, bool continuum_only);
  bool is_springs_ = false;
  double period_ = 0, end_ = 0;
};

/// The stable step of the scene as it is, at rest, s.
double stable_step_of(const Trial& trial);

}  // namespace suture::test
