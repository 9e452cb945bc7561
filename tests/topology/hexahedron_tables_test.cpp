// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/hexahedron_tables.hpp"

#include <gtest/gtest.h>

#include <set>

#include "suture/plugin.h"

namespace suture::hexahedron {
namespace {

TEST(HexahedronTables, AreThoseOfThePluginContract) {
  for (int f = 0; f < 6; ++f)
    for (int k = 0; k < 4; ++k) EXPECT_EQ(dart_vertex[4 * f + k], suture_hexahedron_faces[f][k]);
  for (int e = 0; e < 12; ++e)
    for (int i = 0; i < 2; ++i) EXPECT_EQ(edge_vertices[e][i], suture_hexahedron_edges[e][i]);
}

TEST(HexahedronTables, FacesTurnCounterClockwiseSeenFromInside) {
  const auto at = [](int node, int axis) { return node >> axis & 1; };
  for (int f = 0; f < 6; ++f) {
    double normal[3], inward[3];
    for (int c = 0; c < 3; ++c) {
      const int u = (c + 1) % 3, v = (c + 2) % 3;
      const int p = dart_vertex[4 * f], q = dart_vertex[4 * f + 1], r = dart_vertex[4 * f + 2];
      normal[c] = (at(q, u) - at(p, u)) * (at(r, v) - at(q, v)) -
                  (at(q, v) - at(p, v)) * (at(r, u) - at(q, u));
      inward[c] = 0.5 - 0.5 * (at(p, c) + at(r, c));
    }
    EXPECT_GT(normal[0] * inward[0] + normal[1] * inward[1] + normal[2] * inward[2], 0) << f;
  }
}

TEST(HexahedronTables, IncidencesListEachDartOnceAscending) {
  std::set<int> seen;
  for (const auto& darts : vertex_darts) {
    EXPECT_TRUE(darts[0] < darts[1] && darts[1] < darts[2]);
    seen.insert(darts.begin(), darts.end());
  }
  EXPECT_EQ(seen.size(), 24u);
  for (int e = 0; e < 12; ++e)
    for (const int d : edge_darts[e]) EXPECT_EQ(dart_edge[d], e);
}

}  // namespace
}  // namespace suture::hexahedron
