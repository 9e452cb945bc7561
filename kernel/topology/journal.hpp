// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kernel/mesh/mesh.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// One line of a journal. Darts and elements keep their numbers through all operations, so a line
/// keeps its meaning if earlier lines are left out, unless these make copies.
struct Operation {
  enum class Kind {
    cut,     ///< numbers: one dart of each face
    tear,    ///< darts: all faces between two elements around the start vertex of each
    pierce,  ///< elements
    sew,     ///< darts in pairs
    clone,   ///< elements, as in Cloning::origins
  };
  Kind kind;
  std::vector<Index> numbers;
  /// For `clone`, as in Cloning: darts in pairs, darts, elements and the copies that absorb them in
  /// pairs.
  std::vector<Index> seams{}, cut{}, absorbed{};
  bool operator==(const Operation&) const = default;
};
Operation operation_of(const Cloning& cloning);

/// A mesh and the operations applied to its map, without a scene. A failing test writes one, which
/// can be replayed. As text:
///
///     suture-journal 1
///     points 12                     x y z each
///     hexahedra 2                   X0..X7 each (x fastest), points from 0
///     operations 4
///     cut 1  8                      kind, count, darts 24 e + 4 f + k
///     sew 1  8 24                   count of seams, two darts each
///     clone 2  1 1  sew 0  cut 0  absorb 0     elements; seams, darts, pairs as in Cloning
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
/// Points are written exactly. Throws IoError.
void write_journal(const std::filesystem::path& path, const Journal& journal);

/// An operation in terms of the current map: each cell once, and only cells that can_cut(),
/// can_pierce() and can_sew() allow. If all elements would be removed, the smallest one is kept. A
/// cloning is as it is written: it is possible as a whole, or refused.
struct Request {
  Operation::Kind kind;
  std::vector<Dart> faces;
  std::vector<Index> elements;
  std::vector<Seam> seams;  ///< each is possible on its own; together they may be refused
  Cloning cloning{};
  Index left_out = 0;
};
Request request(const CellComplex& complex, const Operation& operation);

/// Throws TopologyError if the seams are not possible together, or the cloning is not.
TopologyChange apply(CellComplex& complex, const Request& request);

/// "cut", "tear", "pierce", "sew", "clone".
const char* name_of(Operation::Kind kind);

}  // namespace suture
