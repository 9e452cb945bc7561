// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/contact/robust/robust_scenes.hpp"

#include <map>
#include <numbers>

#include "kernel/base/vec3.hpp"
#include "kernel/run/simulation.hpp"

namespace suture::test {
namespace {

constexpr double h = robust_edge;
constexpr double young = 2e5, poisson = 0.3, density = 1000;
// sqrt(E (1 - nu) / ((1 + nu) (1 - 2 nu) rho))
const double wave_speed =
    std::sqrt(young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson) * density));

/// Numbers and vectors with components from -1 to 1.
class Jitter {
 public:
  explicit Jitter(std::mt19937& random) : random_(random) {}
  double operator()() { return random_() / 2147483648.0 - 1; }
  Vec3 vector() { return {(*this)(), (*this)(), (*this)()}; }

 private:
  std::mt19937& random_;
};

/// Where the middle of a block goes, turned about a vector by its length.
struct Placed {
  Vec3 centre, turn{};

  Vec3 operator()(const Vec3& p) const {
    const double angle = norm(turn);
    if (angle == 0) return plus(centre, p);
    const Vec3 axis = scaled(1 / angle, turn);
    const Vec3 turned =
        plus(plus(scaled(std::cos(angle), p), scaled(std::sin(angle), cross(axis, p))),
             scaled((1 - std::cos(angle)) * dot(axis, p), axis));
    return plus(centre, turned);
  }
};

using Rows = std::vector<std::string>;  ///< along y, of elements along x: '#', or '.' for none

Rows filled(std::size_t nx, std::size_t ny) { return Rows(ny, std::string(nx, '#')); }

class SceneMaker {
 public:
  SceneMaker(PluginHost& host, double end) {
    scene_.title = "robust contact";
    ModelUse use;
    use.name = "neo-hookean";
    use.model = &host.model(use.name);
    const std::map<std::string, double> values{{"E", young}, {"nu", poisson}, {"rho", density}};
    for (std::uint32_t p = 0; p < use.model->parameter_count; ++p) {
      const suture_parameter& parameter = use.model->parameters[p];
      const auto found = values.find(parameter.name);
      use.parameters.push_back(found != values.end() ? found->second : parameter.default_value);
    }
    scene_.models.push_back(use);
    scene_.gravity = {0, 0, -9.81};
    scene_.solver.end = end;
    scene_.solver.damping = 1;
    scene_.solver.threads = 1;
    scene_.contact.pieces = scene_.contact.self = true;
    scene_.contact.friction = 0.3;
    scene_.output.enabled = false;
  }

  SceneMaker& add(const Rows& rows, Index layers, const Placed& placed) {
    std::map<std::array<Index, 3>, Index> nodes;
    const auto nx = static_cast<double>(rows.front().size()), ny = static_cast<double>(rows.size());
    const auto node = [&](Index i, Index j, Index k) {
      const auto [at, is_new] =
          nodes.try_emplace({i, j, k}, static_cast<Index>(mesh_.points.size()));
      if (is_new)
        mesh_.points.push_back(
            placed({h * (i - nx / 2), h * (j - ny / 2), h * (k - layers / 2.0)}));
      return at->second;
    };
    for (Index k = 0; k < layers; ++k)
      for (Index j = 0; j < rows.size(); ++j)
        for (Index i = 0; i < rows[j].size(); ++i) {
          if (rows[j][i] != '#') continue;
          Hexahedron& hexahedron = mesh_.hexahedra.emplace_back();
          for (Index n = 0; n < 8; ++n)
            hexahedron[n] = node(i + (n & 1), j + (n >> 1 & 1), k + (n >> 2));
        }
    return *this;
  }
  SceneMaker& plane(const Vec3& point, const Vec3& normal,
                    std::vector<RigidPath::Station> path = {}, double friction = 0.3) {
    return obstacle(HalfSpace{point, scaled(1 / norm(normal), normal)}, std::move(path), friction);
  }
  SceneMaker& floor(double height = 0) { return plane({0, 0, height}, {0, 0, 1}); }
  SceneMaker& sphere(const Vec3& centre, double radius, std::vector<RigidPath::Station> path = {}) {
    return obstacle(Sphere{centre, radius}, std::move(path), 0.2);
  }
  SceneMaker& fix(const Vec3& low, const Vec3& high) {
    Constraint& fixed = scene_.constraints.emplace_back();
    fixed.where.what = Selection::InBox{low, high};
    fixed.where.path = "/constraints/" + std::to_string(scene_.constraints.size() - 1);
    return *this;
  }
  SceneMaker& move(const Vec3& low, const Vec3& high, const Vec3& by, double from, double to) {
    fix(low, high);
    scene_.constraints.back().translation = by;
    scene_.constraints.back().ramp = {from, to, true};
    scene_.constraints.back().moves = true;
    return *this;
  }
  SceneMaker& event(double at, EventOperation what) {
    Event& event = scene_.events.emplace_back();
    event.at = at;
    event.what = std::move(what);
    event.path = "/events/" + std::to_string(scene_.events.size() - 1);
    return *this;
  }
  Scene& scene() { return scene_; }
  RobustScene made() {
    mesh_.source = "robust contact";
    scene_.mesh.given = std::make_shared<Mesh>(mesh_);
    return {scene_};
  }

 private:
  SceneMaker& obstacle(Shape shape, std::vector<RigidPath::Station> path, double friction) {
    const std::string number = std::to_string(scene_.contact.obstacles.size());
    Obstacle& made = scene_.contact.obstacles.emplace_back(
        Obstacle{"obstacle-" + number, "/contact/obstacles/" + number, std::move(shape)});
    made.motion.stations = std::move(path);
    made.friction = friction;
    return *this;
  }

  Mesh mesh_;
  Scene scene_;
};

// -------------------------------------------------------------------- loose pieces --

RobustScene pile_of_letters(PluginHost& host, std::mt19937& random) {
  Jitter jitter(random);
  SceneMaker maker(host, 2);
  const Rows letters[] = {{"###", ".#.", ".#."},
                          {"#..", "#..", "###"},
                          {"###", "#..", "###"},
                          {"#.#", "###", "#.#"},
                          {"##.", ".##"}};
  maker.scene().gravity = {0, 0, -3};  // the last one arrives at 0.2 of the wave speed
  double height = 0.35;
  for (const Rows& letter : letters) {
    const Vec3 turn = scaled(1.5, jitter.vector());
    maker.add(letter, 2, {{0.05 * jitter(), 0.05 * jitter(), height}, turn});
    height += 0.48;
  }
  maker.floor().plane({-0.45, 0, 0}, {1, 0, 0.2}).plane({0.45, 0, 0}, {-1, 0, 0.2});
  return maker.plane({0, -0.45, 0}, {0, 1, 0.2}).plane({0, 0.45, 0}, {0, -1, 0.2}).made();
}

RobustScene stack(PluginHost& host, std::mt19937& random) {
  Jitter jitter(random);
  SceneMaker maker(host, 1.5);
  for (int i = 0; i < 4; ++i)
    maker.add(filled(3, 3), 2,
              {{0.04 * jitter(), 0.04 * jitter(), 0.11 + 0.215 * i}, {0, 0, 0.3 * jitter()}});
  return maker.floor().made();
}

RobustScene slope(PluginHost& host, std::mt19937& random) {
  Jitter jitter(random);
  SceneMaker maker(host, 1);
  const double angle = 0.35 + 0.1 * jitter();
  maker.scene().gravity = {9.81 * std::sin(angle), 0, -9.81 * std::cos(angle)};
  maker.add(filled(4, 4), 2, {{0, 0, 0.11}, {0, 0, 0.2 * jitter()}})
      .add(filled(2, 2), 2, {{0.05 * jitter(), 0, 0.33}, {0, 0, jitter()}});
  return maker.floor().plane({0.8, 0, 0}, {-1, 0, 0.3}).made();
}

/// Two cubes, turned at random, that meet at a fifth of the wave speed.
RobustScene impact(PluginHost& host, std::mt19937& random) {
  Jitter jitter(random);
  SceneMaker maker(host, 0.3);
  maker.scene().gravity = {};
  maker.scene().solver.damping = 0;
  maker.add(filled(3, 3), 3, {{-0.3, 0, 0}, scaled(1.5, jitter.vector())})
      .add(filled(3, 3), 3, {{0.3, 0.1 * jitter(), 0.1 * jitter()}, scaled(1.5, jitter.vector())});
  RobustScene made = maker.made();
  made.start = [](Simulation& simulation) {
    const double middle = -simulation.origin()[0];
    simulation.change_motion([middle](Attributes& a) {
      for (Index v = 0; v < a.vertex_count(); ++v)
        a.velocity().set(v, 0, (a.position().get(v, 0) < middle ? 0.1 : -0.1) * wave_speed);
    });
  };
  return made;
}

/// The edges of two bars, each turned about its own axis, meet first.
RobustScene crossed_bars(PluginHost& host, std::mt19937& random) {
  Jitter jitter(random);
  const double quarter = std::numbers::pi / 4 + 0.1 * jitter();
  SceneMaker maker(host, 1);
  maker.add(filled(8, 2), 2, {{0, 0, 0}, {quarter, 0, 0}})
      .add(filled(2, 8), 2,
           {{0.1 * jitter(), 0.1 * jitter(), 0.32 + 0.02 * jitter()}, {0, quarter, 0}})
      .fix({-0.41, -1, -0.5}, {-0.39, 1, 0.2})
      .fix({0.39, -1, -0.5}, {0.41, 1, 0.2});
  return maker.floor(-0.5).made();
}

RobustScene wedge_between_blocks(PluginHost& host, std::mt19937& random) {
  Jitter jitter(random);
  SceneMaker maker(host, 1.2);
  for (const double side : {-1., 1.})
    maker.add(filled(3, 3), 3,
              {{side * 0.24 + 0.01 * jitter(), 0.02 * jitter(), 0.151}, {0, 0, 0.1 * jitter()}});
  maker.add(filled(3, 3), 3, {{0.03 * jitter(), 0, 0.6}, {0, 0.7 + 0.1 * jitter(), 0}});
  return maker.floor().plane({-0.8, 0, 0}, {1, 0, 0}).plane({0.8, 0, 0}, {-1, 0, 0}).made();
}

RobustScene squeezed_stack(PluginHost& host, std::mt19937& random) {
  Jitter jitter(random);
  SceneMaker maker(host, 1);
  for (int i = 0; i < 3; ++i)
    maker.add(filled(3, 3), 2,
              {{0.05 * jitter(), 0.05 * jitter(), 0.101 + 0.201 * i}, {0, 0, 0.5 * jitter()}});
  return maker.floor()
      .plane({0, 0, 0.65}, {0, 0, -1}, {{0.1, {}, 0}, {0.8, {0.02 * jitter(), 0, -0.14}, 0}})
      .made();
}

RobustScene piece_into_a_hole(PluginHost& host, std::mt19937& random) {
  Jitter jitter(random);
  SceneMaker maker(host, 1.2);
  maker
      .add({"#######", "#######", "##...##", "##...##", "##...##", "#######", "#######"}, 3,
           {{0, 0, 0.151}, {}})
      .add(filled(2, 2), 3,
           {{0.03 * jitter(), 0.03 * jitter(), 0.55}, scaled(0.3, jitter.vector())});
  return maker.floor().made();
}

// ---------------------------------------------------------------------------- lips --

RobustScene lips_under_load(PluginHost& host, std::mt19937& random) {
  Jitter jitter(random);
  SceneMaker maker(host, 0.8);
  maker.scene().gravity = {};
  maker.scene().contact.friction = 0.1;
  maker.add(filled(5, 5), 5, {{0, 0, 0}, {}})
      .fix({-1, -1, -0.26}, {1, 1, -0.24})
      .move({-1, -1, 0.24}, {1, 1, 0.26}, {0.02 * jitter(), 0.02 * jitter(), -0.02}, 0.1, 0.6);
  return maker
      .event(0.02, CutPlane{{0.01, 0, 0.02 * jitter()}, {0.6 * jitter(), 0.6 * jitter(), 1}})
      .made();
}

/// A load opens a cut that ends inside; then a plate pushes it shut.
RobustScene closing_a_wound(PluginHost& host, std::mt19937& random) {
  Jitter jitter(random);
  SceneMaker maker(host, 1);
  maker.scene().gravity = {};
  maker.add(filled(8, 3), 4, {{0, 0, 0}, {}}).fix({-0.41, -1, -1}, {-0.39, 1, 1});
  Load pull;
  pull.kind = Load::Kind::force;
  pull.value = {500 + 50 * jitter(), 0, 30 * jitter()};
  pull.where.what = Selection::InBox{{0.39, -1, -1}, {0.41, 1, 1}};
  pull.where.path = "/loads/0";
  pull.ramp = {0, 0.3, true};
  maker.scene().loads.push_back(pull);
  const double x = 0.01 + 0.1 * jitter();
  const CutPlane cut{
      {x, 0, 0}, {1, 0.2 * jitter(), 0.2 * jitter()}, std::numeric_limits<double>::infinity(), {}};
  CutPlane partial = cut;
  partial.polygon = {{x, -1, 0.01}, {x, 1, 0.01}, {x, 1, 1}, {x, -1, 1}};
  partial.normal = {1, 0, 0};
  return maker.event(0.02, partial)
      .plane({0.8, 0, 0}, {-1, 0, 0.1 * jitter()}, {{0.4, {}, 0}, {0.9, {-0.45, 0, 0}, 0}})
      .made();
}

RobustScene sphere_through_a_slit(PluginHost& host, std::mt19937& random) {
  Jitter jitter(random);
  SceneMaker maker(host, 0.9);
  maker.scene().gravity = {};
  maker.add(filled(10, 8), 2, {{0, 0, 0}, {}});
  for (const double side : {-1., 1.})
    maker.fix({side * 0.5 - 0.01, -1, -1}, {side * 0.5 + 0.01, 1, 1})
        .fix({-1, side * 0.4 - 0.01, -1}, {1, side * 0.4 + 0.01, 1});
  CutPlane slit{{0, 0, 0}, {0, 1, 0}};
  slit.polygon = {{-0.31, 0, -1}, {0.31, 0, -1}, {0.31, 0, 1}, {-0.31, 0, 1}};
  return maker.event(0.02, slit)
      .sphere({0.05 * jitter(), 0.03 * jitter(), 0.2}, 0.07,
              {{0.05, {}, 0}, {0.85, {0, 0, -0.4}, 0}})
      .made();
}

RobustScene cut_in_contact(PluginHost& host, std::mt19937& random) {
  Jitter jitter(random);
  SceneMaker maker(host, 1);
  maker.add(filled(6, 6), 3, {{0, 0, 0.151}, {}});
  return maker.floor()
      .sphere({0.05 * jitter(), 0.05 * jitter(), 0.52}, 0.2, {{0, {}, 0}, {0.4, {0, 0, -0.08}, 0}})
      .event(0.5, CutPlane{{0.01, 0, 0}, {1, jitter(), 0.3 * jitter()}})
      .made();
}

// --------------------------------------------------------------------- tools and sheets --

RobustScene sheet_between_two_tools(PluginHost& host, std::mt19937& random) {
  Jitter jitter(random);
  SceneMaker maker(host, 1);
  maker.scene().gravity = {};
  maker.add(filled(9, 9), 1, {{0, 0, 0}, {}}).fix({-0.46, -1, -1}, {-0.44, 1, 1});
  const double x = 0.05 + 0.05 * jitter(), y = 0.05 * jitter();
  return maker
      .sphere({x, y, 0.3}, 0.2, {{0, {}, 0}, {0.4, {0, 0, -0.06}, 0}, {0.9, {0.1, 0.1, -0.06}, 0}})
      .sphere({x + 0.04 * jitter(), y + 0.04 * jitter(), -0.3}, 0.2,
              {{0, {}, 0}, {0.4, {0, 0, 0.06}, 0}, {0.9, {0.1, 0.1, 0.06}, 0}})
      .made();
}

/// A U whose upper arm is pressed onto the lower one.
RobustScene fold_onto_itself(PluginHost& host, std::mt19937& random) {
  Jitter jitter(random);
  SceneMaker maker(host, 1);
  maker.scene().gravity = {0, -9.81, 0};
  maker.add({"########", "########", "##......", "########", "########"}, 2, {{0, 0.251, 0}, {}});
  return maker.plane({0, 0, 0}, {0, 1, 0})
      .plane({0, 0.54, 0}, {0.05 * jitter(), -1, 0.05 * jitter()},
             {{0.1, {}, 0}, {0.7, {0, -0.17, 0}, 0}})
      .made();
}

RobustScene tear_in_contact(PluginHost& host, std::mt19937& random) {
  Jitter jitter(random);
  SceneMaker maker(host, 0.8);
  maker.add(filled(7, 4), 1, {{0, 0, 0}, {}})
      .fix({-0.36, -1, -1}, {-0.34, 1, 1})
      .move({0.34, -1, -1}, {0.36, 1, 1}, {0.1, 0, 0}, 0, 0.5)
      .sphere({0.1 * jitter(), 0.05 * jitter(), 0.26}, 0.2, {{0.1, {}, 0}, {0.7, {0, 0, -0.15}, 0}})
      .floor(-0.3);
  Tear tear;
  tear.above = 0.25;
  tear.max_fraction = 1;
  maker.event(0, tear);
  maker.scene().events.back().every = 10;
  return maker.made();
}

RobustScene removal_under_a_tool(PluginHost& host, std::mt19937& random) {
  Jitter jitter(random);
  SceneMaker maker(host, 0.8);
  const double x = 0.05 * jitter(), y = 0.05 * jitter();
  maker.add(filled(6, 6), 3, {{0, 0, 0.151}, {}})
      .floor()
      .sphere({x, y, 0.51}, 0.2, {{0, {}, 0}, {0.6, {0.05, 0, -0.1}, 0}});
  Pierce under;
  under.where = Selection{Selection::Sphere{{x, y, 0.25}, 0.13}, "/events/0"};
  return maker.event(0.35, under).made();
}

}  // namespace

const std::vector<RobustCase>& robust_cases() {
  static const std::vector<RobustCase> cases{
      {"pile of letters", pile_of_letters, true},
      {"stack", stack, true},
      {"slope", slope},
      {"impact at 0.2 of the wave speed", impact},
      {"crossed bars", crossed_bars},
      {"wedge between blocks", wedge_between_blocks, true},
      {"squeezed stack", squeezed_stack},
      {"piece into a hole", piece_into_a_hole, true},
      {"lips under load", lips_under_load},
      {"closing a wound", closing_a_wound},
      {"sphere through a slit", sphere_through_a_slit},
      {"cut in contact", cut_in_contact},
      {"sheet between two tools", sheet_between_two_tools},
      {"fold onto itself", fold_onto_itself},
      {"tear in contact", tear_in_contact},
      {"removal under a tool", removal_under_a_tool},
  };
  return cases;
}

}  // namespace suture::test
