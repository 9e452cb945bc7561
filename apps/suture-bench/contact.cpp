// SPDX-License-Identifier: GPL-3.0-or-later
//
// Contact: finding near pairs, and whole steps with and without.

#include "kernel/contact/contact.hpp"

#include <algorithm>
#include <cmath>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/contact_letters.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/contact/near_pairs.hpp"
#include "kernel/topology/dart.hpp"

namespace suture::bench {
namespace {

struct ContactOptions {
  std::vector<Index> across{15, 45, 60};
  int rounds = 5, settling = 300;
};

/// The blocks of `edge` elements along each axis that the elements of a grid belong to.
std::vector<Index> blocks_of(const std::array<Index, 3>& cells, Index edge) {
  std::vector<Index> blocks;
  for (Index z = 0; z < cells[2]; ++z)
    for (Index y = 0; y < cells[1]; ++y)
      for (Index x = 0; x < cells[0]; ++x)
        blocks.push_back(x / edge + 1000 * (y / edge) + 1000000 * (z / edge));
  return blocks;
}

void separate(BenchBody& body, const std::vector<Index>& blocks) {
  std::vector<Dart> faces;
  const CellComplex& complex = body.complex();
  for (Index e = 0; e < complex.element_count(); ++e)
    for (const Dart d : sides_of(e))
      if (complex.can_cut(d) && blocks[e] < blocks[element_of(complex.beta3(d))])
        faces.push_back(d);
  body.cut(faces);
}

/// Blocks of 5 x 5 x 5 elements, packed face to face.
void find_pairs(Index n, const ContactOptions& options, PluginHost& host, Report& report) {
  const std::array<Index, 3> cells{n, n, n};
  BenchBody body(host, {.model = "mss-baudet", .cells = cells, .cell = 1});
  const std::vector<Index> blocks = blocks_of(cells, 5);
  separate(body, blocks);
  const BoundarySurface surface(body.complex());
  Meeting meeting;
  meeting.piece_of.resize(body.attributes().vertex_count());
  for (const Index v : surface.vertices())
    meeting.piece_of[v] = blocks[element_of(body.complex().dart_of(0, v))];
  const double* positions = body.attributes().position().rows();
  std::size_t pairs = 0;
  double best = 1e9;
  for (int round = 0; round < options.rounds; ++round)
    best = std::min(
        best, measure([&] { pairs = near_pairs(surface, meeting, positions, 0.55).size(); }, 1, 0.1)
                  .best);
  const auto faces = static_cast<double>(surface.faces().size());
  report.add(Line()
                 .add("faces", faces)
                 .add("pairs per face", static_cast<double>(pairs) / faces)
                 .add("ms", 1e3 * best)
                 .add("ns per face", 1e9 * best / faces));
}

Obstacle plate() { return {"plate", "", HalfSpace{{0, 0, 0}, {0, 1, 0}}, {}, 0.3}; }

/// A block that lies on a plate, and a sphere that moves along it.
void add_plate_and_sphere(BenchBody& body, const BodyOptions& options) {
  const double width = options.cell * options.cells[0], length = options.cell * options.cells[2];
  const double radius = width / 2;
  Obstacle sphere{
      "sphere", "", Sphere{{width / 2, width + 0.95 * radius, length / 2}, radius}, {}, 0.3};
  sphere.motion.stations = {{0, {}, 0}, {1, {0, 0, length / 4}, 0}};
  body.body().add_contact({plate(), sphere}, 0);
}

void add_plate_and_pieces(BenchBody& body, const BodyOptions&) {
  body.body().add_contact({plate()}, 0).touch_pieces({0.3});
}

/// Turns each layer of blocks against the one below, with a gap around every block.
void loosen(BenchBody& body, const BodyOptions& options, Index block) {
  Column& positions = body.attributes().position();
  const double gap = 0.5 * options.cell;
  const double middle = options.cell * options.cells[0] / 2;
  for (Index v = 0; v < body.attributes().vertex_count(); ++v) {
    const Index element = element_of(body.complex().dart_of(0, v));
    const Index x = element % options.cells[0], y = element / options.cells[0] % options.cells[1];
    const Index z = element / options.cells[0] / options.cells[1];
    const double layer = y / block, angle = 0.3 * layer;
    const double dx = positions.get(v, 0) - middle + gap * (x < block ? -1 : 1);
    const double dz = positions.get(v, 2) - middle + gap * (z < block ? -1 : 1);
    positions.set(v, 0, middle + std::cos(angle) * dx - std::sin(angle) * dz);
    positions.set(v, 1, positions.get(v, 1) + 0.1 * gap * (layer + 1));
    positions.set(v, 2, middle + std::sin(angle) * dx + std::cos(angle) * dz);
  }
}

struct ContactCase {
  const char* name;
  BodyOptions options;
  Index block;    ///< elements along the edge of a piece; 0: one piece
  bool is_loose;  ///< pieces are not packed
  void (*add)(BenchBody&, const BodyOptions&);
};

/// The same body with and without contact, in turn.
void compare_steps(const ContactCase& of, const ContactOptions& options, PluginHost& host,
                   Report& report) {
  BenchBody with(host, of.options), without(host, of.options);
  of.add(with, of.options);
  for (BenchBody* body : {&with, &without}) {
    if (of.block > 0) separate(*body, blocks_of(of.options.cells, of.block));
    if (of.is_loose) loosen(*body, of.options, of.block);
    body->dynamics().start();
    for (int step = 0; step < options.settling; ++step) body->step();
  }
  double seconds[2] = {1e9, 1e9};
  for (int round = 0; round < options.rounds; ++round) {
    seconds[0] = std::min(seconds[0], measure([&] { without.step(); }, 1, 0.2).median);
    seconds[1] = std::min(seconds[1], measure([&] { with.step(); }, 1, 0.2).median);
  }
  report.add(Line()
                 .add("scene", std::string(of.name))
                 .add("elements", static_cast<double>(with.element_count()))
                 .add("touching", static_cast<double>(with.body().contact()->touches().size()))
                 .add("us without", 1e6 * seconds[0])
                 .add("us with", 1e6 * seconds[1])
                 .add("ratio", seconds[1] / seconds[0]));
}

void run_contact(const ContactOptions& options, Report& report) {
  PluginHost host;
  report.begin("contact pairs",
               "near pairs of blocks of 5 x 5 x 5 elements packed face to face, reach 0.55 of an "
               "edge, one thread");
  for (const Index n : options.across) find_pairs(n, options, host, report);
  report.begin(
      "contact steps",
      "a step of tm-faure with contact beside one of the same body without, in turn, one thread");
  const BodyOptions block{.model = "tm-faure", .cells = grid_of(20000)};
  const BodyOptions blocks{.model = "tm-faure", .cells = {20, 50, 20}, .held = -1};
  const ContactCase cases[] = {
      {"block on a plate under a sphere that moves", block, 0, false, add_plate_and_sphere},
      {"20 blocks in a pile on a plate, layers turned", blocks, 10, true, add_plate_and_pieces},
      {"20 blocks packed face to face on a plate", blocks, 10, false, add_plate_and_pieces}};
  for (const ContactCase& of : cases) compare_steps(of, options, host, report);
  report.begin(
      "contact of letters",
      "20 letters of 1,000 elements fall into a box and lie in a pile: a step with contact "
      "beside one of the same letters without, in turn, one thread");
  measure_letters(host, report);
}

}  // namespace

void add_contact(CommandLine& line) {
  auto [command, options] = line.add("contact", "Near pairs, and steps with contact", run_contact);
  command.option("--across", &options.across, "Elements along each axis, for near pairs");
  command.option("--rounds", &options.rounds, "Rounds, of which the best counts");
  command.option("--settling", &options.settling, "Steps before those that are measured");
}

}  // namespace suture::bench
