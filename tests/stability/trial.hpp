// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace suture {
class Simulation;
}

namespace suture::test {

using Json = nlohmann::ordered_json;

struct Trial;
using Values = std::vector<double>;

/// What a trial is measured by, without units.
struct Check {
  std::function<Values(Simulation&)> measure;  ///< at the end
  Values expected;                             ///< by a law, or
  std::shared_ptr<const Trial> reference{};    ///< what this trial gives
  double tolerance = 0;  ///< of the largest difference relative to the largest value expected
  unsigned looks = 0;    ///< > 0: so often, and the largest may be at most that expected
};

/// What is known of a trial before it runs.
enum class Expected {
  right,    ///< finishes, or comes to rest, with energies that close
  wrong,    ///< ends with a NumericalError
  warned,   ///< ends with a NumericalError, or warns of its dt
  buckles,  ///< ends at an unstable equilibrium
  refused,  ///< ends with a NumericalError that asks for more steps
  quiet,    ///< stays at rest until a motion begins, in no more steps than it needs
};

/// A run with a known outcome: a scene as users write it, and what to hold it to.
struct Trial {
  std::string name;   ///< "twist-017"
  std::string title;  ///< "tm-faure bar nu 0.3 E 1e+05 ..."
  Json scene;
  std::string mesh;  ///< text of "mesh.mesh" beside the scene, or none
  Expected expected = Expected::right;

  double stable = 0;            ///< s: stable step of the body at rest
  double settled = 0;           ///< s: ramps and events are over
  double quiet = 0;             ///< s: nothing moves before; 0: not known
  double quiet_steps = 0;       ///< at most, until then
  double compare = 0;           ///< s: where a run at a quarter of the step is compared; 0: nowhere
  bool is_conservative = true;  ///< once settled: no viscosity and no pressure
  bool is_smooth = false;       ///< loads grow over several periods: the balance is held to less
  std::array<double, 3> probe{};  ///< m: the node that is nearest is compared

  // Cells of the table, model x solver x stress:
  std::string model, solver, law;
  Check check;
  std::function<void(Simulation&)> begin{};  ///< changes the motion at the start
  std::string excuse;            ///< why the run may be refused, be stopped or warn; or none
  double allowed_growth = 0.02;  ///< of energy, per 10,000 steps
};

/// Uniform numbers that are the same on every machine.
class Random {
 public:
  Random(std::uint64_t seed, std::string_view family, unsigned index);
  double number();  ///< 0 .. 1
  double between(double low, double high) { return low + (high - low) * number(); }
  /// Evenly in the logarithm.
  double decades(double low, double high);
  bool chance(double probability) { return number() < probability; }
  template <class T>
  const T& pick(const std::vector<T>& list) {
    return list[static_cast<std::size_t>(number() * static_cast<double>(list.size()))];
  }

 private:
  std::uint64_t state_;
};

/// A family of trials: one load on many bodies, or one stress on every model with every solver.
struct Family {
  std::string name;
  unsigned size = 0;
  std::function<void(class Draft&)> make;
  std::string law{};                ///< of a stress: what its results are compared with
  std::string what{};               ///< of a stress
  bool is_long = false;             ///< not in a sample
  bool needs_test_plugins = false;  ///< which only test_stability loads
  bool is_stress() const { return !law.empty(); }
};

const std::vector<Family>& families();
/// "twist-017", "twist-360.neo-hookean.newmark"
std::string trial_name(const Family& family, unsigned index);
Trial make_trial(const Family& family, unsigned index, std::uint64_t seed);

}  // namespace suture::test
