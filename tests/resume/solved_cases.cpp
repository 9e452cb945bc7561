// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bodies of some blocks of vertices for solvers: boxes and sheared elements, which functors treat
// by different formulas, so that no batch of theirs may hold both. The 6,500 boxes fill no whole
// number of batches, and one process has the last of them and the first sheared element.
#include <algorithm>

#include "kernel/mesh/box.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/resume/cases.hpp"

namespace suture::test {
namespace {

std::string sheared_beam() {
  Mesh mesh = make_box({.size = {1.25, 1, 1}, .cells = {25, 20, 20}});
  for (Vec3& point : mesh.points) point[1] += 0.3 * std::max(0.0, point[2] - 0.66);
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  write_mesh(folder / "beam.vtk", mesh, diagnostics);
  return read_text(folder / "beam.vtk");
}

}  // namespace

Case solved(const std::string& name, const Json& solver) {
  Case result{name, Json::parse(R"({
    "suture": 2,
    "mesh": {"file": "beam.vtk"},
    "models": [{"model": "tm-faure", "parameters": {"E": 1e5, "nu": 0.3, "rho": 1000}}],
    "gravity": {"value": [0, -5, 0], "ramp": 0.3},
    "constraints": [{"where": {"box": {"min": [-1, -1, -1], "max": [0.01, 2, 2]}}, "fix": "xyz"}],
    "events": [{"at": 0.2, "cut": {"along": "faces", "plane": {"point": [0.7, 0.5, 0.5],
                                                               "normal": [1, 0.2, 0.1], "radius": 0.4}}}],
    "output": {"directory": "out", "every": 0.1, "energies": {}, "fields": ["velocity", "force"]}})")};
  result.files["beam.vtk"] = sheared_beam();
  result.scene["solver"] = solver;
  return result;
}

}  // namespace suture::test
