// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "kernel/mesh/mesh.hpp"

namespace suture::bench {

/// What another program, CalculiX (Debian: calculix-ccx), makes of a static scene.
struct CalculixRun {
  double dofs = 0;        ///< unknowns, those of constrained nodes included
  double seconds = 0;     ///< CPU s of the whole process, one thread
  double wall = 0;        ///< s
  double iterations = 0;  ///< of Newton's method, in all increments
  Vec3 probe{};           ///< the field of the scene's first probe; seven digits
  double peak_bytes = 0;  ///< NaN if it is below that of this process
};

/// Whether `ccx` is installed.
bool has_calculix();

struct CalculixJob {
  std::string element = "C3D8";    ///< C3D8, C3D8I, C3D20 or C3D20R
  std::string solver = "SPOOLES";  ///< CalculiX's default; or "ITERATIVE CHOLESKY"
  bool precise = false;            ///< Newton's method to 1e-9 instead of CalculiX's 0.5 %
};

/// Solves a static scene on its mesh: one model with E, nu and rho (as St Venant and Kirchhoff's
/// law), gravity, constraints, tractions, cuts of named faces, all at the end of their ramps. Nodes
/// are selected by sets and boxes; the first probe shows displacement (one node, or the centre of
/// four), reaction or reaction_moment. Throws UsageError for anything else, and IoError if ccx
/// fails.
CalculixRun run_calculix(const nlohmann::json& scene, const Mesh& mesh, const CalculixJob& job);

}  // namespace suture::bench
