// SPDX-License-Identifier: GPL-3.0-or-later
//
// How values change where elements are removed and faces are sewn.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "tests/attributes/bodies.hpp"

namespace suture {
namespace {

/// Pairs of faces that were one, to be sewn again.
std::vector<Seam> seams_of(const CellComplex& complex, const std::vector<Dart>& faces) {
  std::vector<Seam> seams;
  std::set<Dart> seen;
  for (const Dart d : faces)
    if (seen.insert(std::min(d & ~3u, complex.beta3(d) & ~3u)).second)
      seams.push_back({d, complex.beta3(d)});
  return seams;
}

/// Those that can be sewn one after the other: both elements are there.
std::vector<Seam> possible(const CellComplex& complex, std::vector<Seam> seams) {
  std::erase_if(seams, [&](const Seam& s) { return !complex.can_sew(s.one, s.other); });
  return seams;
}

std::vector<Index> random_elements(const CellComplex& complex, Random& random, double fraction) {
  std::vector<Index> elements;
  for (Index e = 0; e < complex.element_count(); ++e)
    if (complex.exists(3, e) && (random.number() + 1) / 2 < fraction) elements.push_back(e);
  if (elements.size() == complex.existing(3)) elements.pop_back();
  return elements;
}

/// Cuts, removes and sews at random, the change handed to `follow` each time.
struct Surgeon {
  FakeBody& body;
  Random& random;
  std::vector<Seam> open{};  // what was cut and not sewn

  template <class Follow>
  void operate(int rounds, Follow follow) {
    for (int i = 0; i < rounds; ++i) {
      switch (random() % 3) {
        case 0: {
          const auto faces = random_faces(body.complex, random, 0.3);
          const auto seams = seams_of(body.complex, faces);
          open.insert(open.end(), seams.begin(), seams.end());
          follow(body.complex.cut(faces));
          break;
        }
        case 1:
          follow(body.complex.pierce(random_elements(body.complex, random, 0.15)));
          break;
        default: {
          std::shuffle(open.begin(), open.end(), random);
          open = possible(body.complex, open);
          std::vector<Seam> now(open.begin(), open.begin() + static_cast<int>(open.size() / 2));
          open.erase(open.begin(), open.begin() + static_cast<int>(now.size()));
          follow(body.complex.sew(now));
        }
      }
      body.complex.validate();
    }
  }
};

double incident_volume(const Attributes& attributes, const CellComplex& complex,
                       const CellSet& region, int dimension, Index cell) {
  std::vector<Dart> star;
  complex.star(dimension, cell, star);
  double sum = 0;
  for (const Dart d : star)
    if (region.contains(d / 24))
      sum += hexahedron_volume(attributes.rest_places(complex).of(d / 24));
  return sum;
}

TEST(Merging, SumsAfterAnyOperationsHaveTheBitsOfAFreshStart) {
  const fake::Model model(fake::everything());
  for (int round = 0; round < 20; ++round) {
    Random random;
    FakeBody body({2 + static_cast<Index>(random() % 4), 3, 4}, &random);
    const Index count = body.complex.element_count();
    std::vector<std::vector<Index>> regions(1 + random() % 3);
    for (auto& region : regions)
      for (Index e = 0; e < count && regions.size() > 1; ++e)
        if (random() % 3 != 0) region.push_back(e);
    Attributes attributes(body.complex, body.rest);
    for (const auto& region : regions)
      add(attributes, body.complex, model.table, region, random.number() + 2);
    initialise(attributes, body.complex);
    Surgeon{body, random}.operate(8, [&](const TopologyChange& change) {
      attributes.apply(body.complex, change);
      Attributes fresh(body.complex, rest_of(attributes));
      for (std::size_t i = 0; i < regions.size(); ++i) {
        auto region = regions[i];
        std::erase_if(region, [&](Index e) { return !body.complex.exists(3, e); });
        if (!regions[i].empty() && region.empty()) return;  // nothing to compare with
        add(fresh, body.complex, model.table, region, attributes.instances()[i]->parameters()[0]);
      }
      initialise(fresh, body.complex);
      ASSERT_NO_FATAL_FAILURE(expect_same_sums(attributes, fresh));
    });
  }
}

TEST(Merging, RowsLiveWhereElementsOfTheRegionAre) {
  const fake::Model model(fake::everything());
  for (int round = 0; round < 10; ++round) {
    Random random;
    FakeBody body({3, 3, 3});
    std::vector<Index> region;
    for (Index e = 0; e < 27; ++e)
      if (random() % 2 == 0 || e == 5) region.push_back(e);
    if (round % 2 == 1) region.clear();  // all
    Attributes attributes(body.complex, body.rest);
    const Instance& instance = add(attributes, body.complex, model.table, region);
    initialise(attributes, body.complex);
    Surgeon{body, random}.operate(8, [&](const TopologyChange& change) {
      attributes.apply(body.complex, change);
      for (int d = 0; d < 4; ++d) {
        const CellSet& cells = instance.table(d).cells;
        Index live = 0;
        for (Index cell = 0; cell < body.complex.count(d); ++cell) {
          std::vector<Dart> star;
          if (d < 3 && body.complex.exists(d, cell)) body.complex.star(d, cell, star);
          if (d == 3 && body.complex.exists(d, cell)) star = {24 * cell};
          const bool inside = std::ranges::any_of(star, [&](Dart dart) {
            return region.empty() || std::ranges::binary_search(region, dart / 24);
          });
          ASSERT_EQ(cells.contains(cell), inside) << d << " " << cell;
          if (!inside) continue;
          ++live;
          ASSERT_TRUE(cells.is_live(cells.row(cell)));
          ASSERT_EQ(cells.cell(cells.row(cell)), cell);
        }
        ASSERT_EQ(cells.live_count(), live);
        ASSERT_EQ(
            instance.table(d).columns.empty() ? cells.size() : instance.table(d).columns[0].size(),
            cells.size());
      }
    });
  }
}

/// A shared amount that is the volume around each cell is that after any operation:
/// divided by volumes when cells part, added when they join, and what belonged to a
/// removed element goes with it.
TEST(Merging, SharesBelongToTheVolumesThatAreThere) {
  const fake::Model model({fake::attribute("v", 0, 2, nullptr, SUTURE_SHARE),
                           fake::attribute("e", 1, 1, nullptr, SUTURE_SHARE, SUTURE_TRIAL),
                           fake::attribute("f", 2, 3, nullptr, SUTURE_SHARE)});
  for (int round = 0; round < 12; ++round) {
    Random random;
    FakeBody body({3, 3, 2 + static_cast<Index>(random() % 3)}, &random);
    std::vector<Index> region;
    for (Index e = 0; e < body.complex.element_count() && round % 2 == 1; ++e)
      if (random() % 3 != 0) region.push_back(e);
    Attributes attributes(body.complex, body.rest);
    Instance& instance = add(attributes, body.complex, model.table, region);
    initialise(attributes, body.complex);
    const auto each = [&](auto visit) {
      for (int d = 0; d < 3; ++d) {
        const CellSet& cells = instance.table(d).cells;
        Column& column = *instance.column(static_cast<std::uint32_t>(d));
        for (Index row = 0; row < cells.size(); ++row)
          if (cells.is_live(row))
            for (int c = 0; c < column.spec().components; ++c)
              visit(column, row, c,
                    (c + 1) * incident_volume(attributes, body.complex, instance.table(3).cells, d,
                                              cells.cell(row)));
      }
    };
    each([](Column& column, Index row, int c, double v) {
      column.set(row, c, v);
      if (column.has_trial()) column.trial_block(row / 8)[row % 8] = v;
    });
    Surgeon{body, random}.operate(10, [&](const TopologyChange& change) {
      attributes.apply(body.complex, change);
      each([](Column& column, Index row, int c, double v) {
        ASSERT_NEAR(column.get(row, c), v, 1e-12 * v) << column.spec().name << " row " << row;
        if (column.has_trial()) {
          ASSERT_NEAR(column.trial_block(row / 8)[row % 8], v, 1e-12 * v);
        }
      });
    });
  }
}

/// COPY is a density: its integral stays when cells join. ZERO is an amount.
TEST(Merging, SewingKeepsTheIntegralsOfCopiesAndTheSumsOfAmounts) {
  std::vector<suture_attribute> attributes_of_model{fake::attribute(
      "mass", 0, 1, &fake::contribute<8, 1>, SUTURE_FROM_VOLUMES, SUTURE_SHARED_MASS)};
  const char* names[2][3] = {{"c0", "c1", "c2"}, {"z0", "z1", "z2"}};
  for (std::uint32_t d = 0; d < 3; ++d) {
    attributes_of_model.push_back(
        fake::attribute(names[0][d], d, 2, nullptr, SUTURE_COPY, d == 1 ? SUTURE_TRIAL : 0));
    attributes_of_model.push_back(fake::attribute(names[1][d], d, 1, nullptr, SUTURE_ZERO));
  }
  const fake::Model model(attributes_of_model);
  for (int round = 0; round < 12; ++round) {
    Random random;
    FakeBody body({3, 4, 3}, &random);
    std::vector<Index> region;
    for (Index e = 0; e < body.complex.element_count() && round % 2 == 1; ++e)
      if (random() % 3 != 0) region.push_back(e);
    Attributes attributes(body.complex, body.rest);
    Instance& instance = add(attributes, body.complex, model.table, region);
    initialise(attributes, body.complex);
    const auto faces = random_faces(body.complex, random, 0.6);
    const auto seams = seams_of(body.complex, faces);
    attributes.apply(body.complex, body.complex.cut(faces));
    for (std::uint32_t a = 1; a < model.attributes.size(); ++a)
      for (Index row = 0; row < instance.column(a)->size(); ++row)
        for (int c = 0; c < instance.column(a)->spec().components; ++c) {
          instance.column(a)->set(row, c, random.number() + 2);
          if (a == 3) instance.column(a)->trial_block(row / 8)[row % 8 + 8 * unsigned(c)] = 1.5;
        }
    const auto sums = [&] {
      std::vector<double> result;
      for (std::uint32_t a = 1; a < model.attributes.size(); ++a) {
        const Column& column = *instance.column(a);
        const int d = column.dimension();
        const CellSet& cells = instance.table(d).cells;
        const bool copy = column.spec().policy == SUTURE_COPY;
        for (int c = 0; c < column.spec().components; ++c) {
          double sum = 0;
          for (Index row = 0; row < cells.size(); ++row) {
            if (!cells.is_live(row)) continue;
            const Index cell = cells.cell(row);
            const double weight = !copy    ? 1
                                  : d == 0 ? attributes.mass().get(cell, 0)
                                           : incident_volume(attributes, body.complex,
                                                             instance.table(3).cells, d, cell);
            sum += weight * column.get(row, c);
          }
          // Vertices on the border of a region have mass that is not the region's.
          if (d != 0 || !copy || region.empty()) result.push_back(sum);
        }
      }
      return result;
    };
    const auto before = sums();
    const TopologyChange change = body.complex.sew(seams);
    ASSERT_GT(change.merges[1].size(), 10u);
    attributes.apply(body.complex, change);
    const auto after = sums();
    for (std::size_t i = 0; i < before.size(); ++i)
      EXPECT_NEAR(after[i], before[i], 1e-13 * before[i]) << "sum " << i;
    const CellSet& edges = instance.table(1).cells;
    for (Index row = 0; row < edges.size(); ++row)
      if (edges.is_live(row)) {
        ASSERT_EQ(instance.column(3)->trial_block(row / 8)[row % 8], 1.5);
      }
  }
}

/// Two halves of a box, drawn apart at rest by `gap` and moved together again.
struct Halves : FakeBody {
  Halves(Index n, Random* random, const Vec3& gap) : FakeBody({2 * n, n, n}, random, 0.1) {
    std::vector<Dart> faces;
    for (Index e = 0; e < complex.element_count(); ++e)
      if (e % (2 * n) == n - 1) faces.push_back(24 * e + 8);  // x = 1 of the left half
    seams = seams_of(complex, faces);
    const TopologyChange change = complex.cut(faces);
    position = rest;
    for (const Split& split : change.splits[0]) position.push_back(position[split.old_cell]);
    rest = position;
    std::set<Index> right;
    for (Index e = 0; e < complex.element_count(); ++e)
      if (e % (2 * n) >= n)
        right.insert(complex.vertices_of(e).begin(), complex.vertices_of(e).end());
    for (const Index v : right)
      for (std::size_t c = 0; c < 3; ++c) rest[v][c] += gap[c];
  }
  void place(Attributes& attributes) const {
    for (Index v = 0; v < position.size(); ++v)
      for (int c = 0; c < 3; ++c) attributes.position().set(v, c, position[v][std::size_t(c)]);
  }
  std::vector<Seam> seams;
  std::vector<Vec3> position;
};

std::vector<double> rest_shapes(const Attributes& attributes, const CellComplex& complex) {
  std::vector<double> all;
  for (Index e = 0; e < complex.element_count(); ++e)
    for (const Vec3& x : attributes.rest_places(complex).of(e))
      all.insert(all.end(), x.begin(), x.end());
  return all;
}

TEST(Merging, SewingKeepsMomentumCentreOfMassAndTheRestShapeOfEveryElement) {
  const fake::Model model(fake::everything());
  for (const double gap : {0.0, 1e-12, 0.5}) {
    Random random;
    Halves body(3, &random, {gap, -gap / 2, gap / 3});
    Attributes attributes(body.complex, body.rest);
    Instance& instance = add(attributes, body.complex, model.table);
    initialise(attributes, body.complex);
    body.place(attributes);
    for (Index v = 0; v < attributes.vertex_count(); ++v)
      for (int c = 0; c < 3; ++c) {
        attributes.velocity().set(v, c, random.number());
        attributes.position().set(v, c, attributes.position().get(v, c) + 0.01 * random.number());
      }
    const auto sums = [&] {
      std::vector<double> result{total(*instance.column(fake::face))};
      for (int c = 0; c < 3; ++c) {
        double momentum = 0, centre = 0, rest = 0, stiffness = 0;
        for (Index v = 0; v < attributes.vertex_count(); ++v) {
          momentum += attributes.mass().get(v, 0) * attributes.velocity().get(v, c);
          centre += attributes.mass().get(v, 0) * attributes.position().get(v, c);
          rest += attributes.mass().get(v, 0) * attributes.rest().get(v, c);
        }
        const Table& edges = instance.table(1);
        for (Index row = 0; row < edges.cells.size(); ++row)
          if (edges.cells.is_live(row)) stiffness += instance.column(fake::edge)->get(row, c % 2);
        result.insert(result.end(), {momentum, centre, rest, stiffness});
      }
      result[0] = total(attributes.mass());
      return result;
    };
    const auto before = sums(), shapes = rest_shapes(attributes, body.complex);
    const TopologyChange change = body.complex.sew(body.seams);
    ASSERT_EQ(change.merges[0].size(), 16u);
    attributes.apply(body.complex, change);
    const auto after = sums();
    for (std::size_t i = 0; i < before.size(); ++i)
      EXPECT_NEAR(after[i], before[i], 1e-13 * before[0] + (gap == 1e-12 ? 1e-9 : 0)) << i;
    const bool own = gap == 0.5;
    EXPECT_EQ(attributes.rest_places(body.complex).own().empty(), !own);
    if (gap != 1e-12) {
      EXPECT_EQ(rest_shapes(attributes, body.complex), shapes) << "the same bits";
    }
    if (own) {
      EXPECT_EQ(attributes.rest_places(body.complex).own().count(), 18u) << "both sides";
    }
    for (const Merge& m : change.merges[0])
      for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(attributes.velocity().get(m.gone, c), 0);
        EXPECT_EQ(attributes.mass().get(m.gone, 0), 0);
      }
  }
}

/// What is sewn all at once, or seam by seam: the rest shapes are those of before.
TEST(Merging, RestShapesStayHoweverManySeamsMeet) {
  for (int round = 0; round < 10; ++round) {
    Random random;
    FakeBody body({3, 3, 3}, &random, 0.1);
    const auto faces = random_faces(body.complex, random, 1);
    auto seams = seams_of(body.complex, faces);
    const TopologyChange cut = body.complex.cut(faces);
    body.rest.resize(body.complex.count(0));
    for (const Split& s : cut.splits[0]) body.rest[s.new_cell] = body.rest[s.old_cell];
    for (Vec3& x : body.rest)
      for (double& c : x) c += 0.1 * random.number();  // 27 loose elements, all displaced
    Attributes attributes(body.complex, body.rest);
    initialise(attributes, body.complex);
    const auto shapes = rest_shapes(attributes, body.complex);
    std::shuffle(seams.begin(), seams.end(), random);
    for (std::size_t step = round == 0 ? seams.size() : 1 + random() % 9; !seams.empty();) {
      const auto now = std::span(seams).first(std::min(step, seams.size()));
      attributes.apply(body.complex, body.complex.sew(now));
      seams.erase(seams.begin(), seams.begin() + static_cast<int>(now.size()));
      ASSERT_EQ(rest_shapes(attributes, body.complex), shapes);
    }
    EXPECT_EQ(body.complex.existing(0), 64u);
    // What goes away gives its place to what comes.
    const Index own = attributes.rest_places(body.complex).own().count();
    attributes.apply(body.complex, body.complex.pierce(std::vector<Index>{3, 13}));
    EXPECT_EQ(attributes.rest_places(body.complex).own().count(), own - 2);
  }
}

TEST(Merging, FixedVerticesKeepTheirPlace) {
  const fake::Model model({fake::attribute("mass", 0, 1, &fake::contribute<8, 1>,
                                           SUTURE_FROM_VOLUMES, SUTURE_SHARED_MASS)});
  // Bits of the vertex that is kept and of the one that goes.
  for (const auto& [kept_bits, gone_bits] : {std::pair{0, 7}, {7, 0}, {7, 7}, {1, 2}, {0, 4}}) {
    Halves body(1, nullptr, {0.25, 0, 0});
    Attributes attributes(body.complex, body.rest);
    add(attributes, body.complex, model.table);
    initialise(attributes, body.complex);
    Random random;
    for (Index v = 0; v < attributes.vertex_count(); ++v)
      for (int c = 0; c < 3; ++c) attributes.position().set(v, c, random.number());
    const TopologyChange change = body.complex.sew(body.seams);
    const auto [kept, gone] = change.merges[0][1];
    attributes.fixed().set(kept, 0, kept_bits);
    attributes.fixed().set(gone, 0, gone_bits);
    std::array<double, 3> x[2], rest[2];
    for (std::size_t c = 0; c < 3; ++c)
      for (const int i : {0, 1}) {
        x[i][c] = attributes.position().get(i == 0 ? kept : gone, int(c));
        rest[i][c] = attributes.rest().get(i == 0 ? kept : gone, int(c));
      }
    const double m[2] = {attributes.mass().get(kept, 0), attributes.mass().get(gone, 0)};
    attributes.apply(body.complex, change);
    EXPECT_EQ(attributes.fixed().get(kept, 0), kept_bits | gone_bits);
    EXPECT_EQ(attributes.fixed().get(gone, 0), 0);
    for (int c = 0; c < 3; ++c) {
      const auto i = static_cast<std::size_t>(c);
      const bool k = kept_bits >> c & 1, g = gone_bits >> c & 1;
      const double mean = (m[0] * x[0][i] + m[1] * x[1][i]) / (m[0] + m[1]);
      const double here = attributes.position().get(kept, c);
      if (k || g)
        EXPECT_EQ(here, k ? x[0][i] : x[1][i]);
      else
        EXPECT_NEAR(here, mean, 1e-15);
      EXPECT_EQ(attributes.rest().get(kept, c), kept_bits != 0 ? rest[0][i] : rest[1][i]);
    }
  }
}

TEST(Merging, RemovalTakesExactlyTheMassOfTheElement) {
  const fake::Model model(
      {fake::attribute("mass", 0, 1, &fake::box_mass, SUTURE_FROM_VOLUMES, SUTURE_SHARED_MASS)});
  FakeBody body({3, 3, 3});
  Attributes attributes(body.complex, body.rest);
  add(attributes, body.complex, model.table, {}, 8);
  initialise(attributes, body.complex);
  attributes.apply(body.complex, body.complex.pierce(std::vector<Index>{0, 13}));  // corner, middle
  EXPECT_EQ(total(attributes.mass()), 8 * 25);
  EXPECT_EQ(attributes.mass().get(0, 0), 0) << "the corner is gone";
  for (Index v = 0; v < attributes.vertex_count(); ++v) {
    std::vector<Dart> star;
    if (body.complex.exists(0, v)) body.complex.star(0, v, star);
    EXPECT_EQ(attributes.mass().get(v, 0), static_cast<double>(star.size()));
  }
}

}  // namespace
}  // namespace suture
