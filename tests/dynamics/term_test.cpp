// SPDX-License-Identifier: GPL-3.0-or-later
//
// A force term and a follower unknown to the kernel: each is one class and one line.
#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "kernel/spectrum/modes.hpp"
#include "tests/dynamics/model_block.hpp"
#include "tests/dynamics/rig.hpp"

namespace {

using namespace suture;

/// Springs from every vertex to where it was at rest, f = -kappa m u: they add kappa to the
/// square of each frequency of a body.
class Foundation final : public ForceTerm,
                         public TangentTerm,
                         public BoundedTerm,
                         public EnergyTerm {
 public:
  Foundation(Attributes& attributes, double kappa) : attributes_(attributes), kappa_(kappa) {}
  const char* name() const override { return "foundation"; }

  void add_forces(double, const LiveMask& live, double* rows) override {
    for (Index v = 0; v < attributes_.vertex_count(); ++v)
      for (int c = 0; c < 3 && live[v]; ++c)
        rows[4 * std::size_t{v} + static_cast<std::size_t>(c)] += force(v, c);
  }
  void add_forces_at(const VertexSelection&, std::span<const Index> vertices, double,
                     std::vector<Vec3>& forces) override {
    for (std::size_t i = 0; i < vertices.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c) forces[i][c] += force(vertices[i], static_cast<int>(c));
  }
  void add_tangent(const double* d, double dx, double, const TangentTime&, double* out) override {
    for (Index v = 0; v < attributes_.vertex_count(); ++v)
      for (std::size_t c = 0; c < 3; ++c)
        out[3 * std::size_t{v} + c] -= stiffness(v) * dx * d[3 * std::size_t{v} + c];
  }
  void add_bounds(double, const AddBounds& sums) override {
    for (Index v = 0; v < attributes_.vertex_count(); ++v) {
      const double k = stiffness(v), stiff[6] = {k, k, k, 0, 0, 0}, damping[6] = {};
      sums(v, stiff, damping);
    }
  }
  double energy(double) override {
    double sum = 0;
    for (Index v = 0; v < attributes_.vertex_count(); ++v)
      for (int c = 0; c < 3; ++c) sum += stiffness(v) * u(v, c) * u(v, c) / 2;
    return sum;
  }
  void state(Archive& archive) override { archive("kappa", kappa_); }
  void set(double kappa) { kappa_ = kappa; }

 private:
  double u(Index v, int c) const {
    return attributes_.position().get(v, c) - attributes_.rest().get(v, c);
  }
  double stiffness(Index v) const { return kappa_ * attributes_.mass().get(v, 0); }
  double force(Index v, int c) const { return -stiffness(v) * u(v, c); }

  Attributes& attributes_;
  double kappa_;
};

Foundation& found(Body& body, double kappa) {
  return body.add(std::make_unique<Foundation>(body.attributes(), kappa));
}

void shift(Body& body, double u) {
  Column& x = body.attributes().position();
  for (Index v = 0; v < x.size(); ++v) x.set(v, 0, x.get(v, 0) + u);
}

Dart inner_face(const Body& body) {
  Dart face = 0;
  while (!body.complex().can_cut(face)) face += 4;
  return face;
}

TEST(Term, SwingsABodyAtItsFrequencyAndClosesTheLedger) {
  for (const char* scheme : rig::schemes) {
    rig::Options options;
    options.integrator = scheme;
    rig::Moving block(spring_model::box(3, 2, 2), options);
    constexpr double kappa = 100, amplitude = 0.01;
    found(block.body, kappa);
    shift(block.body, amplitude);
    block.start();
    const double period = 2 * std::acos(-1.0) / std::sqrt(kappa);
    constexpr int steps = 2000;
    block.run(period / steps, steps / 2);
    EXPECT_NEAR(block.shift(0), -amplitude, 1e-5 * amplitude) << scheme;
    block.run(period / steps, steps / 2);
    block.dynamics.synchronise();
    EXPECT_NEAR(block.shift(0), amplitude, 1e-5 * amplitude) << scheme;
    const EnergyBalance b = block.dynamics.balance();
    EXPECT_NEAR(b.elastic, kappa * block.mass() * amplitude * amplitude / 2, 1e-4 * b.exchanged);
    EXPECT_NEAR(b.balance, 0, 1e-5 * b.exchanged);
  }
}

TEST(Term, CountsInTheLimitsOfTheStepAndInTheLowestMode) {
  const std::map<std::string, double> tissue{{"E", 1e4}, {"nu", 0.3}, {"rho", 1000}};
  rig::Block plain("tm-faure", tissue, {3, 3, 3}, 0.1, {});
  rig::Block founded("tm-faure", tissue, {3, 3, 3}, 0.1, {});
  const double free_step = plain.stable_step(), kappa = std::pow(2 / free_step, 2);
  found(founded.body, kappa);
  EXPECT_NEAR(founded.limits.bounds(0).stiffness - plain.limits.bounds(0).stiffness, kappa,
              1e-9 * kappa);
  EXPECT_NEAR(founded.stable_step(), free_step / std::sqrt(2.0), 0.02 * free_step);
  const LowestMode mode = find_lowest_mode(founded.body, 0, 400);
  EXPECT_NEAR(mode.eigenvalue, kappa, 1e-6 * kappa);
}

// Nothing moves there, so no velocity shows it.
TEST(Term, MustBeFiniteOnHeldVertices) {
  for (const char* scheme : rig::schemes) {
    rig::Options options;
    options.integrator = scheme;
    rig::Moving block(spring_model::box(2, 2, 2), options);
    Foundation& foundation = found(block.body, 1);
    std::vector<Index> all(block.body.attributes().vertex_count());
    std::iota(all.begin(), all.end(), 0);
    block.hold(all, 7);
    block.start();
    block.run(0.01, 3);
    foundation.set(std::numeric_limits<double>::quiet_NaN());
    EXPECT_THROW(block.run(0.01, 2), NotFinite) << scheme;
    foundation.set(1);
    EXPECT_NO_THROW(block.run(0.01, 2)) << "the state before is whole: " << scheme;
  }
}

TEST(Term, FollowsACutAndGoesBackWithTheBody) {
  rig::Moving block(spring_model::box(4, 2, 2));
  Foundation& term = found(block.body, 100);
  shift(block.body, 0.01);
  block.start();
  block.run(1e-4, 100);
  const double before = energies(block.dynamics).total();
  const Dart face = inner_face(block.body);
  EXPECT_GT(block.body.cut({face}).faces_cut, 0u);
  EXPECT_NEAR(energies(block.dynamics).total(), before, 1e-12 * before);

  StateBuffer kept;
  kept.save(block.dynamics);
  block.run(1e-4, 50);
  const std::vector<double> once = block.state();
  term.set(7);
  kept.load(block.dynamics);
  block.run(1e-4, 50);
  rig::expect_same_bits(block.state(), once);
}

TEST(Follower, HearsOfEveryOperationInTheOrderOfTheList) {
  struct Listener : Follower {
    explicit Listener(std::string& text, char letter) : heard(text), name(letter) {}
    void before(const ComingOperation&) override { heard += name; }
    void follow(const CellComplex& complex, const TopologyChange& change) override {
      heard += static_cast<char>(name - 'a' + 'A');
      faces += change.faces_cut;
      vertices = complex.count(0);
    }
    std::string& heard;
    char name;
    Index faces = 0, vertices = 0;
  };
  rig::Moving block(spring_model::box(4, 2, 2));
  std::string heard;
  Listener first(heard, 'a'), second(heard, 'b');
  block.body.add_follower(first);
  block.body.add_follower(second);
  block.start();
  const Dart face = inner_face(block.body);
  block.body.cut({face});
  EXPECT_EQ(heard, "abAB");
  EXPECT_EQ(first.faces, 1u);
  EXPECT_EQ(first.vertices, block.body.attributes().vertex_count());
  EXPECT_THROW(block.body.cut({face}), TopologyError);  // it is open
  EXPECT_EQ(heard, "abABab");
}

}  // namespace
