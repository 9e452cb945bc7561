// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/cgal_cut.hpp"

#include "apps/suture-bench/lcc_build.hpp"

namespace suture::bench {
namespace {

struct PaperParticle : lcc::Motion {
  double mass = 0;
};
struct PaperSpring {
  double stiffness = 0, tension = 0;
};
struct PaperElement {
  lcc::Share share;
  std::array<std::array<const void*, 4>, 6> dart;  ///< addresses: handles are not known yet
  std::array<double, 4> inner_length;
  double inner_stiffness;
};

struct PaperItems {
  template <class Refs>
  struct Dart_wrapper {
    using Vertex = CGAL::Cell_attribute_with_point<Refs, PaperParticle>;
    using Edge = CGAL::Cell_attribute<Refs, PaperSpring>;
    using Face = CGAL::Cell_attribute<Refs>;
    using Volume = CGAL::Cell_attribute<Refs, PaperElement>;
    using Attributes = std::tuple<Vertex, Edge, Face, Volume>;
  };
};
using PaperMap = lcc::Complex<PaperItems>;

class CgalCut final : public CutBaseline {
 public:
  explicit CgalCut(const Mesh& mesh) : faces_(lcc::build(map_, mesh)) {
    lcc::add_attributes<1>(map_);
    lcc::add_attributes<2>(map_);
    lcc::add_attributes<3>(map_);
    const lcc::Sums<PaperMap> sums{map_};
    sums.fill(faces_);
    fill_elements();
    map_.onsplit_functor<0>() = [this](auto& old, auto& fresh) {
      lcc::Sums<PaperMap>{map_}.split_vertex(old, fresh);
    };
    map_.onsplit_functor<1>() = [this](auto& old, auto& fresh) {
      lcc::Sums<PaperMap>{map_}.split_edge(old, fresh);
    };
  }

  void cut(const std::vector<Dart>& faces) override {
    for (const Dart d : faces) map_.unsew<3>(faces_[d / 4]);
  }

  double mass() override { return lcc::total_mass(map_); }

 private:
  void fill_elements() {
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      auto& element = map_.info<3>(faces_[i]);
      auto& darts = element.dart[i % 6];
      PaperMap::Dart_handle d = faces_[i];
      for (std::size_t k = 0; k < 4; ++k, d = map_.beta(d, 1)) darts[k] = &*d;
      element.inner_length.fill(std::sqrt(3.0) * element.share.tension / element.share.stiffness);
      element.inner_stiffness = element.share.stiffness;
    }
  }

  PaperMap map_;
  std::vector<PaperMap::Dart_handle> faces_;  ///< 6 e + f
};

}  // namespace

std::unique_ptr<CutBaseline> make_cgal_cut(const Mesh& mesh) {
  return std::make_unique<CgalCut>(mesh);
}

}  // namespace suture::bench
