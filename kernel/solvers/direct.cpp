// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/direct.hpp"

#include <algorithm>

#include "kernel/solvers/factored_rows.hpp"
#include "kernel/solvers/galerkin.hpp"
#include "kernel/solvers/links.hpp"

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
    if (elements_.begin.empty()) analyse(a);
    add_links(a);
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
    elements_ = pattern_of(graph);
  }

  /// Which may be different ones each time.
  void add_links(const TangentMatrix& a) {
    const NodeGraph links = links_of(a);
    if (links.cells() == 0 && !pattern_.begin.empty() && !has_links_) return;
    has_links_ = links.cells() != 0;
    pattern_ = extended(elements_, links);
    factor_.analyse(pattern_);
  }

  const CellComplex& complex_;
  Attributes& attributes_;
  Interpolation vertices_;
  BlockPattern elements_, pattern_;  ///< without and with links
  bool has_links_ = false;
  Held held_;
  std::vector<bool> loose_, no_nodes_;
  FactoredRows factor_;
};

}  // namespace

std::unique_ptr<Preconditioner> make_direct(const CellComplex& complex, Attributes& attributes) {
  return std::make_unique<Direct>(complex, attributes);
}

}  // namespace suture
