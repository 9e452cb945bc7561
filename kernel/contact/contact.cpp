// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/contact.hpp"

#include <algorithm>
#include <limits>

#include "kernel/contact/row_lanes.hpp"
#include "kernel/solvers/clones.hpp"

namespace suture {
namespace {

// Between two obstacles that a vertex touches at once.
constexpr int max_sweeps = 16;
// Over all contacts between pieces.
constexpr int max_piece_sweeps = 32;
// Over all samples of cutting edges.
constexpr int max_edge_sweeps = 64;
// How far a vertex is pushed out of an obstacle in a step, in elements.
constexpr double max_push = 0.01;
// How far other pieces may push a vertex in a step, or vertices a tool; of an element.
constexpr double pushed = 0.5;
// How far outside an obstacle the side of a vertex that touches it is marked, in elements.
constexpr double marked_outside = 1e-6;
// Vertices of which the box is tested first, before each of them.
constexpr std::size_t box_size = 32;
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
      surface_(complex) {
  if (embedding) points_.emplace(std::move(embedding));
  shortest_edge_ = std::numeric_limits<double>::infinity();
  const double* rest = attributes.rest().rows();
  for (const BoundarySurface::Corners& corners : surface_.corners())
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec3 a = row(rest, corners[i]), b = row(rest, corners[(i + 1) % 4]);
      const double edge = norm(minus(a, b));
      shortest_edge_ = std::min(shortest_edge_, edge);
      longest_edge_ = std::max(longest_edge_, edge);
      mean_edge_ += edge / (4 * static_cast<double>(surface_.corners().size()));
      include(box_, a);
    }
  size_ = norm(minus(box_.high, box_.low));
  for (const Obstacle& obstacle : obstacles_) {
    std::optional<Tool>& tool = tools_.emplace_back();
    if (obstacle.coupling) tool.emplace(obstacle);
    has_tools_ = has_tools_ || tool;
    has_solids_ = has_solids_ || !std::holds_alternative<HalfSpace>(obstacle.shape);
  }
}

// --------------------------------------------------------------------- a step --

void Contact::touch_pieces(const PieceContact::Options& options) {
  if (points_)
    pairs_.emplace(complex_, attributes_, *points_, options, mean_edge_);
  else
    pieces_ = std::make_unique<PieceContact>(complex_, surface_, attributes_, options, mean_edge_);
}

void Contact::prepare(const ContactStep& step) {
  placed_.clear();
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    if (tools_[i]) {
      tools_[i]->begin(obstacles_[i].motion, step.time, step.end, step.dt, step.whole_gain);
      placed_.emplace_back(obstacles_[i], thickness_, tools_[i]->pose(), tools_[i]->end());
    } else {
      placed_.emplace_back(obstacles_[i], thickness_, step.time, step.end);
    }
  }
  if (vertices_.empty())
    vertices_ = points_ ? points_->ascending_vertices() : surface_.ascending_vertices();
  forces_.resize(4 * std::size_t{attributes_.vertex_count()});
  const double* force = attributes_.force().rows();
  const auto keep = [&](Index v) { row_at(forces_.data(), v) = row_at(force, v); };
  std::ranges::for_each(vertices_, keep);
  if (!edges_) return;
  edges_->begin(placed_, step.end - step.time, last_dt_);
  std::ranges::for_each(edges_->vertices(), keep);
}

std::span<const Contact::Correction> Contact::resolve(const ContactStep& step) {
  corrections_.clear();
  const auto moves = [&](const auto& known) { return (*step.moving)[known.vertex]; };
  std::erase_if(touches_, moves);  // the forces on sleepers stay
  std::erase_if(obstacle_forces_, moves);
  step_work_ = 0;
  moving_ = step.moving;
  find_near_obstacles(step);
  if (pieces_) find_touching_pieces(step);
  if (pairs_) find_pairs();
  if (edges_) {
    find_at_edges();
    edges_->engage(step.whole_gain);
  }
  push(step.dt);
  if (has_tools_) settle_tools(step);
  for (std::size_t i = 0; i < near_.size(); ++i)
    book(near_[i], points_ ? std::span<PushBy>() : pushes_on(i), step);
  if (points_) book_points(step);
  if (pairs_) {
    book_pairs(step);
    note_pairs(step);
  }
  if (edges_) book_edges(step);
  if (points_ || edges_)
    for (const Near& near : near_) near_of_vertex_[near.vertex] = none;
  last_dt_ = step.dt;
  sum_loads();
  if (pieces_) book_friction_of_pieces(step);
  closing_speed_ = find_closing_speed();
  return corrections_;
}

/// How fast things that may touch approach each other, at most, m/s. Nodes outside of the material
/// do not count: they are faster than all of it.
double Contact::find_closing_speed() {
  const double* velocities = attributes_.velocity().rows();
  if (pieces_ && pieces_->may_meet()) return diagonal_of(box_around(velocities, vertices_));
  if (!pairs_ || !pairs_->may_meet()) return 0;
  points_->gather_velocities(attributes_);
  const double near = diagonal_of(box_around(points_->velocities(), pairs_->near_points()));
  return std::max(
      near, diagonal_of(box_around(points_->velocities(), points_->numbers())) / far_over_near);
}

/// By boxes of vertices first.
void Contact::find_near_obstacles(const ContactStep& step) {
  near_.clear();
  pushed_.clear();
  pushes_.clear();
  point_masses_.clear();
  near_of_points_.clear();
  first_near_.assign(1, 0);
  const double reach = pushed * mean_edge_;
  const double margin = pieces_ || pairs_ || has_tools_ ? reach : 0;  // others push it, too
  if (points_) points_->gather(attributes_);
  const std::span<const Index> all = points_ ? points_->numbers() : vertices_;
  const double* x = points_ ? points_->positions() : attributes_.position().rows();
  const double* velocity = points_ ? points_->velocities() : attributes_.velocity().rows();
  const double* fixed = attributes_.fixed().rows();
  for (std::size_t first = 0; first < all.size(); first += box_size) {
    const auto vertices = all.subspan(first, std::min(box_size, all.size() - first));
    const Box box = box_around(x, vertices);
    const Vec3 half = scaled(0.5, minus(box.high, box.low)), middle = plus(box.low, half);
    const double radius = norm(half);
    const double way = has_solids_ ? step.dt * fastest(velocity, vertices) : 0;
    near_placed_.clear();
    for (Index i = 0; i < placed_.size(); ++i)
      if (obstacles_[i].pushes &&
          placed_[i].may_touch(middle,
                               radius + std::max(reach, margin + placed_[i].longest_way(way))))
        near_placed_.push_back(i);
    if (near_placed_.empty()) continue;
    for (const Index v : vertices) {
      const Vec3 place = row(x, v), start = minus(place, scaled(step.dt, row(velocity, v)));
      const auto may_meet = [&](Index i) { return placed_[i].may_meet(start, place, margin); };
      if (std::ranges::none_of(near_placed_, may_meet)) continue;
      if (points_) {
        if (!is_free(v, *step.moving)) continue;
        add_near_point(v);
      } else {
        if (!(*step.moving)[v] || fixed[v] == all_held) continue;
        add_near(v);
      }
      pushed_.emplace_back(v, pushes_.size());
      for (const Index i : near_placed_)
        if (placed_[i].may_meet(start, place, reach)) pushes_.emplace_back(v, i);
      pushed_.back().count = pushes_.size() - pushed_.back().first;
    }
  }
}

void Contact::find_touching_pieces(const ContactStep& step) {
  near_.erase(near_.begin() + std::ptrdiff_t(pushed_.size()), near_.end());
  shared_.clear();
  pieces_->begin(step.dt, step.whole_gain, *step.moving);
  const DenseSet& touching = pieces_->touching();
  near_place_.assign(touching.items().size(), none);
  for (Index i = 0; i < pushed_.size(); ++i) {
    if (!touching.contains(pushed_[i].vertex)) continue;
    near_place_[touching.place(pushed_[i].vertex)] = i;
    shared_.push_back(i);
  }
  for (std::size_t i = 0; i < near_place_.size(); ++i) {
    if (near_place_[i] != none) continue;
    near_place_[i] = static_cast<Index>(near_.size());
    add_near(touching.items()[i]);
  }
  pieces_->apply_last_forces();
}

void Contact::add_near(Index vertex) {
  near_.emplace_back(vertex, row(attributes_.position().rows(), vertex),
                     row(attributes_.velocity().rows(), vertex));
}

/// Obstacles have the last word: nothing is left inside them.
void Contact::push(double dt) {
  push_out_of_obstacles(dt);
  for (int sweep = 0; edges_ && sweep < max_edge_sweeps; ++sweep) {
    if (dt * sweep_edges(dt) <= least_push * shortest_edge_) break;
    push_out_of_obstacles(dt);
  }
}

/// Obstacles have the last word in each sweep. After the first one, only pieces move vertices.
void Contact::push_out_of_obstacles(double dt) {
  if (points_) return push_points(dt);
  const bool meet = pieces_ && !pieces_->touches().empty();
  const auto velocity = [&](std::size_t i) {
    return row(attributes_.velocity().rows(), pushed_[i].vertex);
  };
  const auto settle = [&](std::size_t i) {
    Pushed& pushed = pushed_[i];
    const Vec3 before = velocity(i);
    if (meet) move(near_[i], dt);
    push_out(pushed, pushes_on(i), dt);
    pushed.settled = velocity(i);
    if (meet) pieces_->disturb(pushed.vertex, dt * norm(minus(pushed.settled, before)));
  };
  bool changes = meet && pieces_->sweep();
  for (std::size_t i = 0; i < pushed_.size(); ++i) settle(i);
  for (int sweep = 1; changes && sweep < max_piece_sweeps; ++sweep) {
    changes = pieces_->sweep();
    for (const Index i : shared_)
      if (velocity(i) != pushed_[i].settled) settle(i);
  }
  if (meet)
    for (const Near& near : std::span(near_).subspan(pushed_.size())) move(near, dt);
}

/// To where the changed velocity takes it.
void Contact::move(const Near& near, double dt) {
  const Vec3 change = minus(row(attributes_.velocity().rows(), near.vertex), near.free_velocity);
  const Vec3 end = plus(near.free_end, scaled(dt, change));
  std::ranges::copy(end, attributes_.position().rows() + 4 * std::size_t{near.vertex});
}

/// Out of one obstacle after the other, until it is in none. What an earlier sweep did is taken
/// back before: other pieces may hold the vertex now.
void Contact::push_out(Pushed& pushed, std::span<PushBy> pushes, double dt) {
  double* x = attributes_.position().rows() + 4 * std::size_t{pushed.vertex};
  double* v = attributes_.velocity().rows() + 4 * std::size_t{pushed.vertex};
  const Vec3 last = pushed.change;
  const Vec3 end = minus({x[0], x[1], x[2]}, scaled(dt, last));
  const Vec3 velocity = minus({v[0], v[1], v[2]}, last);
  const auto fixed = static_cast<unsigned>(attributes_.fixed().rows()[pushed.vertex]);
  VertexPath path{minus(end, scaled(dt, velocity)), end, {}, fixed, dt};
  push_path(path, pushes);
  pushed.change = path.change;
  if (path.change == Vec3{} && last == Vec3{}) return;
  for (std::size_t c = 0; c < 3; ++c) {
    x[c] = path.end[c];
    v[c] = velocity[c] + path.change[c];
  }
}

/// Clears the pushes before.
void Contact::push_path(VertexPath& path, std::span<PushBy> pushes) const {
  for (PushBy& by : pushes) by.push = {};
  bool moved = true;
  for (int sweep = 0; sweep < max_sweeps && moved; ++sweep) {
    moved = false;
    for (auto& [vertex, obstacle, push] : pushes) {
      const PlacedObstacle& placed = placed_[obstacle];
      if (sweep > 0 && !placed.may_meet(path.start, path.end, -least_push * shortest_edge_))
        continue;
      const double speed = placed.push(path, max_push * shortest_edge_, push);
      moved = moved || path.dt * speed > least_push * shortest_edge_;
    }
    if (pushes.size() <= 1) break;  // once is enough
  }
}

/// An impulse J does the work J . (v- + v+)/2 (with damping, times work_gain), exactly what it
/// changes in the kinetic energy, and friction as much relative to the obstacle.
void Contact::book(Near& near, std::span<const PushBy> pushes, const ContactStep& step) {
  const double mass = attributes_.mass().rows()[near.vertex];
  const Vec3 velocity = row(attributes_.velocity().rows(), near.vertex);
  const Vec3 change = minus(velocity, near.free_velocity);
  if (change == Vec3{}) return;
  const Vec3 force = free_force(near, step);
  near.is_booked = true;
  near.mean = mean_velocity(near, force, step);
  double heat = 0;
  for (const auto& [vertex, obstacle, push] : pushes) {
    if (push.normal == Vec3{}) continue;
    const Vec3 on = scaled(mass / step.whole_gain, plus(push.normal, push.tangential));
    heat -= mass * step.work_gain * dot(push.tangential, minus(near.mean, push.obstacle_velocity));
    obstacle_forces_.push_back({vertex, obstacle, on});
  }
  touches_.push_back({near.vertex, scaled(mass / step.whole_gain, change)});
  const double work = mass * step.work_gain * dot(change, near.mean);
  step_work_ += work;
  work_ += work + heat;
  friction_work_ -= heat;
  corrections_.push_back(
      {near.vertex, dot(force, change),
       mass * (dot(velocity, velocity) - dot(near.free_velocity, near.free_velocity))});
}

/// Without contact, N; of sleepers 0.
Vec3 Contact::free_force(const Near& near, const ContactStep& step) const {
  if (!(*step.moving)[near.vertex]) return {};
  return plus(row(forces_.data(), near.vertex),
              scaled(attributes_.mass().rows()[near.vertex], step.acceleration));
}

/// The mean of the velocities before and after the step; `force`: without contact. m/s
Vec3 Contact::mean_velocity(const Near& near, const Vec3& force, const ContactStep& step) const {
  const Vec3 kick = scaled(step.whole_gain / attributes_.mass().rows()[near.vertex], force);
  const Vec3 before = scaled(1 / step.whole_decay, minus(near.free_velocity, kick));
  return scaled(0.5, plus(before, row(attributes_.velocity().rows(), near.vertex)));
}

void Contact::sum_loads() {
  std::ranges::fill(loads_, Load{});
  for (const ObstacleForce& on : obstacle_forces_) {
    Load& load = loads_[on.obstacle];
    const Vec3 place = row(attributes_.position().rows(), on.vertex);
    const Vec3 arm = minus(place, placed_[on.obstacle].centre());
    load.force = minus(load.force, on.force);
    load.torque = minus(load.torque, cross(arm, on.force));
  }
}

/// As for obstacles, with the mean sliding of the vertex over the face.
void Contact::book_friction_of_pieces(const ContactStep& step) {
  for (const PieceContact::Touch& touch : pieces_->touches()) {
    if (touch.friction == Vec3{}) continue;
    Vec3 sliding{};
    for (std::size_t i = 0; i < 5; ++i) {
      const Near& near = near_[near_place_[touch.places[i]]];
      const Vec3 mean =
          near.is_booked ? near.mean : mean_velocity(near, free_force(near, step), step);
      sliding = plus(sliding, scaled(touch.weights[i], mean));
    }
    const double heat = -step.work_gain * dot(touch.friction, sliding);
    work_ += heat;
    friction_work_ -= heat;
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
  for (const Touch& touch : touches_)
    power += dot(touch.force, row(attributes_.velocity().rows(), touch.vertex));
  return power;
}

void Contact::record(std::span<const Force> forces, double time, double heat) {
  touches_.clear();
  sides_.clear();
  std::ranges::fill(loads_, Load{});
  for (const auto& [vertex, force, obstacle, point, gap] : forces) {
    touches_.push_back({vertex, force});
    if (obstacle == between_pieces) continue;
    const PlacedObstacle placed(obstacles_[obstacle], 0, time, time);
    const Vec3 place = row(attributes_.position().rows(), vertex);
    if (!sides_.outside(obstacle, point)) {
      const Vec3 touching = points_ ? (*points_)[point].sum(attributes_.position().rows()) : place;
      sides_.add(obstacle, point, placed.given_outside(touching, gap, marked_outside * mean_edge_));
    }
    const Vec3 arm = minus(place, placed.centre());
    loads_[obstacle].force = minus(loads_[obstacle].force, force);
    loads_[obstacle].torque = minus(loads_[obstacle].torque, cross(arm, force));
  }
  std::ranges::stable_sort(touches_, {}, &Touch::vertex);
  std::size_t last = 0;  // one for each vertex
  for (std::size_t i = 1; i < touches_.size(); ++i)
    if (touches_[i].vertex == touches_[last].vertex)
      touches_[last].force = plus(touches_[last].force, touches_[i].force);
    else
      touches_[++last] = touches_[i];
  if (!touches_.empty()) touches_.resize(last + 1);
  friction_work_ -= heat;
}

void Contact::restart() {
  last_dt_ = 0;
  touches_.clear();
  obstacle_forces_.clear();
  std::ranges::fill(loads_, Load{});
  work_ = friction_work_ = cutting_work_ = step_work_ = closing_speed_ = 0;
}

std::optional<Contact::Failure> Contact::failure() const {
  const PartialRows::OwnIsEnough marked(attributes_.partial_rows());
  const PieceContact::Touch* touch = pieces_ ? pieces_->too_deep() : nullptr;
  if (!touch) return {};
  return Failure{{touch->vertices[0], touch->vertices[3]}, pieces_->depth(*touch)};
}

// ---------------------------------------------------------- operations and state --

void Contact::follow(const CellComplex& complex, const TopologyChange& change) {
  surface_.follow(complex, change);
  if (points_) {
    points_->follow();
    if (pairs_) pairs_->follow();
    pair_presses_.clear();
    presses_asleep_.clear();
    pushed_sleepers_.clear();
    sides_.clear();
  } else {
    sides_.follow(complex, change);
  }
  vertices_.clear();
  if (pieces_) pieces_->follow(change);
  if (edges_) edges_->follow(change);
  const auto is_gone = [&](const auto& known) { return !complex.exists(0, known.vertex); };
  std::erase_if(touches_, is_gone);
  std::erase_if(obstacle_forces_, is_gone);
}

void Contact::state(Archive& archive) {
  if (archive.has_cells()) {
    archive("surface", surface_);
    for (Obstacle& obstacle : obstacles_)
      archive(("path of " + obstacle.name).c_str(), obstacle.motion);
  }
  if (archive.loads()) {
    vertices_.clear();
    if (points_ && archive.has_cells()) points_->follow();
    if (pairs_) pairs_->follow();
  }
  if (pieces_) archive("pieces", *pieces_);
  if (pairs_) {
    archive.rows<Index>("presses", pair_presses_);
    archive.rows<Index>("presses of sleepers", presses_asleep_);
    archive.member("pushed sleepers", pushed_sleepers_, &PushedSleeper::vertex);
    archive.member("their accelerations", pushed_sleepers_, &PushedSleeper::acceleration);
  }
  archive.member("touching", touches_, &Touch::vertex);
  archive.member("forces", touches_, &Touch::force);
  archive.member("pushed", obstacle_forces_, &ObstacleForce::vertex);
  archive.member("pushed by", obstacle_forces_, &ObstacleForce::obstacle);
  archive.member("pushes", obstacle_forces_, &ObstacleForce::force);
  archive.rows<double>("loads", loads_);
  archive.group("sides", [&] { sides_.state(archive, obstacles_.size(), point_count()); });
  for (std::size_t i = 0; i < tools_.size(); ++i)
    if (tools_[i]) archive(("tool " + obstacles_[i].name).c_str(), *tools_[i]);
  archive("work", work_);
  archive("friction work", friction_work_);
  if (edges_) {
    archive("edges", *edges_);
    archive("cutting work", cutting_work_);
    archive("last dt", last_dt_);
  }
  archive("closing speed", closing_speed_);
}

}  // namespace suture
