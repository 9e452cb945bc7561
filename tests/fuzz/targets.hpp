// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string_view>

// What reads files of strangers, each as one function of the file's bytes. An Error is the right
// answer to a bad file; any other exception, a sanitizer's report or a law that does not hold
// (std::abort) is a finding. libFuzzer calls them (entry.cpp), and a test with all reproducers.

namespace suture::fuzz {

using Target = void (*)(std::string_view bytes);

struct NamedTarget {
  const char* name;  ///< of the program fuzz_NAME and of its folder of reproducers
  Target run;
};

/// Meshes: the reader by the file's extension, laws of what it gives, and the import.
void vtk(std::string_view bytes);
void vtu(std::string_view bytes);
void msh(std::string_view bytes);
void medit(std::string_view bytes);
// Surfaces.
void obj(std::string_view bytes);
void off(std::string_view bytes);
void ply(std::string_view bytes);
void stl(std::string_view bytes);
void vtp(std::string_view bytes);
// Label images.
void mha(std::string_view bytes);
void nii(std::string_view bytes);
void nrrd(std::string_view bytes);
/// A scene: read, and built if it has a small mesh of its own.
void scene(std::string_view bytes);
/// A journal: read, and repeated if it is small.
void journal(std::string_view bytes);
void note(std::string_view bytes);
/// A checkpoint: read, and loaded into a run of its scene if that is small (its own mutator changes
/// the arrays behind the checksum: checkpoint_mutator.cpp). No step is made: that numbers are those
/// of the run is what the checksum is for.
void checkpoint(std::string_view bytes);

std::span<const NamedTarget> targets();

}  // namespace suture::fuzz
