// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kernel/mesh/mesh.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// One line of a journal. Darts and elements keep their numbers through all
/// operations, so a line means the same whatever lines before it are left out.
struct Operation {
  enum class Kind {
    cut,     ///< numbers: a dart of each face
    tear,    ///< darts: all faces between two elements around the vertex where each starts
    pierce,  ///< elements
    sew,     ///< darts, two by two
  };
  Kind kind;
  std::vector<Index> numbers;
};

/// A mesh and what was done to its map, without a scene: what a failing test leaves
/// behind, to be replayed. As a text:
///
///     suture-journal 1
///     points 12                     x y z each
///     hexahedra 2                   X0..X7 each (x fastest), points from 0
///     operations 3
///     cut 1  8                      kind, count, darts 24 e + 4 f + k
///     sew 1  8 24                   count of seams, two darts each
///     pierce 1  0
///
/// White space is free, '#' begins a comment.
struct Journal {
  Mesh mesh;
  std::vector<Operation> operations;
  std::string remark;  ///< written as a comment; not read
};

/// Throws InputError with file and line.
Journal read_journal(const std::filesystem::path& path);
/// Points to the last bit. Throws IoError.
void write_journal(const std::filesystem::path& path, const Journal& journal);

/// An operation in terms of a map as it is now: each cell once, and only what can_cut(),
/// can_pierce() and can_sew() admit. If all elements are to go, the smallest one stays.
struct Request {
  Operation::Kind kind;
  std::vector<Dart> faces;
  std::vector<Index> elements;
  std::vector<Seam> seams;  ///< possible one by one; together they may be refused
  Index left_out = 0;
};
Request request(const CellComplex& complex, const Operation& operation);

/// Throws TopologyError if the seams are impossible together.
TopologyChange apply(CellComplex& complex, const Request& request);

/// "cut", "tear", "pierce", "sew".
const char* name_of(Operation::Kind kind);

}  // namespace suture
