// SPDX-License-Identifier: GPL-3.0-or-later
#include <deque>

#include "apps/suture-bench/cgal_cut.hpp"
#include "apps/suture-bench/lcc_build.hpp"

namespace suture::bench {
namespace {

struct Particle;

struct Spring {
  double stiffness = 0, tension = 0;
  std::array<Particle*, 2> ends{};

  Particle* other(const Particle* one) const { return ends[ends[0] == one ? 1 : 0]; }
  void move(const Particle* from, Particle* to) {
    for (Particle*& end : ends)
      if (end == from) end = to;
  }
};

struct Particle : lcc::Motion {
  double mass = 0;
  std::vector<Spring*> inner;  ///< springs of the object that end here
};

/// What sums need to know of an element; its inner springs it does not know.
struct Element {
  lcc::Share share;
  unsigned seen = 0;  ///< in which split, so that each is visited once
};

struct Items {
  template <class Refs>
  struct Dart_wrapper {
    using Vertex = CGAL::Cell_attribute_with_point<Refs, Particle>;
    using Edge = CGAL::Cell_attribute<Refs, Spring>;
    using Face = CGAL::Cell_attribute<Refs>;
    using Volume = CGAL::Cell_attribute<Refs, Element>;
    using Attributes = std::tuple<Vertex, Edge, Face, Volume>;
  };
};
using Map = lcc::Complex<Items>;
using Handle = Map::Dart_handle;

class FlechonCut final : public CutBaseline {
 public:
  explicit FlechonCut(const Mesh& mesh) : faces_(lcc::build(map_, mesh)) {
    lcc::add_attributes<1>(map_);
    lcc::add_attributes<2>(map_);
    lcc::add_attributes<3>(map_);
    lcc::Sums<Map>{map_}.fill(faces_);
    attach_springs();
    map_.onsplit_functor<0>() = [this](auto& old, auto& fresh) {
      lcc::Sums<Map>{map_}.split_vertex(old, fresh);
      split_.push_back({&old.info(), &fresh.info(), fresh.dart()});
    };
    map_.onsplit_functor<1>() = [this](auto& old, auto& fresh) {
      lcc::Sums<Map>{map_}.split_edge(old, fresh);
    };
  }

  void cut(const std::vector<Dart>& faces) override {
    for (const Dart d : faces) {
      split_.clear();
      map_.unsew<3>(faces_[d / 4]);
      for (const SplitParticle& split : split_) {
        move_inner_springs(split);
        move_edge_springs(split);
      }
    }
  }

  double mass() override { return lcc::total_mass(map_); }

 private:
  struct SplitParticle {
    Particle *old, *fresh;
    Handle dart;  ///< starts at the fresh one
  };

  Particle* particle(Handle d) { return &map_.info<0>(d); }

  /// Where the inner spring from the start of d ends: along the face's diagonal, then
  /// along the edge away from the face.
  Handle opposite(Handle d) { return map_.beta(d, 1, 1, 2, 1, 1); }

  void attach_springs() {
    for (auto d = map_.darts().begin(); d != map_.darts().end(); ++d) {
      Spring& spring = map_.info<1>(d);
      if (!spring.ends[0]) spring.ends = {particle(d), particle(map_.beta(d, 1))};
    }
    for (std::size_t e = 0; e < faces_.size() / 6; ++e) {
      Handle d = faces_[6 * e];  // the four corners of a face, to their opposites
      for (int k = 0; k < 4; ++k, d = map_.beta(d, 1)) {
        const lcc::Share& share = map_.info<3>(d).share;
        inner_.push_back({share.stiffness,
                          std::sqrt(3.0) * share.tension,
                          {particle(d), particle(opposite(d))}});
        for (Particle* end : inner_.back().ends) end->inner.push_back(&inner_.back());
      }
    }
  }

  /// The list is split in two: inner springs of the elements around the fresh particle
  /// are those whose other end is opposite to it in one of these elements.
  void move_inner_springs(const SplitParticle& split) {
    ++stamp_;
    across_.clear();
    for (auto d = map_.darts_of_cell<0>(split.dart).begin(); d.cont(); ++d) {
      if (std::exchange(map_.info<3>(d).seen, stamp_) == stamp_) continue;
      across_.push_back(particle(opposite(d)));
    }
    split.fresh->inner.clear();  // the copy of the old particle's
    std::erase_if(split.old->inner, [&](Spring* spring) {
      const bool moves = std::ranges::find(across_, spring->other(split.old)) != across_.end();
      if (!moves) return false;
      spring->move(split.old, split.fresh);
      split.fresh->inner.push_back(spring);
      return true;
    });
  }

  /// Edges were split before, so each knows by its darts at which particle it ends.
  void move_edge_springs(const SplitParticle& split) {
    for (auto d = map_.darts_of_cell<0>(split.dart).begin(); d.cont(); ++d)
      map_.info<1>(d).move(split.old, split.fresh);
  }

  Map map_;
  std::vector<Handle> faces_;  ///< 6 e + f
  std::deque<Spring> inner_;
  std::vector<SplitParticle> split_;
  std::vector<Particle*> across_;
  unsigned stamp_ = 0;
};

}  // namespace

std::unique_ptr<CutBaseline> make_flechon_cut(const Mesh& mesh) {
  return std::make_unique<FlechonCut>(mesh);
}

}  // namespace suture::bench
