// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdlib>
#include <random>

#include "kernel/plugin_host/plugin_host.hpp"
#include "tests/plugins/model_harness.hpp"

namespace suture::testing {

/// The plugin's build for an instruction set: "base", "avx2", "avx512" (or the
/// best below it that this processor runs).
inline const suture_model& mss_baudet(const char* isa = "avx512") {
  setenv("SUTURE_ISA", isa, 1);
  PluginHost host;
  const suture_model& model = host.model("mss-baudet");
  unsetenv("SUTURE_ISA");
  return model;
}

/// The paper's material.
inline std::map<std::string, double> paper_material() {
  return {{"E", 400e3}, {"nu", 0.3}, {"rho", 1000}};
}
inline std::map<std::string, double> with(std::map<std::string, double> base,
                                          const std::map<std::string, double>& more) {
  for (const auto& [name, value] : more) base[name] = value;
  return base;
}

/// Every coordinate moved by up to +-`size`.
inline std::vector<Vec3> shaken(std::vector<Vec3> x, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-size, size);
  for (auto& p : x)
    for (auto& c : p) c += shift(random);
  return x;
}

inline double norm_of(const std::vector<Vec3>& f) {
  double sum = 0;
  for (const auto& p : f)
    for (const double c : p) sum += c * c;
  return std::sqrt(sum);
}
inline double distance(const std::vector<Vec3>& f, const std::vector<Vec3>& g) {
  std::vector<Vec3> difference = f;
  for (std::size_t i = 0; i < f.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) difference[i][c] -= g[i][c];
  return norm_of(difference);
}

}  // namespace suture::testing
