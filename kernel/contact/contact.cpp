// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/contact.hpp"

#include <algorithm>
#include <limits>

#include "kernel/contact/contact_books.hpp"
#include "kernel/contact/point_pushes.hpp"
#include "kernel/contact/row_lanes.hpp"
#include "kernel/contact/vertex_pushes.hpp"
#include "kernel/solvers/clones.hpp"

namespace suture {
namespace {

// Over all samples of cutting edges.
constexpr int max_edge_sweeps = 64;
// How far other pieces may push a vertex in a step, or vertices a tool; of an element.
constexpr double pushed = 0.5;
// How far outside an obstacle the side of a vertex that touches it is marked, in elements.
constexpr double marked_outside = 1e-6;
// Of points whose box is tested first, before each of them; in elements.
constexpr double cell_of_clusters = 3;
// How much faster points may approach that are in no pair: they are 0.1 of an edge away from all
// triangles (PointPairs), and those of pairs approach by 0.05 in a step.
constexpr double far_over_near = 2;

/// Around rows of 4.
SUTURE_CLONES
Box box_around(const double* rows, std::span<const Index> vertices) {
  RowLanes low = lanes_of(no_box.low), high = lanes_of(no_box.high);
  for (const Index v : vertices) {
    const RowLanes& here = row_at(rows, v);
    low = here < low ? here : low;
    high = here > high ? here : high;
  }
  return {vec_of(low), vec_of(high)};
}

/// A bound on the length of the first three numbers in rows of 4.
double fastest(const double* rows, std::span<const Index> vertices) {
  const Box box = box_around(rows, vertices);
  Vec3 largest;
  for (std::size_t c = 0; c < 3; ++c) largest[c] = std::max(-box.low[c], box.high[c]);
  return norm(largest);
}

}  // namespace

Contact::Contact(const CellComplex& complex, Attributes& attributes,
                 std::vector<Obstacle> obstacles, double thickness, SurfacePoints::Source embedding)
    : ContactLaw(std::move(obstacles)),
      complex_(complex),
      attributes_(attributes),
      thickness_(thickness),
      points_(complex, attributes, std::move(embedding)) {
  shortest_edge_ = std::numeric_limits<double>::infinity();
  const double* rest = attributes.rest().rows();
  for (const BoundarySurface::Corners& corners : surface().corners())
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec3 a = row(rest, corners[i]), b = row(rest, corners[(i + 1) % 4]);
      const double edge = norm(minus(a, b));
      shortest_edge_ = std::min(shortest_edge_, edge);
      longest_edge_ = std::max(longest_edge_, edge);
      mean_edge_ += edge / (4 * static_cast<double>(surface().corners().size()));
      include(box_, a);
    }
  size_ = norm(minus(box_.high, box_.low));
  for (const Obstacle& obstacle : obstacles_) {
    std::optional<Tool>& tool = tools_.emplace_back();
    if (obstacle.coupling) tool.emplace(obstacle);
    has_tools_ = has_tools_ || tool;
    has_solids_ = has_solids_ || !std::holds_alternative<HalfSpace>(obstacle.shape);
  }
  if (points_.are_embedded())
    point_pushes_ = std::make_unique<PointPushes>(points_.embedded(), attributes, obstacles_, step_,
                                                  shortest_edge_);
  else
    vertex_pushes_ = std::make_unique<VertexPushes>(attributes, step_, shortest_edge_);
}

Contact::~Contact() = default;

// --------------------------------------------------------------------- a step --

void Contact::touch_pieces(const PieceContact::Options& options) {
  if (points_.are_embedded()) {
    pairs_.emplace(complex_, attributes_, points_.embedded(), options, mean_edge_);
    point_pushes_->touch(*pairs_);
  } else {
    pieces_ = std::make_unique<PieceContact>(complex_, surface(), attributes_, options, mean_edge_);
    vertex_pushes_->touch(*pieces_);
  }
}

const PointPairs* Contact::find_point_pairs() {
  if (!pairs_) return nullptr;
  pairs_->set_depth(PieceContact::max_depth);
  points_.gather();
  pairs_->find(0);
  return &*pairs_;
}

const double* Contact::places_now() {
  points_.gather();
  return points_.positions();
}

void Contact::prepare(const ContactStep& step) {
  step_.placed.clear();
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    if (tools_[i]) {
      tools_[i]->begin(obstacles_[i].motion, step.time, step.end, step.dt, step.whole_gain);
      step_.placed.emplace_back(obstacles_[i], thickness_, tools_[i]->pose(), tools_[i]->end());
    } else {
      step_.placed.emplace_back(obstacles_[i], thickness_, step.time, step.end);
    }
  }
  ease_recovery(step.dt);
  step_.forces.resize(4 * std::size_t{attributes_.vertex_count()});
  const double* force = attributes_.force().rows();
  const auto keep = [&](Index v) { row_at(step_.forces.data(), v) = row_at(force, v); };
  std::ranges::for_each(points_.ascending_vertices(), keep);
  if (!edges_) return;
  edges_->begin(step_.placed, step.end - step.time, kept_.last_dt);
  std::ranges::for_each(edges_->vertices(), keep);
}

/// A step of dt takes back dt / longest_dt of what the longest one may: the work of taking a depth
/// d back is m (d / dt)^2 / 2. Pieces of whole elements keep their way per step: they have no small
/// parts that make dt short, and a sphere that is pulled through a slit sinks in otherwise.
void Contact::ease_recovery(double dt) {
  kept_.longest_dt = std::max(kept_.longest_dt, dt);
  const double part = step_.eased = dt / kept_.longest_dt;
  for (PlacedObstacle& placed : step_.placed) placed.ease_recovery(part);
  if (pairs_) pairs_->ease_recovery(part);
}

std::span<const Contact::Correction> Contact::resolve(const ContactStep& step) {
  corrections_.clear();
  const auto moves = [&](const auto& known) { return (*step.moving)[known.vertex]; };
  std::erase_if(results_.touches, moves);  // the forces on sleepers stay
  std::erase_if(kept_.obstacle_forces, moves);
  results_.step_work = 0;
  step_.moving = step.moving;
  find_near_obstacles(step);
  if (pieces_) vertex_pushes_->find_touching(step);
  if (pairs_) {
    const double way = kept_.closing_speed * step.dt;
    point_pushes_->find_pairs(way == 0 || way > pairs_->reach() ? 0 : step.dt);
  }
  if (edges_) {
    find_at_edges();
    edges_->engage(step.whole_gain);
  }
  push(step.dt);
  if (has_tools_) settle_tools(step);
  if (point_pushes_) point_pushes_->keep_forces();
  book(step);
  if (points_.are_embedded() || edges_)
    for (const Near& near : step_.near) step_.near_of_vertex[near.vertex] = none;
  kept_.last_dt = step.dt;
  kept_.closing_speed = find_closing_speed();
  return corrections_;
}

/// How fast things that may touch approach each other, at most, m/s. Nodes outside of the material
/// do not count: they are faster than all of it.
double Contact::find_closing_speed() {
  const double* velocities = attributes_.velocity().rows();
  if (pieces_ && pieces_->may_meet())
    return diagonal_of(box_around(velocities, points_.ascending_vertices()));
  if (!pairs_ || !pairs_->may_meet()) return 0;
  SurfacePoints& points = points_.embedded();
  points.gather_velocities(attributes_);
  const double near = diagonal_of(box_around(points.velocities(), pairs_->near_points()));
  return std::max(near,
                  diagonal_of(box_around(points.velocities(), points.numbers())) / far_over_near);
}

/// By boxes around vertices first.
void Contact::find_near_obstacles(const ContactStep& step) {
  step_.clear();
  if (point_pushes_) point_pushes_->begin(step);
  const double reach = pushed * mean_edge_;
  const double margin = pieces_ || pairs_ || has_tools_ ? reach : 0;  // others push it, too
  if (pairs_) points_.gather();
  points_.find_clusters(cell_of_clusters * mean_edge_);
  const double* positions = attributes_.position().rows();
  const double* velocities = attributes_.velocity().rows();
  std::vector<Index>& near_obstacles = step_.near_obstacles;
  for (std::size_t c = 0; c < points_.cluster_count(); ++c) {
    const auto [numbers, vertices] = points_.cluster(c);
    const Box box = box_around(positions, vertices);
    const Vec3 half = scaled(0.5, minus(box.high, box.low)), middle = plus(box.low, half);
    const double radius = norm(half);
    const double way = has_solids_ ? step.dt * fastest(velocities, vertices) : 0;
    near_obstacles.clear();
    for (Index i = 0; i < step_.placed.size(); ++i) {
      const PlacedObstacle& placed = step_.placed[i];
      if (obstacles_[i].pushes &&
          placed.may_touch(middle, radius + std::max(reach, margin + placed.longest_way(way))))
        near_obstacles.push_back(i);
    }
    if (near_obstacles.empty()) continue;
    if (!pairs_) points_.gather(numbers);
    for (const Index number : numbers) add_if_near(number, step, margin, reach);
  }
}

/// What obstacles of near_obstacles may touch, or others push into them.
void Contact::add_if_near(Index number, const ContactStep& step, double margin, double reach) {
  const Vec3 place = row(points_.positions(), number),
             start = minus(place, scaled(step.dt, row(points_.velocities(), number)));
  const auto may_meet = [&](Index i, double within) {
    return step_.placed[i].may_meet(start, place, within);
  };
  if (std::ranges::none_of(step_.near_obstacles, [&](Index i) { return may_meet(i, margin); }))
    return;
  const ContactPoint point = points_[number];
  if (!is_free(point)) return;
  if (point_pushes_)
    point_pushes_->add(point);
  else
    step_.add_near(attributes_, number);
  Pushed& added = step_.pushed.emplace_back(number, step_.pushes.size());
  for (const Index i : step_.near_obstacles)
    if (may_meet(i, reach)) step_.pushes.emplace_back(number, i);
  added.count = step_.pushes.size() - added.first;
}

bool Contact::is_free(const ContactPoint& point) const {
  return std::ranges::any_of(point.vertices, [&](Index v) {
    return (*step_.moving)[v] && attributes_.fixed().rows()[v] != all_held;
  });
}

/// Obstacles have the last word: nothing is left inside them.
void Contact::push(double dt) {
  push_out_of_obstacles(dt);
  for (int sweep = 0; edges_ && sweep < max_edge_sweeps; ++sweep) {
    if (dt * sweep_edges(dt) <= least_push * shortest_edge_) break;
    push_out_of_obstacles(dt);
  }
}

void Contact::push_out_of_obstacles(double dt) {
  if (point_pushes_)
    point_pushes_->push(dt);
  else
    vertex_pushes_->push(dt);
}

void Contact::book(const ContactStep& step) {
  ContactBooks books(attributes_, step_, step, results_, kept_);
  for (std::size_t i = 0; i < step_.near.size(); ++i)
    books.vertex(step_.near[i], point_pushes_ ? std::span<PushBy>() : step_.pushes_on(i),
                 corrections_);
  for (std::size_t i = 0; point_pushes_ && i < step_.pushed.size(); ++i)
    books.point(point_pushes_->point(i), point_pushes_->mass(i), step_.pushes_on(i));
  if (pairs_) {
    book_pairs(books);
    note_pairs(step);
  }
  if (edges_) book_edges(books);
  books.sum_loads();
  if (pieces_) book_pieces(books);
}

/// As for obstacles, with the mean sliding of the point over the triangle.
void Contact::book_pairs(ContactBooks& books) {
  const std::span<const Vec3> tangential = point_pushes_->friction_of_pairs();
  for (std::size_t i = 0; i < tangential.size(); ++i) {
    if (tangential[i] == Vec3{}) continue;
    const std::size_t at = point_pushes_->place_of_pair(i);
    books.friction(point_pushes_->impulse(at, tangential[i]),
                   books.mean_velocity(point_pushes_->point(at)));
  }
}

/// Which pieces press on each other, and what they would do to those that sleep: by the impulse of
/// the step, and that of the next one where a gap is about to close.
void Contact::note_pairs(const ContactStep& step) {
  kept_.pair_presses.clear();
  kept_.pushed_sleepers.clear();
  const SurfacePoints& points = points_.embedded();
  const auto first_vertex = [&](Index point) { return points[point].vertices[0]; };
  for (std::size_t i = 0; i < pairs_->size(); ++i) {
    const std::size_t at = point_pushes_->place_of_pair(i);
    const ContactPoint point = point_pushes_->point(at);
    const Vec3& normal = pairs_->normal(i);
    double impulse = dot(normal, point_pushes_->impulse(at, step_.pushed[at].change));
    if (impulse != 0)
      kept_.pair_presses.push_back({first_vertex(pairs_->point(i)),
                                    first_vertex(points.triangles()[pairs_->triangle(i)][0])});
    if (step.moving->all()) continue;
    const double gap = dot(normal, point.sum(attributes_.position().rows())),
                 speed = dot(normal, point.sum(attributes_.velocity().rows())),
                 closing = std::max(0.0, -std::max(gap, 0.0) / step.dt - speed);
    impulse += dot(normal, point_pushes_->impulse(at, scaled(closing, normal)));
    for (std::size_t j = 0; j < point.vertices.size() && impulse != 0; ++j)
      if (const Index v = point.vertices[j]; !(*step.moving)[v])
        kept_.pushed_sleepers.push_back({v, std::abs(point.weights[j]) * impulse /
                                                (attributes_.mass().rows()[v] * step.whole_gain)});
  }
}

/// As for obstacles, with the mean sliding of the vertex over the face.
void Contact::book_pieces(ContactBooks& books) {
  for (const PieceContact::Touch& touch : pieces_->touches()) {
    if (touch.friction == Vec3{}) continue;
    Vec3 sliding{};
    for (std::size_t i = 0; i < 5; ++i)
      sliding = plus(sliding, scaled(touch.weights[i],
                                     books.mean_velocity(vertex_pushes_->near(touch.places[i]))));
    books.friction(touch.friction, sliding);
  }
}

// -------------------------------------------------------------------- queries --

Pose Contact::pose(std::size_t obstacle, double time) const {
  return tools_[obstacle] ? tools_[obstacle]->pose() : obstacles_[obstacle].motion.pose(time);
}

std::optional<Contact::ToolState> Contact::tool_state(std::size_t obstacle) const {
  const std::optional<Tool>& tool = tools_[obstacle];
  if (!tool) return {};
  return ToolState{tool->pose(), tool->hand_force(), tool->hand_torque()};
}

double Contact::power() const {
  const PartialRows::OwnIsEnough marked(attributes_.partial_rows());
  double power = 0;
  for (const Touch& touch : results_.touches)
    power += dot(touch.force, row(attributes_.velocity().rows(), touch.vertex));
  return power;
}

void Contact::record(std::span<const Force> forces, double time, double heat) {
  results_.touches.clear();
  kept_.sides.clear();
  std::ranges::fill(results_.loads, Load{});
  for (const auto& [vertex, force, obstacle, point, gap] : forces) {
    results_.touches.push_back({vertex, force});
    if (obstacle == between_pieces) continue;
    const PlacedObstacle placed(obstacles_[obstacle], 0, time, time);
    const Vec3 place = row(attributes_.position().rows(), vertex);
    if (!kept_.sides.outside(obstacle, point))
      kept_.sides.add(obstacle, point,
                      placed.given_outside(points_.place(point), gap, marked_outside * mean_edge_));
    const Vec3 arm = minus(place, placed.centre());
    results_.loads[obstacle].force = minus(results_.loads[obstacle].force, force);
    results_.loads[obstacle].torque = minus(results_.loads[obstacle].torque, cross(arm, force));
  }
  std::ranges::stable_sort(results_.touches, {}, &Touch::vertex);
  std::size_t last = 0;  // one for each vertex
  for (std::size_t i = 1; i < results_.touches.size(); ++i)
    if (results_.touches[i].vertex == results_.touches[last].vertex)
      results_.touches[last].force = plus(results_.touches[last].force, results_.touches[i].force);
    else
      results_.touches[++last] = results_.touches[i];
  if (!results_.touches.empty()) results_.touches.resize(last + 1);
  results_.friction_work -= heat;
}

void Contact::restart() {
  kept_.last_dt = 0;
  if (point_pushes_) point_pushes_->forget_forces();
  results_.touches.clear();
  kept_.obstacle_forces.clear();
  std::ranges::fill(results_.loads, Load{});
  results_.work = results_.friction_work = results_.cutting_work = results_.step_work =
      kept_.closing_speed = 0;
}

std::optional<Contact::Failure> Contact::failure() const {
  const PartialRows::OwnIsEnough marked(attributes_.partial_rows());
  const PieceContact::Touch* touch = pieces_ ? pieces_->too_deep() : nullptr;
  if (!touch) return {};
  return Failure{{touch->vertices[0], touch->vertices[3]}, pieces_->depth(*touch)};
}

// ---------------------------------------------------------- operations and state --

void Contact::follow(const CellComplex& complex, const TopologyChange& change) {
  points_.follow(complex, change);
  if (points_.are_embedded())
    kept_.forget_points();
  else
    kept_.sides.follow(complex, change);
  if (pairs_) pairs_->follow();
  if (point_pushes_) point_pushes_->follow();
  if (pieces_) pieces_->follow(change);
  if (edges_) edges_->follow(change);
  const auto is_gone = [&](const auto& known) { return !complex.exists(0, known.vertex); };
  std::erase_if(results_.touches, is_gone);
  std::erase_if(kept_.obstacle_forces, is_gone);
}

void Contact::state(Archive& archive) {
  points_.state(archive);
  if (archive.has_cells())
    for (Obstacle& obstacle : obstacles_)
      archive(("path of " + obstacle.name).c_str(), obstacle.motion);
  if (archive.loads() && pairs_) pairs_->follow();
  if (pieces_) archive("pieces", *pieces_);
  if (pairs_) kept_.state_of_pairs(archive);
  archive.member("touching", results_.touches, &Touch::vertex);
  archive.member("forces", results_.touches, &Touch::force);
  archive.member("pushed", kept_.obstacle_forces, &KeptContact::ObstacleForce::vertex);
  archive.member("pushed by", kept_.obstacle_forces, &KeptContact::ObstacleForce::obstacle);
  archive.member("pushes", kept_.obstacle_forces, &KeptContact::ObstacleForce::force);
  archive.rows<double>("loads", results_.loads);
  archive.group("sides", [&] { kept_.sides.state(archive, obstacles_.size(), points_.count()); });
  for (std::size_t i = 0; i < tools_.size(); ++i)
    if (tools_[i]) archive(("tool " + obstacles_[i].name).c_str(), *tools_[i]);
  archive("work", results_.work);
  archive("friction work", results_.friction_work);
  if (edges_) {
    archive("edges", *edges_);
    archive("cutting work", results_.cutting_work);
    archive("last dt", kept_.last_dt);
  }
  archive("closing speed", kept_.closing_speed);
  archive("longest dt", kept_.longest_dt);
  if (point_pushes_) archive("pushes of points", *point_pushes_);
}

}  // namespace suture
