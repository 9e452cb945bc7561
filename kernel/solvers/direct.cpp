// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/direct.hpp"

#include <algorithm>

#include "kernel/solvers/factored_rows.hpp"
#include "kernel/solvers/galerkin.hpp"

namespace suture {
namespace {

class Direct final : public Preconditioner {
 public:
  Direct(const CellComplex& complex, Attributes& attributes)
      : complex_(complex), attributes_(attributes) {}

  std::string name() const override { return "direct"; }
  std::size_t bytes() const override { return factor_.bytes(); }
  double shift() const override { return factor_.shift(); }

  void build(const TangentMatrix& a) override {
    if (pattern_.begin.empty()) analyse(a);
    factor_.factor(project(a, vertices_, pattern_), held_, a.has_mass() ? no_nodes_ : loose_);
  }

  void apply(const double* r, double* z) const override {
    std::copy_n(r, held_.size(), z);
    factor_.solve({z, held_.size()});
  }

 private:
  void analyse(const TangentMatrix& a) {
    const NodeGraph graph = vertex_graph(complex_, attributes_);
    held_.resize(a.size());
    std::ranges::transform(a.free(), held_.begin(), [](auto free) { return !free; });
    loose_ = loose_nodes(graph, held_);
    vertices_ = identity(graph);
    pattern_ = pattern_of(graph);
    factor_.analyse(pattern_);
  }

  const CellComplex& complex_;
  Attributes& attributes_;
  Interpolation vertices_;
  BlockPattern pattern_;
  Held held_;
  std::vector<bool> loose_, no_nodes_;
  FactoredRows factor_;
};

}  // namespace

std::unique_ptr<Preconditioner> make_direct(const CellComplex& complex, Attributes& attributes) {
  return std::make_unique<Direct>(complex, attributes);
}

}  // namespace suture
