// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdlib>

#include "kernel/plugin_host/elf_check.hpp"
#include "kernel/plugin_host/note_reader.hpp"
#include "kernel/topology/journal.hpp"
#include "tests/fuzz/input_file.hpp"
#include "tests/fuzz/targets.hpp"

namespace suture::fuzz {

void journal(std::string_view bytes) {
  answered([&] {
    const Journal journal = read_journal(input_file("j.journal", bytes));
    if (journal.mesh.hexahedra.size() > 200 || journal.mesh.points.size() > 2000) return;
    CellComplex complex(journal.mesh.hexahedra, static_cast<Index>(journal.mesh.points.size()));
    complex.require_edges();
    complex.require_faces();
    const std::size_t most = std::min<std::size_t>(journal.operations.size(), 20);
    for (std::size_t i = 0; i < most; ++i) {
      answered([&] { apply(complex, request(complex, journal.operations[i])); });
      complex.validate();
    }
  });
}

void note(std::string_view bytes) {
  const auto file = input_file("p.so", bytes);
  read_note(file);
  elf_problem(file);
}

std::span<const NamedTarget> targets() {
  static constexpr NamedTarget all[] = {
      {"vtk", vtk},     {"vtu", vtu},         {"msh", msh},   {"medit", medit},
      {"obj", obj},     {"off", off},         {"ply", ply},   {"stl", stl},
      {"vtp", vtp},     {"mha", mha},         {"nii", nii},   {"nrrd", nrrd},
      {"scene", scene}, {"journal", journal}, {"note", note}, {"checkpoint", checkpoint}};
  return all;
}

}  // namespace suture::fuzz
