// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/cutting_edges.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernel/base/archive.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/rows.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/geometry/cube_size.hpp"
#include "kernel/parts/cube_sides.hpp"
#include "kernel/topology/dart.hpp"

namespace suture {
namespace {

// Between samples, and between a sample and the lips beside it, in edges of elements.
constexpr double spacing = 0.125, lips = 0.5;
// How far a sample between lips may be beside them along the slit, in edges.
constexpr double beside_lips = 0.05;
// The longest edge of a blade, in edges of elements: every sample takes time in every step.
constexpr double most_elements = 1e4;
// How far around the edges elements are collected, in edges.
constexpr double collected = 2;
// Within this distance of an open side, an edge that divides elements is on that side; as a share
// of the reference cube.
constexpr double on_side = 0.04;
// From the end of its slit, in edges: how far an edge is behind it if it is free, and up to where
// that end is known.
constexpr double behind_tip = 0.01, near_tip = 2;
// Motion by less is rounding, in edges.
constexpr double rounding = 1e-9;

Vec3 without_part_along(const Vec3& a, const Vec3& unit) {
  return minus(a, scaled(dot(a, unit), unit));
}

Vec3 unit(const Vec3& a) {
  const double length = norm(a);
  return length > 0 ? scaled(1 / length, a) : Vec3{};
}

/// The mean place of nodes; rows have 4 numbers.
template <class Nodes>
Vec3 middle(const Nodes& nodes, const double* rows) {
  Vec3 sum{};
  for (const Index v : nodes) sum = plus(sum, row(rows, v));
  return scaled(1.0 / static_cast<double>(nodes.size()), sum);
}

}  // namespace

void CuttingEdges::add(const Edge& edge) {
  double whole = 0;
  for (std::size_t i = 0; i + 1 < edge.points.size(); ++i)
    whole += norm(minus(edge.points[i + 1], edge.points[i]));
  if (!(whole <= most_elements * edge_))
    throw InputError("the edge of the blade is " + number_text(whole) + " m long, " +
                     number_text(whole / edge_) + " elements; where tissue resists, at most " +
                     number_text(most_elements) + ": let it end near the body");
  for (std::size_t i = 0; i + 1 < edge.points.size(); ++i) {
    const Vec3 &a = edge.points[i], way = minus(edge.points[i + 1], a);
    const double length = norm(way);
    if (length == 0) continue;
    const double count = std::ceil(length / (spacing * edge_));
    for (double s = 0.5; s < count; ++s)
      samples_.push_back({edges_.size(), edge.obstacle, plus(a, scaled(s / count, way)),
                          scaled(1 / length, way), length / count});
  }
  edges_.push_back(edge);
  is_divided_.emplace_back(complex_.element_count());
  Elements nowhere;
  nowhere.fill(none);
  elements_.resize(samples_.size(), nowhere);
  directions_.resize(samples_.size());
  withdrawn_.resize(samples_.size());
  has_begun_.resize(samples_.size());
  tips_.resize(samples_.size());
}

// ------------------------------------------------------------------ where they are --

void CuttingEdges::begin(std::span<const PlacedObstacle> obstacles, double dt, double last) {
  dt_ = dt;
  place(obstacles);
  Box box = no_box;
  for (const Sample& sample : samples_) include(box, sample.start);
  finder_.update(box, last, collected * edge_);
  gripping_.clear();
  first_.assign(1, 0);
  vertices_.clear();
  weights_.clear();
  for (std::size_t s = 0; s < samples_.size(); ++s) {
    find_elements(s);
    if (elements_[s][0] == none) {  // outside the tissue nothing is remembered
      directions_[s] = {};
      withdrawn_[s] = 0;
      has_begun_[s] = 0;
      continue;
    }
    add_weights(elements_[s], samples_[s].at);
    find_tip(s);
    gripping_.push_back(s);
  }
  enter();
  moved_ = vertices_;
  sort_unique(moved_);
}

void CuttingEdges::place(std::span<const PlacedObstacle> obstacles) {
  for (Sample& sample : samples_) {
    const Pose &from = obstacles[sample.obstacle].start(), &to = obstacles[sample.obstacle].end();
    sample.start = from.place(sample.given);
    sample.end = to.place(sample.given);
    sample.tangent = to.direction(sample.given_tangent);
    sample.velocity = scaled(1 / dt_, minus(sample.end, sample.start));
  }
}

/// Mostly those of the last step; where a slit has opened beside the sample, the lips.
void CuttingEdges::find_elements(std::size_t s) {
  Sample& sample = samples_[s];
  const Vec3& start = sample.start;
  const Elements last = elements_[s];
  Elements& now = elements_[s];
  now.fill(none);
  sample.at.clear();
  const auto add = [&](Index element, const Vec3& at) {
    if (sample.at.size() == now.size()) return;
    now[sample.at.size()] = element;
    sample.at.push_back(at);
  };
  if (last[0] != none && last[1] == none) {
    const auto at = finder_.inside(last[0], start);
    if (at && std::ranges::all_of(*at, [](double c) { return std::abs(c) < 1; }) &&
        has_material(sample, last[0], *at))
      return add(last[0], *at);
  }
  finder_.any_around(start, [&](Index e, const Vec3& at) {
    if (has_material(sample, e, at)) add(e, at);
    return sample.at.size() == now.size();
  });
  if (now[0] != none) return;
  for (const Index e : last) {
    Vec3 at;
    if (e != none && is_between_lips(s, e, at)) add(e, at);
  }
}

bool CuttingEdges::has_material(const Sample& sample, Index element, const Vec3& at) const {
  return !divides(sample) || edges_[sample.edge].has_material(element, at);
}

/// Whether a sample in no element is beside this one, across the slit; `at`: the place there.
bool CuttingEdges::is_between_lips(std::size_t s, Index element, Vec3& at) const {
  const Sample& sample = samples_[s];
  if (directions_[s] == Vec3{} || !complex_.exists(3, element)) return false;
  const auto found = finder_.locate(element, sample.start);
  if (!found) return false;
  at = *found;
  for (double& c : at) c = std::clamp(c, -1.0, 1.0);
  const Vec3 away = minus(
      sample.start, place_in(complex_.vertices_of(element), at, attributes_.position().rows(), 4));
  const Vec3 normal = unit(cross(sample.tangent, directions_[s]));
  return norm(without_part_along(away, normal)) < beside_lips * edge_ &&
         std::abs(dot(away, normal)) < lips * edge_;
}

/// Their mean: on a face that they share, it is one place; between lips, both are pushed.
void CuttingEdges::add_weights(const Elements& elements, const std::vector<Vec3>& at) {
  const std::size_t first = vertices_.size();
  for (std::size_t i = 0; i < at.size(); ++i) {
    const std::array<double, 8> weights = trilinear_weights(at[i]);
    for (std::size_t n = 0; n < 8; ++n) {
      if (weights[n] == 0) continue;
      const Index v = complex_.vertices_of(elements[i])[n];
      const double weight = weights[n] / static_cast<double>(at.size());
      const auto known = std::find(vertices_.begin() + std::ptrdiff_t(first), vertices_.end(), v);
      if (known != vertices_.end()) {
        weights_[std::size_t(known - vertices_.begin())] += weight;
        continue;
      }
      vertices_.push_back(v);
      weights_.push_back(weight);
    }
  }
  first_.push_back(vertices_.size());
}

/// An element stays whole until the edge has passed it, and longer where the edge ends in it. What
/// is cut in it is known by where the samples have been, in the tissue at rest.
void CuttingEdges::find_tip(std::size_t s) {
  Sample& sample = samples_[s];
  if (!divides(sample)) return;
  const Index element = elements_[s][0];
  sample.rest = place_in(complex_.vertices_of(element), sample.at[0], attributes_.rest().rows(), 4);
  Tip& tip = tips_[s];
  if (!std::exchange(tip.has_moved, 0)) return;
  if (tip.element != none && tip.element != element && complex_.exists(3, tip.element)) {
    const Passed passed{static_cast<Index>(s), tip.element};
    const auto place = std::ranges::lower_bound(passed_, passed);
    if (place == passed_.end() || *place != passed) passed_.insert(place, passed);
  }
  const Vec3 way = minus(sample.rest, tip.at);
  if (norm(way) > rounding * edge_) tip.direction = unit(way);
  tip.at = sample.rest;
  tip.element = element;
}

bool CuttingEdges::has_passed(std::size_t s, Index element) const {
  if (std::ranges::binary_search(passed_, Passed{static_cast<Index>(s), element})) return true;
  const Vec3 way = minus(samples_[s].rest, tips_[s].at);
  return dot(way, tips_[s].direction) < -behind_tip * edge_ && norm(way) < near_tip * edge_;
}

/// Remembers the slits in elements as the first sample has found them: what the edge opens on its
/// way through an element does not help it there.
void CuttingEdges::enter() {
  std::vector<Index> elements;
  for (const std::size_t s : gripping_)
    for (const Index e : elements_[s])
      if (e != none) elements.push_back(e);
  sort_unique(elements);
  std::vector<Entered> now;
  for (const Index e : elements) {
    const auto known = std::ranges::lower_bound(entered_, e, {}, &Entered::element);
    const bool is_known = known != entered_.end() && known->element == e;
    now.push_back(is_known ? *known : Entered{e, open_sides(e)});
  }
  entered_ = std::move(now);
}

std::uint8_t CuttingEdges::open_sides(Index element) const {
  unsigned open = 0;
  for (const Dart side : sides_of(element))
    if (complex_.beta3(side) == none) open |= 1u << local_face(side);
  return static_cast<std::uint8_t>(open);
}

// --------------------------------------------------------------------- what resists --

void CuttingEdges::engage(double gain) {
  grips_.clear();
  for (std::size_t i = 0; i < gripping_.size(); ++i) {
    const std::size_t s = gripping_[i], first = first_[i], count = first_[i + 1] - first;
    Grip grip(s,
              {static_cast<Index>(s), std::span(vertices_).subspan(first, count),
               std::span(weights_).subspan(first, count)},
              attributes_);
    grip.tangent = samples_[s].tangent;
    grip.direction = directions_[s];
    if (grip.direction == Vec3{}) grip.direction = unit(gap(grip));
    for (std::size_t k = 0; k < samples_[s].at.size() && grip.limit == 0; ++k)
      if (resists(s, k, grip.direction)) grip.limit = toughness(s) * samples_[s].length * gain;
    grips_.push_back(grip);
  }
}

/// N/m
double CuttingEdges::toughness(std::size_t s) const {
  const Edge& edge = edges_[samples_[s].edge];
  double sum = 0, count = 0;
  for (const Index e : elements_[s])
    if (e != none) sum += edge.toughness[e], ++count;
  return has_begun_[s] != 0 ? sum / count : std::max(sum / count, edge.start);
}

/// An edge that advances in an element separates it from the neighbour on its side: not if it was
/// already open there, or if the surface of the body is there. One that divides elements opens
/// what is on both sides of it, or separates a side on which it lies.
bool CuttingEdges::resists(std::size_t s, std::size_t place, const Vec3& direction) const {
  const Sample& sample = samples_[s];
  const Index element = elements_[s][place];
  if (divides(sample) && (is_divided_[sample.edge][element] != 0 || has_passed(s, element)))
    return false;
  const double* x = attributes_.position().rows();
  const Hexahedron& nodes = complex_.vertices_of(element);
  const Vec3 centre = middle(nodes, x);
  Vec3 normal = unit(cross(sample.tangent, direction));
  if (dot(minus(sample.start, centre), normal) < 0) normal = scaled(-1, normal);
  std::size_t facing = 0;
  double most = -1;
  for (std::size_t f = 0; f < 6; ++f) {
    std::array<Index, 4> corners;
    for (std::size_t k = 0; k < 4; ++k) corners[k] = nodes[suture_hexahedron_faces[f][k]];
    const double towards = dot(unit(minus(middle(corners, x), centre)), normal);
    if (towards > most) most = towards, facing = f;
  }
  const auto entered = std::ranges::lower_bound(entered_, element, {}, &Entered::element);
  if ((entered->open >> facing & 1) == 0) return true;
  const CubeSide side = cube_sides[side_with_face(static_cast<unsigned>(facing))];
  return divides(sample) && std::abs(sample.at[place][side.axis] - side.place()) > on_side;
}

// ---------------------------------------------------------------------------- pushes --

/// What has come between the edge and the tissue, without the part along the edge.
Vec3 CuttingEdges::gap(const Grip& grip) const {
  const Vec3 tissue = grip.mass.point().sum(attributes_.position().rows());
  return without_part_along(minus(samples_[grip.sample].end, tissue), grip.tangent);
}

/// An edge pushes where it has reached the tip of the slit, and never pulls.
double CuttingEdges::sweep(double dt) {
  double largest = 0;
  for (Grip& grip : grips_) {
    if (grip.limit == 0) continue;
    const Vec3 missing = minus(gap(grip), scaled(withdrawn_[grip.sample], grip.direction));
    const Vec3 last = grip.change;
    grip.change = plus(last, scaled(1 / dt, missing));
    if (dot(grip.change, grip.direction) <= 0) grip.change = {};
    if (const double size = norm(grip.impulse()); size > grip.limit)
      grip.change = scaled(grip.limit / size, grip.change);
    const Vec3 by = minus(grip.change, last);
    if (by != Vec3{}) grip.mass.change(by, dt);
    largest = std::max(largest, norm(by));
  }
  return largest;
}

void CuttingEdges::release(std::span<const PlacedObstacle> obstacles) {
  place(obstacles);
  for (Grip& grip : grips_) {
    grip.tangent = samples_[grip.sample].tangent;
    grip.change = {};
  }
}

/// Below its limit, an edge takes the tissue along.
bool CuttingEdges::holds(const Grip& grip) const {
  return grip.change != Vec3{} && norm(grip.impulse()) < (1 - rounding) * grip.limit;
}

/// Samples share the nodes of their elements. With s_i, how far all that hold move the tissue at
/// one of them if each changes its velocity by 1, and t and u along the edge and its push,
///   holds: (1 - t t^T) / s_i,   s_i = sum_n w_in / m_n sum_j w_jn m_j
///   cuts:  |dv| / (|g| / h + |dv|) (1 - t t^T - u u^T)
/// The first is exact where all change equally.
void CuttingEdges::add_pushed_by(std::size_t obstacle, std::vector<Tool::Pushed>& pushed) const {
  const auto for_each_node = [&](const Grip& grip, auto visit) {
    const ContactPoint& point = grip.mass.point();
    for (std::size_t n = 0; n < point.vertices.size(); ++n) {
      const auto at = std::ranges::lower_bound(moved_, point.vertices[n]) - moved_.begin();
      visit(std::size_t(at), point.weights[n]);
    }
  };
  std::vector<double> moved(moved_.size());
  for (const Grip& grip : grips_)
    if (holds(grip))
      for_each_node(grip, [&](std::size_t n, double w) { moved[n] += w * grip.mass.mass()[0]; });
  const double* mass = attributes_.mass().rows();
  for (const Grip& grip : grips_) {
    if (grip.change == Vec3{} || this->obstacle(grip) != obstacle) continue;
    double factor = 0;
    std::array<Vec3, 3> response = no_rotation;
    const auto remove = [&](const Vec3& unit) {
      for (std::size_t c = 0; c < 3; ++c) response[c] = minus(response[c], scaled(unit[c], unit));
    };
    remove(grip.tangent);
    if (holds(grip)) {
      for_each_node(grip,
                    [&](std::size_t n, double w) { factor += w * moved[n] / mass[moved_[n]]; });
      factor = 1 / factor;
    } else {
      const double change = norm(grip.change);
      remove(scaled(1 / change, grip.change));
      factor = change / (norm(gap(grip)) / dt_ + change);
    }
    for (Vec3& row : response) row = scaled(factor, row);
    pushed.push_back(
        {grip.mass.point().sum(attributes_.position().rows()), grip.mass.mass()[0], response});
  }
}

void CuttingEdges::finish() {
  for (const Grip& grip : grips_) {
    const std::size_t s = grip.sample;
    const Vec3 came = gap(grip);
    const double ahead = dot(came, grip.direction);
    const double aside = norm(minus(came, scaled(ahead, grip.direction)));
    directions_[s] = grip.direction;
    if (grip.change != Vec3{}) {
      withdrawn_[s] = 0;
      if (norm(grip.impulse()) < (1 - rounding) * grip.limit) continue;  // it holds
      directions_[s] = unit(grip.change);
      has_begun_[s] = tips_[s].has_moved = 1;
      continue;
    }
    withdrawn_[s] -= ahead;
    const bool is_elsewhere = aside > std::abs(ahead) || withdrawn_[s] > edge_;
    if (grip.limit > 0 && !is_elsewhere) continue;
    directions_[s] = {};
    withdrawn_[s] = 0;
  }
}

// ---------------------------------------------------------------- operations and state --

void CuttingEdges::divided(std::size_t edge, Index first) {
  std::fill(is_divided_[edge].begin() + std::ptrdiff_t{first}, is_divided_[edge].end(), 1);
}

void CuttingEdges::follow(const TopologyChange& change) {
  for (std::size_t i = 0; i < edges_.size(); ++i)
    for (const Split& copy : change.copies) {
      edges_[i].toughness.push_back(double{edges_[i].toughness[copy.old_cell]});
      is_divided_[i].push_back(std::uint8_t{is_divided_[i][copy.old_cell]});
    }
  for (std::vector<std::uint8_t>& is_divided : is_divided_)
    for (const Split& sewn : change.absorbed) is_divided[sewn.new_cell] = 0;
  std::erase_if(passed_, [&](const Passed& p) { return !complex_.exists(3, p.element); });
  if (change.faces_sewn == 0 && change.removed[3].empty()) return;
  finder_.follow(change);
  entered_.clear();  // with other sides
}

void CuttingEdges::state(Archive& archive) {
  archive("elements", elements_);
  archive("directions", directions_);
  archive("withdrawn", withdrawn_);
  archive("begun", has_begun_);
  const bool has_copies = attributes_.parts().may_grow();
  for (std::size_t i = 0; i < edges_.size() && has_copies; ++i) {
    archive(("toughness " + std::to_string(i)).c_str(), edges_[i].toughness);
    archive(("divided " + std::to_string(i)).c_str(), is_divided_[i]);
  }
  archive.member("tips", tips_, &Tip::at);
  archive.member("tip directions", tips_, &Tip::direction);
  archive.member("tip elements", tips_, &Tip::element);
  archive.member("moved tips", tips_, &Tip::has_moved);
  archive.rows<Index>("passed", passed_);
  archive.member("entered", entered_, &Entered::element);
  archive.member("open", entered_, &Entered::open);
  if (archive.loads()) finder_.forget();
}

}  // namespace suture
