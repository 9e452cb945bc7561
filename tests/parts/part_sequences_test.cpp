// SPDX-License-Identifier: GPL-3.0-or-later
//
// Random sequences of operations on bodies whose elements are parts: planes, discs, balls and bowls
// divide, elements are removed, faces are cut, sutures take divisions back where they are wanted.
// After each, the volume, a closed and oriented surface, a valid map and the pieces are right.
#include <cmath>
#include <cstdlib>
#include <random>

#include "tests/geometry/surfaces.hpp"
#include "tests/parts/cut_box.hpp"

namespace suture::test::part_sequences_test {
namespace {

constexpr Index size = 5;

struct Sequence {
  explicit Sequence(unsigned seed) : random(seed), box({size, size, size}) {}

  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  }
  Vec3 place() { return {between(0, size), between(0, size), between(0, size)}; }
  Vec3 direction() {
    std::normal_distribution<double> normal;
    const Vec3 n{normal(random), normal(random), normal(random)};
    return scaled(1 / norm(n), n);
  }

  void cut_plane() { box.cut(PlanePatch{.point = place(), .normal = direction()}); }
  void cut_disc() {
    PlanePatch disc{.point = place(), .normal = direction()};
    disc.radius = between(1, 4);
    box.cut(disc);
  }
  void cut_ball() { box.cut(SurfacePatch(sphere_surface(place(), between(1, 3), 3))); }
  /// A part of a ball, with a rim.
  void cut_bowl() {
    TriangleSurface bowl = sphere_surface(place(), between(1.5, 4), 3);
    const Vec3 side = direction(), other = bowl.points[0];
    std::erase_if(bowl.triangles, [&](const Triangle& t) {
      return dot(side, minus(bowl.points[t[0]], other)) < 0;
    });
    if (!bowl.triangles.empty()) box.cut(SurfacePatch(bowl));
  }
  void remove() {
    std::vector<Index> elements;
    for (Index e = 0; e < box.complex.element_count(); ++e)
      if (box.complex.exists(3, e) && random() % 40 == 0) elements.push_back(e);
    if (elements.empty() || elements.size() == box.complex.existing(3)) return;
    for (const Index e : elements) volume -= box.part(e) ? box.part(e)->fraction : 1;
    box.remove(elements);
  }
  void sew() {
    std::vector<std::uint8_t> is_wanted;
    for (Index e = 0; e < box.complex.element_count(); ++e)
      is_wanted.push_back(random() % 4 != 0 ? 1 : 0);
    box.sew_parts(is_wanted);
    sew_faces();
  }
  /// Whole faces that cuts have opened.
  void sew_faces() {
    const FaceContacts contacts(box.parts.parts());
    SeamBatch batch(box.complex);
    for (const Seam& seam : seams_of_cuts(box.complex, box.point, {}).seams)
      if (random() % 4 != 0 && contacts.area(seam) > 0) batch.add(seam);
    box.sew(batch.seams());
  }
  void cut_faces() {
    std::vector<Dart> faces;
    for (Index e = 0; e < box.complex.element_count(); ++e)
      for (int f = 0; f < hexahedron::faces && box.complex.exists(3, e); ++f)
        if (const Index n = box.complex.neighbour(e, f); n != none && n > e && random() % 10 == 0)
          faces.push_back(face_dart(e, f));
    box.follow(box.complex.cut(faces));
  }
  void operate() {
    switch (random() % 10) {
      case 0:
        cut_plane();
        break;
      case 1:
      case 2:
        cut_disc();
        break;
      case 3:
        cut_ball();
        break;
      case 4:
        cut_bowl();
        break;
      case 5:
        remove();
        break;
      case 6:
        cut_faces();
        break;
      default:
        sew();
    }
  }

  std::mt19937_64 random;
  CutBox box;
  double volume = size * size * size;
};

TEST(part_sequences, keep_volume_surface_and_map) {
  const unsigned runs = std::getenv("SUTURE_FULL") ? 10000 : 60;
  for (unsigned seed = 1; seed <= runs && !HasFatalFailure(); ++seed) {
    Sequence sequence(seed);
    for (unsigned i = 0; i < 1 + seed % 6; ++i) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", operation " + std::to_string(i));
      sequence.operate();
      const CutBox& box = sequence.box;
      ASSERT_NO_FATAL_FAILURE(expect_valid(box));
      ASSERT_NEAR(box.volume(), sequence.volume, 1e-10);
      const Embedding& embedding = sequence.box.parts.embedding(box.complex);
      ASSERT_NO_FATAL_FAILURE(expect_closed(embedding));
      ASSERT_NEAR(surface_volume(box, embedding), sequence.volume, 1e-10);
    }
  }
}

}  // namespace
}  // namespace suture::test::part_sequences_test
