// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/shared_run.hpp"

#include <fstream>
#include <iterator>
#include <sstream>

#include "kernel/base/checksum.hpp"
#include "kernel/base/error.hpp"

namespace suture {
namespace {

/// The checksum of a file; "" if it cannot be read.
std::string sum_of_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return "";
  Checksum sum;
  sum.add(std::string(std::istreambuf_iterator<char>(file), {}));
  return sum.text();
}

std::string sum_of(const std::string& text) {
  Checksum sum;
  sum.add(text);
  return sum.text();
}

/// What the bits of a run depend on, a line for each: "what: which".
std::string description_of(const Scene& scene, const CheckpointHeader& run) {
  std::ostringstream lines;
  lines << "program: " << run.program << " (" << sum_of_file("/proc/self/exe") << ")\n"
        << "instruction set: " << run.isa << '\n'
        << "scene: " << run.scene_hash << ' ' << sum_of(run.scene_text) << '\n'
        << "mesh: " << run.mesh_hash << '\n';
  for (const std::filesystem::path& file : scene.files)
    lines << "file " << file.filename().string() << ": " << sum_of_file(file) << '\n';
  for (const CheckpointHeader::Plugin& plugin : run.plugins)
    lines << "plugin " << plugin.id << ": " << plugin.version << " (" << sum_of_file(plugin.file)
          << ")\n";
  return lines.str();
}

/// The first lines in which two descriptions differ.
std::pair<std::string, std::string> difference(const std::string& a, const std::string& b) {
  std::istringstream lines_a(a), lines_b(b);
  std::string line_a, line_b;
  do {
    std::getline(lines_a, line_a);
    std::getline(lines_b, line_b);
  } while (line_a == line_b && lines_a && lines_b);
  return {line_a, line_b};
}

}  // namespace

void require_shareable(const Scene& scene) {
  if (scene.solver.budget && scene.solver.budget->seconds > 0)
    throw InputError(
        "/solver/budget/milliseconds: the clocks of several processes differ; give \"iterations\", "
        "or use one process");
  if (scene.checkpoint.enabled && scene.checkpoint.minutes > 0)
    throw InputError(
        "/checkpoint/minutes: the clocks of several processes differ; give \"every\" (s of the "
        "simulation) or \"every_steps\", or use one process");
}

void require_same_run(Communicator& processes, const Scene& scene, const CheckpointHeader& run) {
  const std::vector<std::string> all = processes.gather(description_of(scene, run));
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (all[i] == all[0]) continue;
    const auto [first, other] = difference(all[0], all[i]);
    throw InputError(
        "the processes of this run differ: process 0 has " + first + ", process " +
        std::to_string(i) + " has " + other +
        "; start the same program with the same plugins and files on processors of one kind");
  }
}

}  // namespace suture
