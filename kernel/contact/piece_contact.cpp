// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/piece_contact.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <string>
#include <utility>

#include "kernel/base/rows.hpp"

namespace suture {
namespace {

// In typical edges: how far a vertex may be in front of a face that it may yet be pushed into, and
// how far beside its rim.
constexpr double margin = 0.1, beside = 0.05;
// Errors of gaps, in typical edges; the second one also of those that do not move.
constexpr double precision = 1e-4, rounding_of_gaps = 1e-9;
// The part of the change of gaps in the first sweep. Forces that lag behind the motion by a step
// feed its fast modes, and a pile would never come to rest.
constexpr double lag = 0.3;
// What a sweep leaves as it is, as a part of the precision.
constexpr double negligible = 0.1;
constexpr double same_side = 0.2;  // cosine of an angle at which surfaces look the same way
// A distance in typical edges, and the cosine of an angle between faces.
constexpr double near_enough = 0.02, alike = 0.95;
// Sine of an angle by which the direction in which edges touch may lean towards one of their faces.
constexpr double leaning = 0.1;
// Relative to that without constraints; what hardly yields would need impulses without bound.
constexpr double least_mobility = 1e-3;
// The part of an earlier depth that a step takes back, at most `max_recovery` edges. Edges that
// slide across each other are found deep at once: pushed apart as fast as faces, they keep a pile
// moving.
constexpr double recovered = 0.2, max_recovery = 0.02, max_recovery_of_edges = 0.002;
// Contact has failed where things are in each other by so much; of an edge.
constexpr double alarming = 0.08;

constexpr char held = 7;  // all components

Vec3 free_part(Vec3 a, char fixed) {
  if (fixed == 0) return a;
  for (int c = 0; c < 3; ++c)
    if (fixed >> c & 1) a[static_cast<std::size_t>(c)] = 0;
  return a;
}

Vec3 sum_over(const PieceContact::Touch& touch, const double* rows) {
  Vec3 total{};
  for (std::size_t i = 0; i < 5; ++i)
    total = plus(total, scaled(touch.weights[i], row(rows, touch.vertices[i])));
  return total;
}

bool is_before(const PieceContact::Touch& a, const PieceContact::Touch& b) {
  return is_found_before(a.vertices, b.vertices);
}

}  // namespace

PieceContact::PieceContact(const CellComplex& complex, const BoundarySurface& surface,
                           Attributes& attributes, const Options& options, double edge)
    : complex_(complex),
      attributes_(attributes),
      options_(options),
      edge_(edge),
      lists_(complex, surface, attributes, options.self, edge, max_depth) {}

// ------------------------------------------------------------------- contacts --

/// Planes of near faces, and the sums of their area vectors around the near vertices.
void PieceContact::find_faces() {
  find_planes(ends_.data(), lists_.faces(), max_depth * edge_, beside * edge_, faces_, areas_);
  normals_.assign(lists_.vertices().size(), {});
  for (Index face = 0; face < faces_.size(); ++face)
    for (const Index v : lists_.faces()[face]) normals_[v] = plus(normals_[v], areas_[face]);
}

/// The near pairs that may touch: the face looks at the vertex, which is neither too far in front
/// of it or behind it nor beside it.
void PieceContact::find_candidates() {
  candidates_.resize(lists_.pairs().size());
  std::size_t count = 0;
  Index vertex = none;
  Vec3 place{}, normal{};
  double same = 0;
  for (const NearPair& pair : lists_.pairs()) {
    if (pair.vertex != vertex) {
      vertex = pair.vertex;
      place = row(ends_.data(), vertex);
      normal = normals_[vertex];
      same = same_side * norm(normal);
    }
    const FacePlane& face = faces_[pair.face];
    const Vec3 arm = minus(place, face.centre);
    const bool looks_at = dot(normal, face.normal) <= same;
    const double height = dot(arm, face.normal);
    const bool is_low = height <= face.height + margin * edge_;
    const bool is_high = height >= -face.height - max_depth * edge_;
    const bool is_within = dot(arm, arm) - height * height <= face.reach;
    candidates_[count] = pair;
    count += looks_at & is_low & is_high & is_within;
  }
  candidates_.resize(count);
}

void PieceContact::begin(double dt, double gain, const LiveMask& moving) {
  const double ratio = gain_ > 0 ? gain / gain_ : 0;
  dt_ = dt;
  gain_ = gain;
  moving_ = &moving;
  precision_ = 0;
  std::swap(touches_, last_);
  touches_.clear();
  for (Touch& touch : last_) {
    touch.impulse *= ratio;
    touch.friction = scaled(ratio, touch.friction);
  }
  move_by_last_forces();
  lists_.update(attributes_.position().rows(), moving);
  find_touches();
  take_back();
  sweeps_.begin(touches_);
}

/// Moves the ends of the step to where the forces of the last one take them: at rest, to where the
/// step ends. Where it ends without them depends on the step and its damping.
void PieceContact::move_by_last_forces() {
  double *x = attributes_.position().rows(), *v = attributes_.velocity().rows();
  for (const Touch& touch : last_) {
    if (touch.impulse == 0) continue;
    const Vec3 impulse = plus(scaled(touch.impulse, touch.normal), touch.friction);
    for (std::size_t i = 0; i < 5; ++i) {
      const Index vertex = touch.vertices[i];
      const double response = touch.weights[i] / attributes_.mass().rows()[vertex];
      const Vec3 kick = free_part(scaled(response, impulse), fixed_components(vertex));
      free_.push_back({vertex, row(x, vertex), row(v, vertex)});
      add_to_row(v, vertex, kick);
      add_to_row(x, vertex, scaled(dt_, kick));
    }
  }
}

/// To the bit.
void PieceContact::take_back() {
  for (; !free_.empty(); free_.pop_back()) {
    const FreeEnd& end = free_.back();
    const std::size_t at = 4 * std::size_t{end.vertex};
    std::ranges::copy(end.position, attributes_.position().rows() + at);
    std::ranges::copy(end.velocity, attributes_.velocity().rows() + at);
  }
}

void PieceContact::find_touches() {
  const std::span<const Index> vertices = lists_.vertices();
  ends_.resize(4 * vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t c = 0; c < 4; ++c)
      ends_[4 * i + c] = attributes_.position().rows()[4 * std::size_t{vertices[i]} + c];
  find_faces();
  find_candidates();
  find_feet(ends_.data(), lists_.faces(), candidates_, feet_);
  for (std::size_t first = 0; first < candidates_.size();) {
    std::size_t last = first + 1;
    while (last < candidates_.size() && candidates_[last].vertex == candidates_[first].vertex)
      ++last;
    add_nearest(std::span(candidates_).subspan(first, last - first),
                std::span(feet_).subspan(first, last - first));
    first = last;
  }
  for (const NearEdges& pair : lists_.edge_pairs()) add_crossing(pair);
}

void PieceContact::apply_last_forces() {
  std::size_t candidate = 0;
  for (Touch& touch : touches_) {
    while (candidate < last_.size() && is_before(last_[candidate], touch)) ++candidate;
    for (std::size_t i = candidate; i < last_.size() && !is_before(touch, last_[i]); ++i) {
      if (last_[i].impulse == 0 || dot(last_[i].normal, touch.normal) < alike) continue;
      touch.impulse = last_[i].impulse;
      const Vec3& friction = last_[i].friction;
      touch.friction = minus(friction, scaled(dot(friction, touch.normal), touch.normal));
      sweeps_.apply(touch, plus(scaled(touch.impulse, touch.normal), touch.friction),
                    attributes_.velocity().rows());
      last_[i].impulse = 0;
      break;
    }
  }
}

void PieceContact::find_nearest(std::span<const NearPair> of_vertex,
                                std::span<const FaceFoot> feet) {
  nearest_.clear();
  for (std::size_t i = 0; i < feet.size(); ++i) {
    if (feet[i].beside > beside * edge_ || feet[i].distance > max_depth * edge_) continue;
    const Index face = of_vertex[i].face;
    const Index piece = lists_.piece_of_face(face);
    if (!is_settled(piece, faces_[face].normal)) add({piece, face, feet[i], faces_[face].centre});
  }
}

/// The vertex is so near to a face that others like it make no difference.
bool PieceContact::is_settled(Index piece, const Vec3& face_normal) const {
  return std::ranges::any_of(nearest_, [&](const Found& found) {
    return found.piece == piece && found.foot.distance < near_enough * edge_ &&
           dot(found.foot.normal, face_normal) > alike;
  });
}

bool PieceContact::Found::faces(const Found& other) const {
  const Vec3 way = minus(other.centre, centre);
  const double least = same_side * norm(way);
  return dot(foot.normal, way) > least && dot(other.foot.normal, way) < -least;
}

void PieceContact::add(const Found& found) {
  const auto known = std::ranges::find_if(nearest_, [&](const Found& other) {
    return other.piece == found.piece && !other.faces(found);
  });
  if (known == nearest_.end())
    nearest_.push_back(found);
  else if (found.foot.distance < known->foot.distance)
    *known = found;
}

void PieceContact::add_nearest(std::span<const NearPair> of_vertex,
                               std::span<const FaceFoot> feet) {
  find_nearest(of_vertex, feet);
  for (const Found& found : nearest_) {
    if (found.foot.gap >= margin * edge_) continue;
    const BoundarySurface::Corners& c = lists_.faces()[found.face];
    const std::array<double, 4> w = Patch::weights_at(found.foot.r, found.foot.s);
    touches_.push_back(touch_of({of_vertex.front().vertex, c[0], c[1], c[2], c[3]},
                                {1, -w[0], -w[1], -w[2], -w[3]}, found.foot.normal,
                                found.foot.gap));
  }
}

/// Edges touch in the direction n at right angles to both if it leads out of the second one and
/// into the first one between their faces. Where it leads along a face, too: edges of blocks that
/// lie across each other are parallel to the faces beside them.
void PieceContact::add_crossing(const NearEdges& pair) {
  const FeatureEdge &a = lists_.edges()[pair.first], &b = lists_.edges()[pair.second];
  const double* x = ends_.data();
  Crossing crossing;
  if (!find_crossing({row(x, a.ends[0]), row(x, a.ends[1])}, {row(x, b.ends[0]), row(x, b.ends[1])},
                     crossing))
    return;
  const double s = crossing.first, t = crossing.second;
  if (std::min({s, t, 1 - s, 1 - t}) < -beside) return;
  const Vec3 outward = plus(faces_[b.faces[0]].normal, faces_[b.faces[1]].normal);
  const Vec3 normal = scaled(dot(crossing.across, outward) < 0 ? -1 : 1, crossing.across);
  const double gap = dot(crossing.offset, normal);
  if (gap >= margin * edge_ || gap < -max_depth * edge_) return;
  if (!may_leave(b, normal) || !may_leave(a, scaled(-1, normal))) return;
  touches_.push_back(touch_of({a.ends[0], a.ends[1], b.ends[0], b.ends[1], b.ends[1]},
                              {1 - s, s, t - 1, -t, 0}, normal, gap));
}

/// A direction at right angles to an edge points into none of its faces.
bool PieceContact::may_leave(const FeatureEdge& edge, const Vec3& direction) const {
  const double* x = ends_.data();
  const Vec3 along = minus(row(x, edge.ends[1]), row(x, edge.ends[0]));
  const double most = leaning * norm(along);
  const Vec3 into_first = cross(faces_[edge.faces[0]].normal, along);
  const Vec3 into_second = cross(along, faces_[edge.faces[1]].normal);
  return dot(direction, into_first) < most && dot(direction, into_second) < most;
}

PieceContact::Touch PieceContact::touch_of(const std::array<Index, 5>& places,
                                           const std::array<double, 5>& weights, const Vec3& normal,
                                           double end) const {
  Touch touch;  // not {}: clearing it all takes as long as the rest
  touch.weights = weights;
  touch.normal = normal;
  double mobility = 0, unconstrained = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    const Index v = touch.vertices[i] = lists_.vertices()[places[i]];
    touch.response[i] = weights[i] / attributes_.mass().rows()[v];
    touch.fixed[i] = fixed_components(v);
    const double part = weights[i] * touch.response[i];
    mobility += part * dot(normal, free_part(normal, touch.fixed[i]));
    unconstrained += part;
  }
  touch.mass = mobility > least_mobility * unconstrained ? 1 / mobility : 0;
  const double speed = dot(normal, sum_over(touch, attributes_.velocity().rows()));
  const double before = touch.before = end - dt_ * speed;
  const double most = edge_ * (is_between_edges(places) ? max_recovery_of_edges : max_recovery);
  const double target = before < 0 ? before + std::min(-recovered * before, most) : 0;
  touch.speed = speed + (target - end) / dt_;
  return touch;
}

bool PieceContact::sweep() {
  const double change = sweeps_.sweep(touches_, attributes_.velocity().rows(), options_.friction,
                                      dt_, negligible * precision_);
  if (precision_ == 0)
    precision_ = std::max(rounding_of_gaps * edge_, std::min(precision * edge_, lag * change));
  return change > precision_;
}

double PieceContact::depth(const Touch& touch) const {
  return -dot(touch.normal, sum_over(touch, attributes_.position().rows()));
}

const PieceContact::Touch* PieceContact::too_deep() const {
  const Touch* deepest = nullptr;
  double most = alarming * edge_;
  for (const Touch& touch : touches_) {
    const double here = depth(touch);
    if (here <= most || here <= -touch.before) continue;
    most = here;
    deepest = &touch;
  }
  return deepest;
}

// ------------------------------------------------------------------- sleepers --

void PieceContact::change_sleepers(const LiveMask& moving) {
  moving_ = &moving;
  lists_.discard();
  const auto sleeps = [&](const Touch& touch) {
    return !moving[touch.vertices[0]] && !moving[touch.vertices[4]];
  };
  std::vector<Touch> woken;
  std::ranges::copy_if(asleep_, std::back_inserter(woken), std::not_fn(sleeps));
  std::erase_if(asleep_, std::not_fn(sleeps));
  for (Touch touch : touches_) {
    if (!sleeps(touch) || touch.impulse == 0) continue;
    touch.impulse /= gain_;
    touch.friction = scaled(1 / gain_, touch.friction);
    asleep_.push_back(touch);
  }
  std::erase_if(touches_, sleeps);
  wake(woken);
}

/// In the order in which contacts are found, as the next step expects those of the last.
void PieceContact::wake(std::vector<Touch>& woken) {
  for (Touch& touch : woken) {
    touch.impulse *= gain_;
    touch.friction = scaled(gain_, touch.friction);
    touches_.push_back(touch);
  }
  std::ranges::stable_sort(touches_, is_before);
}

/// All of a sleeper.
char PieceContact::fixed_components(Index vertex) const {
  return (*moving_)[vertex] ? static_cast<char>(attributes_.fixed().rows()[vertex]) : held;
}

double PieceContact::coming_impulse(const Touch& touch) const {
  const double gap = -depth(touch);
  const double speed = dot(touch.normal, sum_over(touch, attributes_.velocity().rows()));
  return touch.impulse + touch.mass * std::max(0.0, -gap / dt_ - speed);
}

// ---------------------------------------------------------- operations and state --

/// Everything is awake now.
void PieceContact::follow(const TopologyChange& change) {
  wake(asleep_);
  asleep_.clear();
  lists_.follow(change);
  std::erase_if(touches_, [&](const Touch& touch) {
    return !std::ranges::all_of(touch.vertices, [&](Index v) { return complex_.exists(0, v); });
  });
}

void PieceContact::state(Archive& archive) {
  lists_.state(archive);
  archive("gain", gain_);
  const auto add_all = [&](const std::string& which, std::vector<Touch>& of) {
    const auto member = [&](const char* name, auto of_touch) {
      archive.member((name + which).c_str(), of, of_touch);
    };
    member("touching", &Touch::vertices);
    member("weights", &Touch::weights);
    member("normals", &Touch::normal);
    member("impulses", &Touch::impulse);
    member("frictions", &Touch::friction);
  };
  add_all("", touches_);
  add_all(" asleep", asleep_);
}

}  // namespace suture
