// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/multigrid.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

#include "kernel/solvers/chebyshev.hpp"
#include "kernel/solvers/factored_rows.hpp"
#include "kernel/solvers/galerkin.hpp"

namespace suture {
namespace {

/// A level of the hierarchy: the finest one is that of the vertices.
struct Level {
  Interpolation to_finer;  ///< not of the finest level
  Held held;
  BlockPattern pattern;
  BlockRows<float> matrix;  ///< not of the finest level
  Chebyshev smoother;
  mutable SingleVector x, r;

  std::size_t nodes() const { return held.size() / 3; }
};

constexpr double block_shift = 1e-6;
constexpr unsigned power_steps = 20;

/// Coarsening ends when it removes less than this part of the nodes.
constexpr double least_gain = 0.15;

class Multigrid final : public Preconditioner {
 public:
  Multigrid(const CellComplex& complex, Attributes& attributes, const MultigridOptions& options)
      : complex_(complex), attributes_(attributes), options_(options) {}

  std::string name() const override { return "multigrid"; }
  void forget() override { levels_.clear(); }

  void build(const TangentMatrix& a) override {
    matrix_ = &a;
    if (levels_.empty()) make_levels(a);
    DiagonalBlocks diagonal;
    if (levels_.size() == 1) {
      coarsest_.factor(project(a, identity_, levels_[0].pattern), levels_[0].held, {});
      return;
    }
    BlockRows<double> rows = project(a, levels_[1].to_finer, levels_[1].pattern, &diagonal);
    set_smoother(0, diagonal);
    for (std::size_t l = 1;; ++l) {
      hold(rows, levels_[l].held);
      if (l + 1 == levels_.size()) break;
      levels_[l].matrix = in_single(rows);
      set_smoother(l, diagonal_of(rows));
      rows = project(rows, levels_[l + 1].to_finer, levels_[l + 1].pattern);
    }
    coarsest_.factor(rows, levels_.back().held, {});
  }

  void apply(const double* r, double* z) const override {
    const std::size_t size = levels_[0].nodes() * 3;
    double scale = 0;
    for (std::size_t i = 0; i < size; ++i) scale = std::max(scale, std::abs(r[i]));
    if (scale == 0 || levels_.size() == 1) return apply_directly(r, z);
    for (std::size_t i = 0; i < size; ++i) levels_[0].r[i] = static_cast<float>(r[i] / scale);
    cycle(0);
    for (std::size_t i = 0; i < size; ++i) z[i] = scale * levels_[0].x[i];
  }

 private:
  /// multiply(x, y): y = A x on a level.
  auto multiplier(std::size_t l) const {
    return [this, l](const float* x, float* y) {
      if (l == 0)
        matrix_->apply(x, y);
      else
        multiply(levels_[l].matrix, x, y);
    };
  }

  void make_levels(const TangentMatrix& a) {
    NodeGraph graph = vertex_graph(complex_, attributes_);
    levels_.emplace_back();
    levels_[0].held.resize(a.size());
    std::ranges::transform(a.free(), levels_[0].held.begin(), [](auto free) { return !free; });
    while (graph.nodes() > options_.coarsest_nodes) {
      Coarsening next = coarsen(graph);
      if (next.coarse.nodes() > (1 - least_gain) * graph.nodes()) break;
      const Held& finer = levels_.back().held;
      Held held = held_nodes(next.interpolation, next.coarse.nodes(), finer);
      graph = std::move(next.coarse);
      levels_.emplace_back();
      levels_.back().to_finer = std::move(next.interpolation);
      levels_.back().held = std::move(held);
      levels_.back().pattern = pattern_of(graph);
    }
    if (levels_.size() == 1) {
      identity_ = identity(graph);
      levels_[0].pattern = pattern_of(graph);
    }
    for (Level& level : levels_) {
      level.x = single_vector(level.nodes());
      level.r = single_vector(level.nodes());
    }
    coarsest_.analyse(levels_.back().pattern);
  }

  void set_smoother(std::size_t l, DiagonalBlocks diagonal) {
    const Level& level = levels_[l];
    for (std::size_t v = 0; v < diagonal.size(); ++v) {
      const std::uint8_t* held = &level.held[v * 3];
      invert(diagonal[v], {held[0] == 0, held[1] == 0, held[2] == 0}, block_shift);
    }
    Chebyshev& smoother = levels_[l].smoother;
    smoother.set(diagonal);
    smoother.estimate(multiplier(l), power_steps);
  }

  static DiagonalBlocks diagonal_of(const BlockRows<double>& a) {
    const BlockPattern& pattern = a.pattern();
    DiagonalBlocks blocks(pattern.rows(), Eigen::Matrix3d::Zero());
    for (Index row = 0; row < pattern.rows(); ++row)
      for (Index i = pattern.begin[row]; i < pattern.begin[row + 1]; ++i)
        if (pattern.column[i] == row) blocks[row] = Eigen::Map<const Eigen::Matrix3d>(a.block(i));
    return blocks;
  }

  void apply_directly(const double* r, double* z) const {
    const std::size_t size = levels_[0].nodes() * 3;
    std::copy_n(r, size, z);
    if (levels_.size() == 1) coarsest_.solve({z, size});
  }

  /// x = approximately A^-1 r on a level; destroys r.
  void cycle(std::size_t l) const {
    const Level& level = levels_[l];
    std::ranges::fill(level.x, 0.0f);
    if (l + 1 == levels_.size()) return solve_coarsest();
    level.smoother.smooth(multiplier(l), options_.smoothing, level.x, level.r, true);
    restrict(l);
    cycle(l + 1);
    prolong(l);
    level.smoother.smooth(multiplier(l), options_.smoothing, level.x, level.r, false);
  }

  void solve_coarsest() const {
    const Level& level = levels_.back();
    std::vector<double> x(level.r.begin(), level.r.end() - 1);
    coarsest_.solve(x);
    std::ranges::transform(x, level.x.begin(), [](double v) { return static_cast<float>(v); });
  }

  void restrict(std::size_t l) const {
    const Level &fine = levels_[l], &coarse = levels_[l + 1];
    const Interpolation& p = coarse.to_finer;
    std::ranges::fill(coarse.r, 0.0f);
    for (std::size_t v = 0; v < p.fine_nodes(); ++v)
      for (Index i = p.begin[v]; i < p.begin[v + 1]; ++i)
        for (std::size_t c = 0; c < 3; ++c)
          coarse.r[std::size_t{p.node[i]} * 3 + c] += p.weight[i] * fine.r[v * 3 + c];
    for (std::size_t i = 0; i < coarse.held.size(); ++i)
      if (coarse.held[i]) coarse.r[i] = 0;
  }

  /// Adds the correction of the next coarser level to x, and updates r.
  void prolong(std::size_t l) const {
    const Level &fine = levels_[l], &coarse = levels_[l + 1];
    const Interpolation& p = coarse.to_finer;
    SingleVector correction(fine.x.size()), image(fine.x.size());
    for (std::size_t v = 0; v < p.fine_nodes(); ++v)
      for (std::size_t c = 0; c < 3; ++c) {
        if (fine.held[v * 3 + c]) continue;
        float sum = 0;
        for (Index i = p.begin[v]; i < p.begin[v + 1]; ++i)
          sum += p.weight[i] * coarse.x[std::size_t{p.node[i]} * 3 + c];
        correction[v * 3 + c] = sum;
      }
    multiplier(l)(correction.data(), image.data());
    for (std::size_t i = 0; i < fine.x.size(); ++i) {
      fine.x[i] += correction[i];
      fine.r[i] -= image[i];
    }
  }

  const CellComplex& complex_;
  Attributes& attributes_;
  MultigridOptions options_;
  const TangentMatrix* matrix_ = nullptr;
  std::deque<Level> levels_;
  Interpolation identity_;
  FactoredRows coarsest_;
};

}  // namespace

std::unique_ptr<Preconditioner> make_multigrid(const CellComplex& complex, Attributes& attributes,
                                               const MultigridOptions& options) {
  return std::make_unique<Multigrid>(complex, attributes, options);
}

}  // namespace suture
