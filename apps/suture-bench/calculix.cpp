// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/calculix.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <vector>

#include "apps/suture-bench/machine.hpp"
#include "apps/suture-bench/process.hpp"
#include "apps/suture-bench/solid_mesh.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"

namespace suture::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// ------------------------------------------------------------------- selections --

/// Nodes that a selection of the scene contains; a node between two corners is in a set if both
/// are.
class Nodes {
 public:
  Nodes(const Mesh& mesh, const SolidMesh& solid) : mesh_(mesh), solid_(solid) {}

  std::vector<Index> in(const Json& where) const {
    std::vector<Index> found;
    const std::vector<char> in_set =
        where.contains("set") ? marks(where["set"]) : std::vector<char>{};
    for (Index n = 0; n < solid_.nodes.size(); ++n) {
      const SolidMesh::Node& node = solid_.nodes[n];
      if (in_set.empty() ? is_in_box(where, solid_.points[n])
                         : in_set[node.first] && in_set[node.second])
        found.push_back(n);
    }
    if (found.empty()) throw UsageError("no node of the mesh is in " + where.dump());
    return found;
  }

 private:
  std::vector<char> marks(const std::string& set) const {
    std::vector<char> result(mesh_.points.size());
    for (const Index v : mesh_.point_sets.at(set)) result[v] = 1;
    return result;
  }
  static bool is_in_box(const Json& where, const Vec3& p) {
    if (!where.contains("box")) throw UsageError("CalculiX cannot select " + where.dump());
    const Vec3 low = where["box"]["min"], high = where["box"]["max"];
    for (std::size_t c = 0; c < 3; ++c)
      if (p[c] < low[c] || p[c] > high[c]) return false;
    return true;
  }

  const Mesh& mesh_;
  const SolidMesh& solid_;
};

// --------------------------------------------------------------------- deck --

/// Where a part of a prescribed motion takes a point: c + R(angle) (X - c) + t.
Vec3 displacement_of(const Json& move, const Vec3& point, double part) {
  Vec3 u = move.value("translation", Vec3{});
  for (double& x : u) x *= part;
  if (!move.contains("rotation")) return u;
  const Json& rotation = move["rotation"];
  const Vec3 axis = rotation["axis"], r = minus(point, rotation.value("centre", Vec3{}));
  const double length = std::sqrt(dot(axis, axis));
  const double angle = part * rotation["angle"].get<double>() * std::numbers::pi / 180;
  const Vec3 n{axis[0] / length, axis[1] / length, axis[2] / length}, side = cross(n, r);
  // Rodrigues: R r - r = sin a (n x r) + (1 - cos a) (n (n . r) - r)
  for (std::size_t c = 0; c < 3; ++c)
    u[c] += std::sin(angle) * side[c] + (1 - std::cos(angle)) * (n[c] * dot(n, r) - r[c]);
  return u;
}

void write_constraints(std::ostream& out, const Json& scene, const Nodes& nodes,
                       const SolidMesh& solid, double part) {
  out << "*BOUNDARY\n";
  for (const Json& constraint : scene.value("constraints", Json::array()))
    for (const Index n : nodes.in(constraint["where"])) {
      const Vec3 u = constraint.contains("move")
                         ? displacement_of(constraint["move"], solid.points[n], part)
                         : Vec3{};
      for (const char c : constraint.value("fix", std::string("xyz")))
        out << n + 1 << ", " << c - 'w' << ", " << c - 'w' << ", "
            << u[static_cast<std::size_t>(c - 'x')] << '\n';
    }
}

void write_loads(std::ostream& out, const Json& scene, const Nodes& nodes, const SolidMesh& solid) {
  const Vec3 g = scene.value("gravity", Vec3{});
  const double size = std::sqrt(dot(g, g));
  if (size > 0)
    out << "*DLOAD\nBODY, GRAV, " << size << ", " << g[0] / size << ", " << g[1] / size << ", "
        << g[2] / size << '\n';
  for (const Json& load : scene.value("loads", Json::array())) {
    const Vec3 traction = load.at("traction");
    std::vector<char> is_selected(solid.nodes.size());
    for (const Index n : nodes.in(load["where"])) is_selected[n] = 1;
    out << "*CLOAD\n";
    for (const auto& [n, area] : loaded_nodes(solid, [&](Index v) { return is_selected[v]; }))
      for (std::size_t c = 0; c < 3; ++c)
        out << n + 1 << ", " << c + 1 << ", " << area * traction[c] << '\n';
  }
}

void write_mesh(std::ostream& out, const SolidMesh& solid, const std::string& element) {
  out << "*NODE, NSET=ALL\n";
  for (Index n = 0; n < solid.nodes.size(); ++n) {
    const Vec3& p = solid.points[n];
    out << n + 1 << ", " << p[0] << ", " << p[1] << ", " << p[2] << '\n';
  }
  out << "*ELEMENT, TYPE=" << element << ", ELSET=BODY\n";
  for (std::size_t e = 0; e < solid.elements.size(); ++e) {
    out << e + 1;
    for (std::size_t i = 0; i < solid.elements[e].size(); ++i)
      out << (i == 10 ? ",\n" : ", ") << solid.elements[e][i] + 1;
    out << '\n';
  }
}

/// ccx moves nodes along straight lines: it takes a rotation in steps of at most 15 degrees.
int step_count(const Json& scene) {
  double angle = 0;
  for (const Json& constraint : scene.value("constraints", Json::array()))
    if (constraint.contains("move") && constraint["move"].contains("rotation"))
      angle = std::max(angle, std::abs(constraint["move"]["rotation"]["angle"].get<double>()));
  return std::max(1, static_cast<int>(std::ceil(angle / 15)));
}

void write_deck(const fs::path& file, const Json& scene, const Nodes& nodes, const SolidMesh& solid,
                const std::vector<Index>& probe, const CalculixJob& job) {
  const Json& material = scene["models"][0]["parameters"];
  std::ofstream out(file);
  out.precision(13);  // ccx reads at most 20 characters of a number
  write_mesh(out, solid, job.element);
  out << "*NSET, NSET=PROBE\n";
  for (const Index n : probe) out << n + 1 << ",\n";
  out << "*MATERIAL, NAME=SOLID\n*ELASTIC\n"
      << material["E"].get<double>() << ", " << material["nu"].get<double>() << "\n*DENSITY\n"
      << material["rho"].get<double>() << "\n*SOLID SECTION, ELSET=BODY, MATERIAL=SOLID\n";
  const int steps = step_count(scene);
  for (int step = 1; step <= steps; ++step) {
    out << "*STEP, NLGEOM, INC=1000\n*STATIC, SOLVER=" << job.solver << "\n1., 1.\n";
    if (job.precise) out << "*CONTROLS, PARAMETERS=FIELD\n1e-9, 1e-9\n";
    write_constraints(out, scene, nodes, solid, 1.0 * step / steps);
    write_loads(out, scene, nodes, solid);
    out << "*NODE PRINT, NSET=PROBE\nU\n*NODE PRINT, NSET=PROBE\nRF\n*END STEP\n";
  }
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

/// Displacement and reaction of the nodes of the probe, at the end of the last increment.
struct Printed {
  std::vector<Vec3> displacements, reactions;

  Printed(const fs::path& file, std::size_t count) {
    const auto rows = rows_of(file);
    if (rows.size() < 2 * count) throw IoError(file.string() + ": no values of the probe");
    for (std::size_t i = rows.size() - 2 * count; i < rows.size(); ++i)
      (displacements.size() < count ? displacements : reactions)
          .push_back({rows[i][1], rows[i][2], rows[i][3]});
  }
};

/// One node, or the centre of a square of four: of quadratic elements, whose corners count -1/4 and
/// whose nodes between them 1/2 each.
Vec3 mean_displacement(const std::vector<Vec3>& u, const std::vector<Index>& probe,
                       const SolidMesh& solid) {
  Vec3 sum{};
  for (std::size_t i = 0; i < probe.size(); ++i) {
    double weight = 1.0 / static_cast<double>(probe.size());
    if (solid.quadratic && probe.size() == 8)
      weight = solid.nodes[probe[i]].is_corner() ? -0.25 : 0.5;
    for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * u[i][c];
  }
  return sum;
}

Vec3 value_of(const std::string& field, const Printed& printed, const std::vector<Index>& probe,
              const SolidMesh& solid) {
  if (field == "displacement") return mean_displacement(printed.displacements, probe, solid);
  Vec3 sum{};
  for (std::size_t i = 0; i < probe.size(); ++i) {
    const Vec3 force = printed.reactions[i];
    Vec3 place = solid.points[probe[i]];
    for (std::size_t c = 0; c < 3; ++c) place[c] += printed.displacements[i][c];
    const Vec3 part = field == "reaction_moment" ? cross(place, force) : force;
    for (std::size_t c = 0; c < 3; ++c) sum[c] += part[c];
  }
  return sum;
}

/// The node in the middle of the probe's box, if there is one, else all nodes in it.
std::vector<Index> nodes_of_probe(const Json& where, const Nodes& nodes, const SolidMesh& solid) {
  std::vector<Index> found = nodes.in(where);
  if (!where.contains("box")) return found;
  const Vec3 low = where["box"]["min"], high = where["box"]["max"];
  for (const Index n : found) {
    double off = 0;
    for (std::size_t c = 0; c < 3; ++c)
      off = std::max(off, std::abs(solid.points[n][c] - (low[c] + high[c]) / 2));
    if (off < 1e-9) return {n};
  }
  return found;
}

std::vector<std::pair<Index, Index>> cut_faces(const Json& scene) {
  std::vector<std::pair<Index, Index>> faces;
  for (const Json& event : scene.value("events", Json::array()))
    for (const Json& pair : event.at("cut").at("faces")) faces.emplace_back(pair[0], pair[1]);
  return faces;
}

}  // namespace

bool has_calculix() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    if (fs::exists(fs::path(folder) / "ccx")) return true;
  return false;
}

CalculixRun run_calculix(const Json& scene, const Mesh& mesh, const CalculixJob& job) {
  const std::vector<std::string> known{"C3D8", "C3D8I", "C3D20", "C3D20R"};
  if (std::ranges::count(known, job.element) == 0)
    throw UsageError("CalculiX element '" + job.element +
                     "' must be one of C3D8, C3D8I, C3D20, C3D20R");
  const Mesh cut = with_slit(mesh, cut_faces(scene));
  const SolidMesh solid = solid_mesh(cut, job.element.starts_with("C3D20"));
  const Nodes nodes(cut, solid);
  const Json& asked = scene["output"]["probes"]["at"][0];
  const std::vector<Index> probe = nodes_of_probe(asked["where"], nodes, solid);
  const WorkingFolder folder;
  write_deck(folder.path() / "job.inp", scene, nodes, solid, probe, job);
  ::setenv("OMP_NUM_THREADS", "1", 1);
  const ProcessUse use = run_process({"ccx", "-i", "job"}, folder.path());
  if (use.code != 0)
    throw IoError("ccx failed on " + std::to_string(solid.elements.size()) + " " + job.element +
                  ": exit code " + std::to_string(use.code));
  const Printed printed(folder.path() / "job.dat", probe.size());
  // The child begins with the peak of the process that spawned it.
  return {.dofs = 3.0 * static_cast<double>(solid.nodes.size()),
          .seconds = use.cpu,
          .wall = use.wall,
          .iterations = static_cast<double>(rows_of(folder.path() / "job.cvg").size()),
          .probe = value_of(asked["fields"][0], printed, probe, solid),
          .peak_bytes = use.peak_bytes > 1.01 * peak_bytes() ? use.peak_bytes : std::nan("")};
}

}  // namespace suture::bench
