// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/calculix.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "apps/suture-bench/machine.hpp"
#include "apps/suture-bench/process.hpp"
#include "kernel/base/error.hpp"
#include "kernel/mesh/box.hpp"

namespace suture::bench {
namespace {

namespace fs = std::filesystem;

// --------------------------------------------------------------------- deck --

/// Nodes of a grid at half the spacing of the elements: corners have even coordinates, the middles
/// of edges one odd coordinate.
struct Grid {
  std::array<Index, 3> cells;  ///< x along the beam
  bool quadratic;

  using Place = std::array<Index, 3>;
  std::size_t id(const Place& p) const {
    return 1 + p[0] + (2 * cells[0] + 1) * (p[1] + std::size_t{2 * cells[1] + 1} * p[2]);
  }
  bool is_node(const Place& p) const {
    return p[0] % 2 + p[1] % 2 + p[2] % 2 <= (quadratic ? 1u : 0u);
  }
  template <class Visit>
  void for_each_node(Visit visit) const {
    for (Index z = 0; z <= 2 * cells[2]; ++z)
      for (Index y = 0; y <= 2 * cells[1]; ++y)
        for (Index x = 0; x <= 2 * cells[0]; ++x)
          if (is_node({x, y, z})) visit(Place{x, y, z});
  }
};

/// The nodes of an element in the order of the manual: corners, then the middles of the edges
/// below, above and between.
constexpr Grid::Place node_order[] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2},
                                      {2, 0, 2}, {2, 2, 2}, {0, 2, 2}, {1, 0, 0}, {2, 1, 0},
                                      {1, 2, 0}, {0, 1, 0}, {1, 0, 2}, {2, 1, 2}, {1, 2, 2},
                                      {0, 1, 2}, {0, 0, 1}, {2, 0, 1}, {2, 2, 1}, {0, 2, 1}};

void write_elements(std::ostream& out, const Grid& grid) {
  const std::size_t count = grid.quadratic ? 20 : 8;
  std::size_t element = 0;
  for (Index z = 0; z < grid.cells[2]; ++z)
    for (Index y = 0; y < grid.cells[1]; ++y)
      for (Index x = 0; x < grid.cells[0]; ++x) {
        out << ++element;
        for (std::size_t i = 0; i < count; ++i) {
          const Grid::Place& p = node_order[i];
          out << (i == 10 ? ",\n" : ", ") << grid.id({2 * x + p[0], 2 * y + p[1], 2 * z + p[2]});
        }
        out << '\n';
      }
}

/// Nodes whose weighted sum is the value at the centre of the end face.
std::vector<std::pair<std::size_t, double>> tip_nodes(const Grid& grid) {
  const Index n = grid.cells[1], x = 2 * grid.cells[0];
  if (n % 2 == 0) return {{grid.id({x, n, n}), 1}};
  std::vector<std::pair<std::size_t, double>> nodes;
  const double corner = grid.quadratic ? -0.25 : 0.25;
  for (const Index y : {n - 1, n + 1})
    for (const Index z : {n - 1, n + 1}) nodes.emplace_back(grid.id({x, y, z}), corner);
  if (!grid.quadratic) return nodes;
  for (const Grid::Place& p :
       {Grid::Place{x, n - 1, n}, {x, n + 1, n}, {x, n, n - 1}, {x, n, n + 1}})
    nodes.emplace_back(grid.id(p), 0.5);
  return nodes;
}

/// Coordinates along the beam of the planes of nodes, at half the spacing of the elements.
std::vector<double> stations(const CalculixJob& job) {
  const Index n = job.cells[0];
  const Mesh line = make_box({{0, 0, 0}, {1, 1, 1}, {n, 1, 1}, {job.grading, 1, 1}});
  std::vector<double> x;
  for (Index i = 0; i <= 2 * n; ++i)
    x.push_back((line.points[i / 2][0] + line.points[(i + 1) / 2][0]) / 2);
  return x;
}

void write_deck(const fs::path& file, const Cantilever& what, const Grid& grid,
                const CalculixJob& job) {
  std::ofstream out(file);
  out.precision(17);
  const double half = 0.125 / grid.cells[1];
  const std::vector<double> x = stations(job);
  out << "*NODE, NSET=ALL\n";
  grid.for_each_node([&](const Grid::Place& p) {
    out << grid.id(p) << ", " << x[p[0]] << ", " << half * p[1] << ", " << half * p[2] << '\n';
  });
  out << "*ELEMENT, TYPE=" << job.element << ", ELSET=BODY\n";
  write_elements(out, grid);
  out << "*NSET, NSET=ROOT\n";
  grid.for_each_node([&](const Grid::Place& p) {
    if (p[0] == 0) out << grid.id(p) << ",\n";
  });
  out << "*NSET, NSET=TIP\n";
  for (const auto& [node, weight] : tip_nodes(grid)) out << node << ",\n";
  out << "*MATERIAL, NAME=SOLID\n*ELASTIC\n400000., " << what.nu << "\n*DENSITY\n1000.\n"
      << "*SOLID SECTION, ELSET=BODY, MATERIAL=SOLID\n*BOUNDARY\nROOT, 1, 3\n"
      << "*STEP, NLGEOM, INC=1000\n*STATIC, SOLVER=" << job.solver << "\n1., 1.\n"
      << "*DLOAD\nBODY, GRAV, " << what.gravity << ", 0., -1., 0.\n"
      << "*NODE PRINT, NSET=TIP\nU\n*END STEP\n";
  if (!out.flush()) throw IoError("cannot write " + file.string());
}

// ----------------------------------------------------------------- results --

/// Rows of numbers after a header, as ccx writes them; other lines are skipped.
std::vector<std::vector<double>> rows_of(const fs::path& file) {
  std::vector<std::vector<double>> rows;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::vector<double> row;
    for (double x; words >> x;) row.push_back(x);
    if (row.size() >= 4) rows.push_back(row);
  }
  return rows;
}

double tip_of(const fs::path& file, const Grid& grid) {
  const auto rows = rows_of(file);
  double tip = 0;
  for (const auto& [node, weight] : tip_nodes(grid)) {
    const auto row = std::ranges::find_if(
        rows, [id = static_cast<double>(node)](const auto& r) { return r[0] == id; });
    if (row == rows.end()) throw IoError(file.string() + ": no displacement of the tip");
    tip += weight * (*row)[2];
  }
  return tip;
}

}  // namespace

bool has_calculix() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    if (fs::exists(fs::path(folder) / "ccx")) return true;
  return false;
}

CalculixRun run_calculix(const Cantilever& what, const CalculixJob& job) {
  const std::vector<std::string> known{"C3D8", "C3D8I", "C3D20R"};
  if (std::ranges::count(known, job.element) == 0)
    throw UsageError("CalculiX element '" + job.element + "' must be one of C3D8, C3D8I, C3D20R");
  const Grid grid{job.cells, job.element == "C3D20R"};
  const WorkingFolder folder;
  write_deck(folder.path() / "job.inp", what, grid, job);
  ::setenv("OMP_NUM_THREADS", "1", 1);
  const ProcessUse use = run_process({"ccx", "-i", "job"}, folder.path());
  if (use.code != 0)
    throw IoError("ccx failed on a cantilever of " + std::to_string(job.cells[1]) + " " +
                  job.element + ": exit code " + std::to_string(use.code));
  // The child begins with the peak of the process that spawned it.
  return {.elements = 1.0 * job.cells[0] * job.cells[1] * job.cells[2],
          .seconds = use.cpu,
          .wall = use.wall,
          .iterations = static_cast<double>(rows_of(folder.path() / "job.cvg").size()),
          .tip = tip_of(folder.path() / "job.dat", grid),
          .peak_bytes = use.peak_bytes > 1.01 * peak_bytes() ? use.peak_bytes : std::nan("")};
}

}  // namespace suture::bench
