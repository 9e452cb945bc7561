// SPDX-License-Identifier: GPL-3.0-or-later
//
// The C++ layer through the C boundary: what small models declare arrives in
// the tables, and their functions do what they say, for every instruction set.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <sstream>

#include "tests/plugins/plugin_batch.hpp"

namespace {

using namespace suture::test;

class Layer : public testing::TestWithParam<std::string> {
 protected:
  const suture_plugin& plugin(const char* name) {
    return load_plugin(SUTURE_PLUGIN_FOLDER, name, GetParam());
  }
  double uniform(double a) { return std::uniform_real_distribution<>(-a, a)(random); }
  std::mt19937 random{5};
};

/// Eight vertices or edges of a batch; columns and mass as the dashpot declares them.
struct CellBatch {
  suture::AlignedVector<double> at_rest, position, velocity, force, rest, mass;
  std::array<std::uint32_t, 8> ids{30, 31, 32, 33, 34, 35, 36, 37};
  const double *columns[1], *vertex_columns[1];
  suture_batch batch{};

  explicit CellBatch(std::uint32_t nodes)
      : at_rest(24 * nodes),
        position(24 * nodes),
        velocity(24 * nodes),
        force(24 * nodes),
        rest(16),
        mass(8 * nodes, 1.0) {
    columns[0] = rest.data();
    vertex_columns[0] = mass.data();
    batch.size = sizeof batch;
    batch.lanes = batch.valid = 8;
    batch.nodes = nodes;
    batch.rest = at_rest.data();
    batch.position = position.data();
    batch.velocity = velocity.data();
    batch.cell_columns = columns;
    batch.vertex_columns = vertex_columns;
    batch.cell_ids = ids.data();
    batch.force = force.data();
  }
  CellBatch(const CellBatch&) = delete;
  double at(const suture::AlignedVector<double>& v, int node, int c, int lane) const {
    return v[(node * 3 + c) * 8 + lane];
  }
};

TEST_P(Layer, PutsDeclarationsIntoTheTables) {
  const suture_plugin& p = plugin("dashpot");
  EXPECT_EQ(p.magic, SUTURE_MAGIC);
  EXPECT_EQ(p.abi_major, SUTURE_ABI_MAJOR);
  EXPECT_EQ(p.lanes, SUTURE_LANES);
  ASSERT_EQ(p.model_count, 1u);
  const suture_model& m = p.models[0];
  EXPECT_STREQ(m.id, "dashpot");
  ASSERT_EQ(m.parameter_count, 3u);
  const suture_parameter &k = m.parameters[0], &c = m.parameters[1], &mode = m.parameters[2];
  EXPECT_EQ(k.flags, SUTURE_REQUIRED | SUTURE_MINIMUM_EXCLUDED);
  EXPECT_EQ(k.minimum, 0);
  EXPECT_EQ(k.maximum, HUGE_VAL);
  EXPECT_EQ(c.flags, unsigned(SUTURE_MAXIMUM_EXCLUDED));
  EXPECT_EQ(c.default_value, 0.5);
  EXPECT_EQ(c.maximum, 1e6);
  ASSERT_EQ(mode.choice_count, 3u);
  EXPECT_STREQ(mode.choices[2], "throw");
  ASSERT_EQ(m.attribute_count, 1u);
  EXPECT_EQ(m.attributes[0].dimension, 1u);
  EXPECT_EQ(m.attributes[0].components, 2u);
  EXPECT_EQ(m.attributes[0].policy, unsigned(SUTURE_FROM_VOLUMES));
  ASSERT_EQ(m.attributes[0].contribution_count, 1u);
  EXPECT_EQ(m.attributes[0].contributions[0].cell_type, unsigned(SUTURE_HEXAHEDRON));
  ASSERT_EQ(m.functor_count, 1u);
  const suture_functor& f = m.functors[0];
  EXPECT_EQ(f.cell_type, unsigned(SUTURE_EDGE));
  EXPECT_EQ(f.reads, unsigned(SUTURE_READ_POSITION | SUTURE_READ_VELOCITY));
  ASSERT_EQ(f.cell_column_count, 1u);
  EXPECT_EQ(f.cell_columns[0], 0u);
  ASSERT_EQ(f.vertex_column_count, 1u);
  EXPECT_EQ(f.vertex_columns[0], UINT32_MAX);
  EXPECT_EQ(f.extension(SUTURE_ENERGY_1), nullptr);  // it has no energy()
  EXPECT_NE(f.extension(SUTURE_TANGENT_1), nullptr);
}

TEST_P(Layer, RefusesAndFiltersReads) {
  const suture_model& m = plugin("dashpot").models[0];
  ModelInstance refused(m, {10, 0.5, 1});
  ASSERT_EQ(refused.reports.size(), 1u);
  EXPECT_EQ(refused.reports[0].severity, SUTURE_ERROR);
  EXPECT_EQ(refused.reports[0].cell, UINT32_MAX);
  ModelInstance undamped(m, {10, 0, 0}), damped(m, {10, 1, 0});
  std::uint32_t reads = m.functors[0].reads;
  EXPECT_EQ(m.functors[0].enabled(damped.context(), &reads), 1);
  EXPECT_EQ(reads, m.functors[0].reads);
  EXPECT_EQ(m.functors[0].enabled(undamped.context(), &reads), 1);
  EXPECT_EQ(reads, unsigned(SUTURE_READ_POSITION));
}

TEST_P(Layer, ContributionsGoToTheirEdges) {
  const suture_model& m = plugin("dashpot").models[0];
  ModelInstance instance(m, {10, 1, 0});
  suture::AlignedVector<double> rest(192), out(12 * 2 * 8);
  for (int n = 0; n < 8; ++n)
    for (int lane = 0; lane < 8; ++lane)
      for (int c = 0; c < 3; ++c)
        rest[(n * 3 + c) * 8 + lane] = ((n >> c) & 1) * (1 + c) * (1 + 0.1 * lane);
  suture_batch batch{};
  batch.size = sizeof batch;
  batch.lanes = batch.valid = 8;
  batch.rest = rest.data();
  ASSERT_EQ(m.attributes[0].contributions[0].function(instance.context(), &batch, out.data()),
            SUTURE_OK);
  for (int k = 0; k < 12; ++k)
    for (int lane = 0; lane < 8; ++lane) {
      EXPECT_NEAR(out[(k * 2) * 8 + lane], (1 + k / 4) * (1 + 0.1 * lane), 1e-14);
      EXPECT_EQ(out[(k * 2 + 1) * 8 + lane], 1);
    }
}

TEST_P(Layer, ForceTangentAndBoundsOfSprings) {
  const suture_model& m = plugin("dashpot").models[0];
  const suture_functor& f = m.functors[0];
  const double k = 10, damping = 0.7;
  ModelInstance instance(m, {k, damping, 0});
  CellBatch e(2);
  suture::AlignedVector<double> dx(48), dv(48), df(48);
  for (int i = 0; i < 48; ++i) {
    e.position[i] = uniform(1);
    e.velocity[i] = uniform(1);
    dx[i] = uniform(1);
    dv[i] = uniform(1);
  }
  for (int lane = 0; lane < 8; ++lane) e.rest[lane] = 0.3, e.rest[8 + lane] = 1;
  const auto& tangent = ModelInstance::extension<suture_tangent_1>(f, SUTURE_TANGENT_1);
  ASSERT_EQ(tangent.apply(instance.context(), &e.batch, dx.data(), dv.data(), df.data()),
            SUTURE_OK);
  const auto forces_at = [&](double h) {
    for (int i = 0; i < 48; ++i) e.position[i] += h * dx[i], e.velocity[i] += h * dv[i];
    EXPECT_EQ(f.force(instance.context(), &e.batch), SUTURE_OK);
    return e.force;
  };
  const auto here = forces_at(0);
  for (int lane = 0; lane < 8; ++lane) {
    double d[3], w[3], length = 0, rate = 0;
    for (int c = 0; c < 3; ++c) {
      d[c] = e.at(e.position, 1, c, lane) - e.at(e.position, 0, c, lane);
      w[c] = e.at(e.velocity, 1, c, lane) - e.at(e.velocity, 0, c, lane);
      length += d[c] * d[c];
      rate += d[c] * w[c];
    }
    length = std::sqrt(length);
    const double tension = k * (length - 0.3) + damping * rate / length;
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(e.at(here, 0, c, lane), tension * d[c] / length, 1e-13);
      EXPECT_EQ(e.at(here, 1, c, lane), -e.at(here, 0, c, lane));
    }
  }
  const double h = 1e-6;
  const auto up = forces_at(h), down = forces_at(-2 * h);
  for (int i = 0; i < 48; ++i) EXPECT_NEAR(df[i], (up[i] - down[i]) / (2 * h), 1e-7 * k);

  // At rest length and rest the tangent is k u u' and c u u': largest eigenvalue
  // 2 k (2 c). The bound may exceed it by 3 %.
  suture::AlignedVector<double> stiffness(96), damp(96);
  for (int lane = 0; lane < 8; ++lane)
    for (int c = 0; c < 3; ++c) {
      e.position[c * 8 + lane] = 0;
      e.position[(3 + c) * 8 + lane] = c == lane % 3 ? 0.3 : 0;
      e.velocity[c * 8 + lane] = e.velocity[(3 + c) * 8 + lane] = 0;
    }
  const auto& bounds = ModelInstance::extension<suture_stable_dt_1>(f, SUTURE_STABLE_DT_1);
  ASSERT_EQ(bounds.bounds(instance.context(), &e.batch, stiffness.data(), damp.data()), SUTURE_OK);
  for (int n = 0; n < 2; ++n)
    for (int lane = 0; lane < 8; ++lane)
      for (int c = 0; c < 6; ++c) {
        const double s = stiffness[(n * 6 + c) * 8 + lane], d = damp[(n * 6 + c) * 8 + lane];
        EXPECT_GE(s, c < 3 ? 2 * k * (1 - 1e-12) : 0);
        EXPECT_LE(s, c < 3 ? 2 * k * 1.03 : 0);
        EXPECT_GE(d, c < 3 ? 2 * damping * (1 - 1e-12) : 0);
        EXPECT_LE(d, c < 3 ? 2 * damping * 1.03 : 0);
      }
}

TEST_P(Layer, TurnsAFailureIntoAStatusWithTheFirstCell) {
  const suture_model& m = plugin("dashpot").models[0];
  ModelInstance instance(m, {10, 1, 2});
  CellBatch e(2);
  for (int lane = 0; lane < 8; ++lane) {
    e.position[3 * 8 + lane] = lane == 3 || lane == 6 ? 2.5 : 1;
    e.rest[lane] = e.rest[8 + lane] = 1;
  }
  EXPECT_EQ(m.functors[0].force(instance.context(), &e.batch), SUTURE_RETRY);
  EXPECT_EQ(instance.error.cell, 33u);
  EXPECT_EQ(instance.error.step_factor, 0.5);
  EXPECT_STREQ(instance.error.text, "an edge is longer than 2 m");
}

// ----------------------------------------------------- a functor on vertices --

TEST_P(Layer, AnchorPullsAVertexToItsRestPosition) {
  const suture_model& m = plugin("anchor").models[0];
  const double k = 3, c = 0.5;
  ModelInstance instance(m, {k, c});
  CellBatch vertices(1);
  for (int i = 0; i < 24; ++i) {
    vertices.at_rest[i] = uniform(1);
    vertices.position[i] = uniform(1);
    vertices.velocity[i] = uniform(1);
    vertices.mass[i % 8] = 2 + uniform(1);
  }
  ASSERT_EQ(m.functors[0].force(instance.context(), &vertices.batch), SUTURE_OK);
  alignas(64) std::array<double, 8> energy;
  std::array<double, 8> expected{};
  const auto& energies = ModelInstance::extension<suture_energy_1>(m.functors[0], SUTURE_ENERGY_1);
  ASSERT_EQ(energies.energy(instance.context(), &vertices.batch, energy.data()), SUTURE_OK);
  for (int i = 0; i < 24; ++i) {
    const double u = vertices.position[i] - vertices.at_rest[i];
    EXPECT_NEAR(vertices.force[i], -k * u - c * vertices.mass[i % 8] * vertices.velocity[i], 1e-14);
    expected[i % 8] += k * u * u / 2;
  }
  for (int lane = 0; lane < 8; ++lane) EXPECT_NEAR(energy[lane], expected[lane], 1e-14);
}

// ------------------------------------------------ a law given by its energy --

TEST_P(Layer, NeoHookeFromItsEnergyAlone) {
  const suture_model& m = plugin("neo-hooke").models[0];
  const double mu = 2, lambda = 3, size = 0.5;
  ModelInstance instance(m, {mu, lambda, 1});
  for (const char* functor : {"parallelepipeds", "general hexahedra, geometry stored"}) {
    std::array<Hexahedron, 8> rest, x;
    for (int lane = 0; lane < 8; ++lane)
      for (int n = 0; n < 8; ++n)
        for (int c = 0; c < 3; ++c) {
          rest[lane][n][c] = ((n >> c) & 1) * size;
          if (functor[0] == 'g') rest[lane][n][c] += uniform(0.05);
          x[lane][n][c] = rest[lane][n][c] + uniform(0.05);
        }
    HexahedronBatch batch(instance, instance.functor(functor), rest);
    for (int lane = 0; lane < 8; ++lane) batch.move(lane, x[lane]);
    suture::AlignedVector<double> dx(192);
    for (auto& d : dx) d = uniform(1);
    const auto df = batch.tangent(dx);
    const auto move = [&](double h) {
      for (int lane = 0; lane < 8; ++lane)
        for (int i = 0; i < 24; ++i) batch.position(lane, i / 3, i % 3) += h * dx[i * 8 + lane];
      EXPECT_EQ(batch.force(), SUTURE_OK) << instance.error.text;
    };
    const double h = 1e-6;
    move(0);
    const std::vector<double> f(batch.batch.force, batch.batch.force + 192);
    move(h);
    const std::vector<double> up(batch.batch.force, batch.batch.force + 192);
    const auto energy_up = batch.energy();
    move(-2 * h);
    const auto energy_down = batch.energy();
    for (int i = 0; i < 192; ++i)
      EXPECT_NEAR(df[i], (up[i] - batch.batch.force[i]) / (2 * h), 1e-7);
    for (int lane = 0; lane < 8; ++lane) {
      double work = 0;
      for (int i = 0; i < 24; ++i) work += f[i * 8 + lane] * dx[i * 8 + lane];
      EXPECT_GT(std::abs(work), 1e-3);
      EXPECT_NEAR(work, -(energy_up[lane] - energy_down[lane]) / (2 * h), 1e-8);
    }
    // x = s X: F = s I, P = (mu (s - 1/s) + 3 lambda ln s / s) I, Cauchy = P / s^2.
    const double s = 1.2, P = mu * (s - 1 / s) + 3 * lambda * std::log(s) / s;
    for (int lane = 0; lane < 8; ++lane)
      for (int i = 0; i < 24; ++i)
        batch.position(lane, i / 3, i % 3) = s * rest[lane][i / 3][i % 3];
    const auto stress = batch.field("stress");
    for (int lane = 0; lane < 8; ++lane)
      for (int c = 0; c < 6; ++c) EXPECT_NEAR(stress[c * 8 + lane], c < 3 ? P / (s * s) : 0, 1e-13);
    // Turned inside out: ln J of a negative J.
    for (int i = 0; i < 24; ++i) batch.position(4, i / 3, i % 3) *= -1;
    EXPECT_EQ(batch.force(), SUTURE_RETRY);
    EXPECT_EQ(instance.error.cell, 14u);
  }
}

INSTANTIATE_TEST_SUITE_P(Isa, Layer, testing::ValuesIn(runnable_isas()),
                         [](const auto& isa) { return isa.param; });

std::string text_of(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

TEST(Documentation, ShowsPluginsAsTheyAreTested) {
  for (const char* name : {"neo_hooke.cpp", "anchor.cpp"}) {
    const std::string source = text_of(std::string(SUTURE_SOURCE_DIR "/tests/sdk/") + name);
    ASSERT_FALSE(source.empty()) << name;
    EXPECT_LE(std::count(source.begin(), source.end(), '\n'), 28) << name;
    EXPECT_NE(text_of(SUTURE_SOURCE_DIR "/docs/sdk.md").find(source), std::string::npos)
        << "docs/sdk.md shows another text than tests/sdk/" << name;
  }
}

}  // namespace
