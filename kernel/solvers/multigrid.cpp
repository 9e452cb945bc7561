// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/multigrid.hpp"

#include "kernel/solvers/direct.hpp"
#include "kernel/solvers/galerkin.hpp"
#include "kernel/solvers/links.hpp"
#include "kernel/solvers/multigrid_levels.hpp"
#include "kernel/solvers/stop_test.hpp"

namespace suture {
namespace {

class Multigrid final : public Preconditioner {
 public:
  Multigrid(const CellComplex& complex, Attributes& attributes, const MultigridOptions& options)
      : complex_(complex), attributes_(attributes), options_(options) {}

  std::string name() const override { return direct_ ? direct_->name() : "multigrid"; }
  double shift() const override { return direct_ ? direct_->shift() : coarsest_.shift(); }
  std::size_t bytes() const override;

  std::size_t levels() const override { return end_is_found_ ? levels_.size() : 0; }

  void build(const TangentMatrix& a) override {
    if (levels_.empty()) make(a);
    if (direct_) return direct_->build(a);
    add_links(a);
    if (!end_is_found_) return find_end(a);
    factor(a, make_operators(a, false).back());
  }

  CoarseLevels coarse_levels(const TangentMatrix& a) override {
    if (levels_.empty()) make(a);
    if (direct_) return {};
    return {&levels_, &coarsest_};
  }

  void apply(const double* r, double* z) const override {
    if (direct_) return direct_->apply(r, z);
    MultigridLevel& level = levels_[0];
    const double scale = to_single(r, level.r, level.workers);
    VCycle(levels_, coarsest_, options_.smoothing).run(0);
    to_double(level.x, scale, z, level.workers);
  }

 private:
  /// The hierarchy, without operators.
  void make(const TangentMatrix& a) {
    const NodeGraph vertices = vertex_graph(complex_, attributes_);
    on_grid_ = vertices.is_grid;
    levels_ = make_levels(vertices, a.free(), options_.coarsest_nodes, a.workers());
    patterns_.clear();
    const bool is_known = options_.levels > 1 && options_.levels <= levels_.size();
    if (is_known) levels_.resize(options_.levels);
    end_is_found_ = is_known || !options_.finds_end;
    if (levels_.size() == 1)
      direct_ = make_direct(complex_, attributes_);
    else
      coarsest_.analyse(levels_.back().pattern);
  }

  /// Makes room for the blocks of links, which may be different ones each time.
  void add_links(const TangentMatrix& a) {
    NodeGraph links = links_of(a);
    if (links.cells() == 0 && patterns_.empty()) return;
    if (patterns_.empty())
      for (const MultigridLevel& level : levels_) patterns_.push_back(level.pattern);
    for (std::size_t l = 1; l < levels_.size(); ++l) {
      links = coarser_links(links, levels_[l].to_finer, patterns_[l].rows());
      levels_[l].pattern = extended(patterns_[l], links);
    }
    coarsest_.analyse(levels_.back().pattern);
  }

  /// Builds everything, and finds where coarsening ends. A failure leaves no hierarchy.
  void find_end(const TangentMatrix& a) try {
    const std::vector<BlockRows<double>> operators = make_operators(a, true);
    factor(a, operators.back());
    StopTest test(levels_, coarsest_, options_.smoothing, on_grid_, complex_.existing(3));
    while (const std::size_t last = test.next_direct_level()) {
      levels_.resize(last + 1);
      factor(a, operators[last - 1]);
    }
    end_is_found_ = true;
  } catch (...) {
    levels_.clear();
    throw;
  }

  /// Sets the operators and smoothers of all levels but the coarsest. Returns the operators from
  /// level 1 on; only the last one unless `keep`.
  std::vector<BlockRows<double>> make_operators(const TangentMatrix& a, bool keep) {
    levels_[0].multiply = [&a](const float* x, float* y) { a.apply(x, y); };
    DiagonalBlocks diagonal;
    std::vector<BlockRows<double>> operators;
    operators.push_back(project(a, levels_[1].to_finer, levels_[1].pattern, &diagonal));
    set_smoother(levels_[0], std::move(diagonal));
    for (std::size_t l = 1;; ++l) {
      hold(operators.back(), levels_[l].held);
      if (l + 1 == levels_.size()) return operators;
      set_operator(levels_[l], operators.back());
      operators.push_back(
          project(operators.back(), levels_[l + 1].to_finer, levels_[l + 1].pattern));
      if (!keep) operators.erase(operators.begin());
    }
  }

  void factor(const TangentMatrix& a, const BlockRows<double>& rows) {
    const MultigridLevel& level = levels_.back();
    coarsest_.factor(rows, level.held, a.has_mass() ? std::vector<bool>() : level.loose);
  }

  const CellComplex& complex_;
  Attributes& attributes_;
  MultigridOptions options_;
  mutable MultigridLevels levels_;      ///< with scratch vectors
  std::vector<BlockPattern> patterns_;  ///< of the levels without links; empty if there are none
  bool on_grid_ = false;
  bool end_is_found_ = false;  ///< of coarsening
  FactoredRows coarsest_;
  std::unique_ptr<Preconditioner> direct_;  ///< of a body that is too small for levels
};

std::size_t Multigrid::bytes() const {
  if (direct_) return direct_->bytes();
  std::size_t sum = coarsest_.bytes();
  for (const MultigridLevel& level : levels_) sum += level.bytes();
  return sum;
}

}  // namespace

std::unique_ptr<Preconditioner> make_multigrid(const CellComplex& complex, Attributes& attributes,
                                               const MultigridOptions& options) {
  return std::make_unique<Multigrid>(complex, attributes, options);
}

}  // namespace suture
