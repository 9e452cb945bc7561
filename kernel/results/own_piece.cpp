// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/results/own_piece.hpp"

#include <algorithm>

#include "kernel/output/frame_pieces.hpp"

namespace suture {

std::vector<bool> vertices_read_for(const PieceCells& piece, BuiltScene& built,
                                    const std::vector<FieldChoice>& fields) {
  const CellComplex& complex = built.body().complex();
  std::vector<bool> read(complex.count(0));
  for (const Index v : piece.vertices) read[v] = true;
  if (std::ranges::none_of(fields, &FieldChoice::runs_functors)) return read;
  const bool has_near =
      std::ranges::find(fields, FieldChoice::From::near, &FieldChoice::from) != fields.end();
  const std::vector<Index> elements = has_near ? piece.elements_near(complex) : piece.elements;
  for (const Index e : elements)
    for (const Index v : complex.vertices_of(e)) read[v] = true;
  built.body().models().mark_for_fields(0, piece.vertices, read);
  built.body().models().mark_for_fields(3, elements, read);
  return read;
}

RowsAt::RowsAt(Body& body, const std::vector<bool>& vertices)
    : as_they_are_(body.attributes().partial_rows()), force_(body.attributes().force()) {
  const PartialRows& partial = body.attributes().partial_rows();
  std::vector<double*> columns;
  const auto add = [&](PartialRows::Of which, Column& column) {
    if (partial.is_partial(which)) columns.push_back(column.rows());
  };
  add(PartialRows::position, body.attributes().position());
  add(PartialRows::velocity, body.attributes().velocity());
  add(PartialRows::force, force_);
  if (columns.empty()) return;
  std::vector<Index> taken = body.share()->join_at(vertices, columns);
  if (partial.is_partial(PartialRows::force)) with_force_ = std::move(taken);
}

/// Forces at vertices that others step are 0 when the next are added.
RowsAt::~RowsAt() {
  for (const Index v : with_force_) std::fill_n(force_.rows() + std::size_t{v} * 4, 4, 0.0);
}

Frame join_pieces(const Frame& mine, BodyShare& share) {
  Frame piece = mine, whole;
  StateBuffer buffer;
  buffer.save(piece);
  share.collect(buffer.bytes(), [&](const BodyShare::Bytes& bytes) {
    Frame next;
    StateBuffer(bytes).load(next);
    add_piece(whole, std::move(next));
  });
  return whole;
}

}  // namespace suture
