// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/point_pushes.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "kernel/topology/disjoint_sets.hpp"

namespace suture {
namespace {

constexpr int least_sweeps = 3, most_sweeps = 64, plain_sweeps = 8;
// Sweeps end where one changes the impulses by less than this part of their norm by the energy, and
// no point by more than this, in edges.
constexpr double part_of_impulse = 1e-2, largest_miss = 1e-4;
// In edges: what the first sweep changes at most if the forces of the last step hold, and where
// sweeps end if it changes more.
constexpr double sudden = 1e-3, miss_if_sudden = 1e-6;
// Where points touch triangles, sweeps end at this part of the first change, if that is less: a
// pile comes to rest only so.
constexpr double lag_of_pairs = 0.1;

}  // namespace

void PointPushes::begin(const ContactStep& step) {
  sweeps_.clear(attributes_.vertex_count());
  step_.near_of_vertex.resize(attributes_.vertex_count(), none);
  gain_ = step.whole_gain;
  is_again_ = false;
  plane_velocities_.clear();
  for (const PlacedObstacle& placed : step_.placed)
    plane_velocities_.push_back(placed.is_plane() ? placed.velocity(step.dt) : Vec3{});
  first_pair_ = std::size_t(-1);
}

void PointPushes::add(const ContactPoint& point) {
  const double* masses = attributes_.mass().rows();
  for (const Index v : point.vertices) {
    Index& place = step_.near_of_vertex[v];
    if (place != none) continue;
    place = static_cast<Index>(step_.near.size());
    step_.add_near(attributes_, v);
    const bool moves = (*step_.moving)[v];
    sweeps_.add_vertex(v, masses[v],
                       moves ? static_cast<unsigned>(attributes_.fixed().rows()[v]) : all_held);
  }
  sweeps_.add(point, masses);
}

void PointPushes::find_pairs(double back) {
  first_pair_ = step_.pushed.size();
  pairs_->find(back, step_.moving);
  pair_tangential_.assign(pairs_->size(), {});
  for (std::size_t i = 0; i < pairs_->size(); ++i) {
    add((*pairs_)[i]);
    step_.pushed.emplace_back(static_cast<Index>(i), step_.pushes.size());
  }
}

// --------------------------------------------------------------------- groups --

unsigned PointPushes::rank(std::size_t i) const {
  const PointSweeps::Contact& contact = sweeps_.contacts[i];
  if (is_pair(i)) return contact.is_plane ? 0 : 3;
  return contact.is_plane ? 1 : 2;
}

/// Points that share no vertex, directly or through others, do not push each other: each group has
/// sweeps of its own.
void PointPushes::group_points() {
  std::vector<Kind> now;
  const std::size_t count = step_.pushed.size();
  for (std::size_t i = 0; i < count; ++i) now.push_back({step_.pushed[i].vertex, rank(i)});
  const bool has_pairs = first_pair_ < count;
  if (!has_pairs && !now.empty() && now == grouped_) return;
  grouped_ = has_pairs ? std::vector<Kind>{} : now;

  DisjointSets sets(step_.near.size());
  const auto near_of = [&](Index v) { return std::size_t{step_.near_of_vertex[v]}; };
  const auto first_near = [&](std::size_t i) { return near_of(sweeps_.contacts[i].vertices[0]); };
  for (std::size_t i = 0; i < count; ++i)
    for (const Index v : point(i).vertices.subspan(1)) sets.unite(first_near(i), near_of(v));
  std::vector<std::tuple<std::size_t, unsigned, std::uint32_t>> sorted;
  for (std::size_t i = 0; i < count; ++i)
    sorted.push_back({sets.find(first_near(i)), now[i].rank, static_cast<std::uint32_t>(i)});
  std::ranges::sort(sorted);
  std::vector<std::pair<std::size_t, Index>> vertices;
  for (std::size_t i = 0; i < step_.near.size(); ++i)
    vertices.push_back({sets.find(i), step_.near[i].vertex});
  std::ranges::sort(vertices);

  order_.clear();
  of_groups_.clear();
  groups_.clear();
  for (const auto& [set, vertex] : vertices) of_groups_.push_back(vertex);
  auto vertex = vertices.begin();
  for (std::size_t k = 0; k < sorted.size();) {
    Group& group = groups_.emplace_back();
    const std::size_t set = std::get<0>(sorted[k]);
    group.first = k;
    const auto pass = [&](unsigned rank) {
      for (; k < sorted.size() && std::get<0>(sorted[k]) == set && std::get<1>(sorted[k]) <= rank;
           ++k)
        order_.push_back(std::get<2>(sorted[k]));
      return k;
    };
    group.planes = pass(0);
    group.others = pass(1);
    group.other_pairs = pass(2);
    group.end = pass(3);
    while (vertex->first != set) ++vertex;  // of what only edges of blades reach
    group.first_vertex = std::size_t(vertex - vertices.begin());
    while (vertex != vertices.end() && vertex->first == set) ++vertex;
    group.end_of_vertices = std::size_t(vertex - vertices.begin());
  }
}

// --------------------------------------------------------------------- sweeps --

/// Pairs come first in a group. What obstacles push is then swept without them, so that nothing is
/// left inside.
void PointPushes::push(double dt) {
  for (std::size_t i = 0; i < step_.pushed.size(); ++i) fill(i, dt);
  group_points();
  for (const Group& group : groups_) {
    if (!is_again_)
      for (const std::uint32_t i : order(group.first, group.end)) begin_warm(i);
    sweep_group(group, true, dt);
    if (has_pairs(group)) sweep_group(group, false, dt);
  }
  finish(dt);
  is_again_ = true;
}

/// What is known of a contact before the sweeps.
void PointPushes::fill(std::size_t i, double dt) {
  PointSweeps::Contact& contact = sweeps_.contacts[i];
  const ContactInProgress::Pushed& pushed = step_.pushed[i];
  const ContactInProgress::PushBy* by =
      !is_pair(i) && pushed.count == 1 ? &step_.pushes[pushed.first] : nullptr;
  contact.is_plane =
      contact.fixed == 0 && (is_pair(i) || (by && step_.placed[by->obstacle].is_plane()));
  contact.pressed = contact.sliding = 0;
  if (!contact.is_plane) return;
  const bool is_known = by && !is_again_;
  const ContactPoint at = point(i);
  const Vec3 end =
      is_known ? row(points_.positions(), pushed.vertex) : at.sum(attributes_.position().rows());
  const Vec3 velocity =
      is_known ? row(points_.velocities(), pushed.vertex) : at.sum(attributes_.velocity().rows());
  if (!by) {
    contact.normal = PointSweeps::row_of(pairs_->normal(i - first_pair_));
    contact.lacking = pairs_->lacking(i - first_pair_, end, velocity, dt) / dt;
    contact.friction = pairs_->friction();
    contact.velocity = PointSweeps::row_of(velocity);
  } else {
    const PlacedObstacle& placed = step_.placed[by->obstacle];
    contact.normal = PointSweeps::row_of(placed.normal());
    contact.lacking =
        placed.lacking({minus(end, scaled(dt, velocity)), end, {}, 0, dt}, max_push * edge_) / dt;
    contact.friction = obstacles_[by->obstacle].friction;
    contact.velocity = PointSweeps::row_of(minus(velocity, plane_velocities_[by->obstacle]));
  }
}

/// With the force of the last step, as far as the law of contact allows it.
void PointPushes::begin_warm(std::size_t i) {
  PointSweeps::Contact& contact = sweeps_.contacts[i];
  const Vec3& force =
      is_pair(i) ? last_.of_pair(pairs_->point(i - first_pair_), pairs_->triangle(i - first_pair_))
                 : last_.on_point(step_.pushed[i].vertex);
  if (force == Vec3{}) return;
  Vec3 change;
  for (std::size_t c = 0; c < 3; ++c) change[c] = gain_ * force[c] / contact.mass[c];
  if (contact.is_plane) {
    const Vec3 n = PointSweeps::vec_of(contact.normal);
    const double normal = dot(change, n), most = contact.friction * normal;
    if (!(normal > 0)) return;
    const Vec3 along = minus(change, scaled(normal, n));
    const double size = norm(along);
    change = plus(scaled(normal, n), scaled(size > most ? most / size : 1, along));
  }
  sweeps_.add_change(contact, change);
}

void PointPushes::sweep_group(const Group& group, bool with_pairs, double dt) {
  const auto planes = order(with_pairs ? group.first : group.planes, group.others),
             others = order(group.others, with_pairs ? group.end : group.other_pairs),
             all = order(with_pairs ? group.first : group.planes,
                         with_pairs ? group.end : group.other_pairs);
  const auto vertices =
      std::span(of_groups_).subspan(group.first_vertex, group.end_of_vertices - group.first_vertex);
  const bool have_pairs = with_pairs && has_pairs(group);
  const double edge = step_.eased * edge_;  // of a speed, not of a way: dt may be tiny
  double last = 0, precision = largest_miss * edge, part = have_pairs ? 1 : part_of_impulse;
  for (int number = 0; number < most_sweeps; ++number) {
    if (number == plain_sweeps) sweeps_.begin_directions(all, vertices);
    if (number >= plain_sweeps) sweeps_.keep(all, vertices);
    const PointSweeps::Changes changes = sweep(planes, others, dt);
    const double largest = dt * std::sqrt(changes.largest);
    if (number == 0 && have_pairs) {
      precision = std::clamp(lag_of_pairs * largest, least_push * edge, precision);
    } else if (number == 0 && largest > sudden * edge) {
      precision = miss_if_sudden * edge;
      part = 1;
    }
    if (largest == 0 || number + 1 == most_sweeps) break;
    if ((have_pairs || number + 1 >= least_sweeps) && largest <= precision &&
        changes.energy <= part * part * changes.all)
      break;
    if (number < plain_sweeps) continue;
    sweeps_.go_on(last == 0 || changes.energy > last ? 0 : changes.energy / last, all, vertices);
    last = changes.energy;
  }
}

PointSweeps::Changes PointPushes::sweep(std::span<const std::uint32_t> planes,
                                        std::span<const std::uint32_t> others, double dt) {
  PointSweeps::Changes changes;
  sweeps_.sweep(planes, changes);
  for (const std::uint32_t i : others)
    sweeps_.set_change(sweeps_.contacts[i], change_of(i, dt), changes);
  return changes;
}

/// By the general law.
Vec3 PointPushes::change_of(std::size_t i, double dt) {
  const PointSweeps::Contact& contact = sweeps_.contacts[i];
  const ContactPoint at = point(i);
  const Vec3 others = sweeps_.change_by_others(contact);
  const Vec3 end = plus(at.sum(attributes_.position().rows()), scaled(dt, others));
  const Vec3 velocity = plus(at.sum(attributes_.velocity().rows()), others);
  if (is_pair(i)) {
    const auto [normal, tangential] =
        pairs_->change(i - first_pair_, end, velocity, contact.fixed, dt);
    pair_tangential_[i - first_pair_] = tangential;
    return plus(normal, tangential);
  }
  VertexPath path{minus(end, scaled(dt, velocity)), end, {}, contact.fixed, dt};
  step_.push_path(path, step_.pushes_on(i), edge_);
  return path.change;
}

// -------------------------------------------------------------------- results --

void PointPushes::finish(double dt) {
  double* x = attributes_.position().rows();
  double* v = attributes_.velocity().rows();
  for (const Index vertex : of_groups_) {
    PointSweeps::Row& change = sweeps_.vertices[vertex].change;
    for (std::size_t c = 0; c < 3; ++c) {
      v[4 * std::size_t{vertex} + c] += change[c];
      x[4 * std::size_t{vertex} + c] += dt * change[c];
    }
    change = {};
  }
  for (std::size_t i = 0; i < step_.pushed.size(); ++i) note_push(i);
}

void PointPushes::note_push(std::size_t i) {
  const PointSweeps::Contact& contact = sweeps_.contacts[i];
  ContactInProgress::Pushed& pushed = step_.pushed[i];
  pushed.change = PointSweeps::vec_of(contact.change);
  if (!contact.is_plane) return;
  const Vec3 normal = scaled(contact.pressed, PointSweeps::vec_of(contact.normal)),
             tangential = minus(pushed.change, normal);
  if (is_pair(i)) {
    pair_tangential_[i - first_pair_] = tangential;
    return;
  }
  ContactInProgress::PushBy& by = step_.pushes[pushed.first];
  by.push = {};
  if (contact.pressed > 0)
    by.push = {normal, tangential, plane_velocities_[by.obstacle], contact.sliding};
}

void PointPushes::release() {
  for (PointSweeps::Contact& contact : sweeps_.contacts) contact.change = {};
  is_again_ = false;
}

void PointPushes::keep_forces() {
  last_.clear();
  for (std::size_t i = 0; i < step_.pushed.size(); ++i) {
    if (step_.pushed[i].change == Vec3{}) continue;
    const Vec3 force = scaled(1 / gain_, impulse(i, step_.pushed[i].change));
    if (is_pair(i))
      last_.add_pair(pairs_->point(i - first_pair_), pairs_->triangle(i - first_pair_), force);
    else
      last_.add_point(step_.pushed[i].vertex, force);
  }
  last_.sort_pairs();
}

}  // namespace suture
