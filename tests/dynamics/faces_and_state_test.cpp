// SPDX-License-Identifier: GPL-3.0-or-later
//
// Functors on faces, and state with a trial copy, through a model of C tables.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "kernel/dynamics/dynamics.hpp"
#include "tests/forces/spring_model.hpp"

namespace {

using namespace suture;
using spring_model::Body;
using spring_model::box;

constexpr std::uint32_t lanes = SUTURE_LANES;
constexpr double interior_weight = 1e6;  // energy of an interior face; 1 of a boundary face

/// A quarter of the face's area vector on each node: diagonals' product / 8.
suture_status outward(const suture_context*, const suture_batch* batch) {
  const auto x = [&](std::size_t n, std::size_t c, std::size_t l) {
    return batch->position[(n * 3 + c) * lanes + l];
  };
  for (std::size_t l = 0; l < lanes; ++l) {
    Vec3 p, q;
    for (std::size_t c = 0; c < 3; ++c) {
      p[c] = x(2, c, l) - x(0, c, l);
      q[c] = x(3, c, l) - x(1, c, l);
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t d = (c + 1) % 3, e = (c + 2) % 3;
      for (std::size_t n = 0; n < 4; ++n)
        batch->force[(n * 3 + c) * lanes + l] = (p[d] * q[e] - p[e] * q[d]) / 8;
    }
  }
  return SUTURE_OK;
}

suture_status nothing(const suture_context*, const suture_batch* batch) {
  std::fill_n(batch->force, batch->nodes * 3 * lanes, 0.0);
  return SUTURE_OK;
}

/// The state counts the steps.
suture_status count(const suture_context* context, const suture_batch* batch) {
  for (std::uint32_t l = 0; l < lanes; ++l)
    batch->trial_columns[0][l] = batch->cell_columns[0][l] + 1;
  return nothing(context, batch);
}

template <int Weight>
suture_status weight(const suture_context*, const suture_batch*, double* out) {
  std::fill_n(out, lanes, static_cast<double>(Weight));
  return SUTURE_OK;
}
const suture_energy_1 one{sizeof(suture_energy_1), 0, weight<1>};
const suture_energy_1 many{sizeof(suture_energy_1), 0, weight<1000000>};
const void* boundary_extension(const char* id) {
  return std::strcmp(id, SUTURE_ENERGY_1) == 0 ? &one : nullptr;
}
const void* interior_extension(const char* id) {
  return std::strcmp(id, SUTURE_ENERGY_1) == 0 ? &many : nullptr;
}

suture_status mass(const suture_context*, const suture_batch*, double* out) {
  std::fill_n(out, 8 * lanes, 1.0);
  return SUTURE_OK;
}

struct Tables {
  Tables() {
    attributes[0] = {sizeof(suture_attribute),
                     0,
                     1,
                     SUTURE_FROM_VOLUMES,
                     SUTURE_SHARED_MASS,
                     1,
                     "mass",
                     "kg",
                     "",
                     0,
                     &masses,
                     0,
                     0};
    attributes[1] = {sizeof(suture_attribute),
                     3,
                     1,
                     SUTURE_COPY,
                     SUTURE_TRIAL,
                     0,
                     "age",
                     "1",
                     "",
                     0,
                     nullptr,
                     0,
                     0};
    for (suture_functor& f : functors) {
      f.size = sizeof f;
      f.lanes = lanes;
      f.doc = "";
    }
    for (std::size_t i = 0; i < 2; ++i) {
      functors[i].dimension = 2;
      functors[i].cell_type = SUTURE_QUADRILATERAL;
      functors[i].reads = SUTURE_READ_POSITION;
    }
    functors[0].name = "boundary";
    functors[0].faces = SUTURE_BOUNDARY_FACES;
    functors[0].force = outward;
    functors[0].extension = boundary_extension;
    functors[1].name = "interior";
    functors[1].faces = SUTURE_INTERIOR_FACES;
    functors[1].force = nothing;
    functors[1].extension = interior_extension;
    for (std::size_t i = 2; i < 4; ++i) {
      functors[i].name = i == 2 ? "boxes" : "others";
      functors[i].dimension = 3;
      functors[i].cell_type = SUTURE_HEXAHEDRON;
      functors[i].shape = i == 2 ? SUTURE_PARALLELEPIPED : SUTURE_GENERAL;
      functors[i].cell_column_count = 1;
      functors[i].cell_columns = &age;
      functors[i].force = count;
    }
    model.size = sizeof model;
    model.id = "test-faces";
    model.doc = model.formula = model.citation = "";
    model.attribute_count = 2;
    model.functor_count = 4;
    model.attributes = attributes;
    model.functors = functors;
  }
  std::uint32_t age = 1;
  suture_contribution masses{sizeof(suture_contribution), SUTURE_HEXAHEDRON, mass};
  suture_attribute attributes[2]{};
  suture_functor functors[4]{};
  suture_model model{};
};

struct FaceBody : Body {
  explicit FaceBody(bool distorted) : Body(box(5, 4, 3), distorted) {
    static const Tables tables;
    instance = &attributes().add(
        std::make_unique<Instance>(tables.model, "faces", std::vector<double>{}, diagnostics),
        complex(), {});
    compile();
  }
  double faces(bool boundary) const {
    double n = 0;
    for (Index f = 0; f < complex().count(2); ++f)
      n += (complex().beta3(complex().dart_of(2, f)) == none) == boundary;
    return n;
  }
  Instance* instance;
};

TEST(Faces, BoundaryFollowsCutsAndPointsOutward) {
  FaceBody body(false);
  for (unsigned seed = 1; seed <= 6; ++seed) {
    EXPECT_EQ(body.models().energy(0), body.faces(true) + interior_weight * body.faces(false));
    Column& force = body.attributes().force();
    std::fill(force.rows(), force.rows() + std::size_t{force.size()} * 4, 0.0);
    body.models().add_forces(0, 0);
    // Work in a uniform expansion: the surface integral of x . n is three volumes,
    // cut open or not.
    double work = 0;
    for (Index v = 0; v < body.attributes().vertex_count(); ++v)
      for (int c = 0; c < 3; ++c) work += force.get(v, c) * body.attributes().position().get(v, c);
    EXPECT_NEAR(work, 3 * 0.5 * 0.4 * 0.3, 1e-14) << seed;
    body.cut_random(7, seed);
  }
}

TEST(TrialColumns, AreAcceptedOncePerStepInEveryRow) {
  FaceBody body(true);
  ASSERT_GT(body.instance->general_begin % 8, 0u) << "one block is to hold both shapes";
  Dynamics dynamics(body, {});
  dynamics.start();
  for (int i = 0; i < 3; ++i) dynamics.step(1e-6, (i + 1) * 1e-6);
  dynamics.synchronise();  // evaluates again, accepts nothing
  dynamics.step(1e-6, 4e-6);
  const Column& age = *body.instance->column(1);
  for (Index row = 0; row < age.size(); ++row) EXPECT_EQ(age.get(row, 0), 4) << row;
}

}  // namespace
