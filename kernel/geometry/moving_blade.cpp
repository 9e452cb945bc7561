// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/moving_blade.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/base/archive.hpp"
#include "kernel/base/error.hpp"
#include "kernel/geometry/geometry_module.hpp"

namespace suture {
namespace {

bool finite(const BladeKey& key) {
  bool good = std::isfinite(key.time);
  for (const Vec3& p : key.points) good = good && std::isfinite(p[0] + p[1] + p[2]);
  return good;
}

void check_key(const std::vector<BladeKey>& keys, std::size_t i) {
  const BladeKey& key = keys[i];
  const std::string name = "station " + std::to_string(i) + " of the moving blade";
  if (!finite(key)) throw InputError(name + " has a time or a point that is not finite");
  if (key.points.size() < 2)
    throw InputError(name + " has " + std::to_string(key.points.size()) +
                     " points; a blade needs at least 2");
  if (key.points.size() != keys[0].points.size())
    throw InputError(name + " has " + std::to_string(key.points.size()) +
                     " points, the first has " + std::to_string(keys[0].points.size()) +
                     "; all stations need the same number");
  if (i > 0 && !(key.time > keys[i - 1].time))
    throw InputError(name + " has a time that is not later than the previous one");
  if (std::ranges::all_of(key.points, [&](const Vec3& p) { return p == key.points[0]; }))
    throw InputError(name + " has coincident points; a blade must have a positive length");
}

Vec3 between(const Vec3& a, const Vec3& b, double t) {
  Vec3 p;
  for (int i = 0; i < 3; ++i) p[i] = t == 0 ? a[i] : t == 1 ? b[i] : a[i] + t * (b[i] - a[i]);
  return p;
}

void add(Box& box, const std::vector<Vec3>& points) {
  for (const Vec3& p : points) include(box, p);
}

double distance(const Vec3& a, const Vec3& b) {
  const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
  return std::sqrt(x * x + y * y + z * z);
}

/// From p to the segment from a to b.
double distance(const Vec3& p, const Vec3& a, const Vec3& b) {
  double along = 0, length2 = 0;
  for (int i = 0; i < 3; ++i) {
    along += (p[i] - a[i]) * (b[i] - a[i]);
    length2 += (b[i] - a[i]) * (b[i] - a[i]);
  }
  return distance(p, between(a, b, length2 > 0 ? std::clamp(along / length2, 0.0, 1.0) : 0));
}

/// One bit for each side of the box beyond which the point lies.
unsigned outcode(const Box& box, const Row4& p) {
  unsigned code = 0;
  for (int a = 0; a < 3; ++a)
    code |= unsigned(p[a] < box.low[a]) << 2 * a | unsigned(p[a] > box.high[a]) << (2 * a + 1);
  return code;
}

/// The map F of the class's description, about the middles of the link.
class Frame {
 public:
  Frame(const Segment& from, const Segment& to) {
    for (int i = 0; i < 3; ++i) {
      middle_[i] = (from.a[i] + from.b[i]) / 2;
      along_[i] = from.b[i] - from.a[i];
      turn_[i] = (to.b[i] - to.a[i]) - along_[i];
      shift_[i] = (to.a[i] + to.b[i]) / 2 - middle_[i];
    }
    size2_ = along_[0] * along_[0] + along_[1] * along_[1] + along_[2] * along_[2];
  }
  Vec3 operator()(const Vec3& p) const {
    double share = 0;
    for (int i = 0; i < 3; ++i) share += along_[i] * (p[i] - middle_[i]);
    share = size2_ > 0 ? share / size2_ : 0;
    Vec3 q;
    for (int i = 0; i < 3; ++i) q[i] = p[i] + (shift_[i] + turn_[i] * share);
    return q;
  }

 private:
  Vec3 middle_, along_, turn_, shift_;
  double size2_;
};

Segment between(const Segment& a, const Segment& b, double t) {
  return {between(a.a, b.a, t), between(a.b, b.b, t)};
}

/// Whether the link crosses what the polyline sweeps from `from` to `to`.
bool crosses_sweep(const Segment& link0, const Segment& link, const std::vector<Vec3>& from,
                   const std::vector<Vec3>& to) {
  const GeometryModule& geometry = geometry_module();
  const Frame frame(link0, link);
  Vec3 p0 = frame(from[0]);
  for (std::size_t i = 0; i + 1 < from.size(); ++i) {
    const Vec3 q0 = frame(from[i + 1]);
    if (geometry.crosses({p0, q0, to[i + 1]}, link) ||
        geometry.crosses({p0, to[i + 1], to[i]}, link))
      return true;
    p0 = q0;
  }
  return false;
}

}  // namespace

/// What the blade does in one call of advance().
struct MovingBlade::Step {
  std::vector<BladeKey> path;  ///< times as shares of the step, 0 .. 1
  Box box;
  double moved = 0;  ///< m, the farthest of its points
  double size = 0;   ///< m, the largest coordinate
};

/// An element in a step.
struct ElementWay {
  Row4 before, now;  ///< centroids
  unsigned outside;  ///< sides of the blade's box beyond which both are

  ElementWay(const CellComplex& complex, const TissueBlocks& tissue, const Box& box, Index element)
      : before(centroid_of(complex.vertices_of(element), tissue.before())),
        now(centroid_of(complex.vertices_of(element), tissue.now())),
        outside(outcode(box, before) & outcode(box, now)) {}
};

MovingBlade::MovingBlade(std::vector<BladeKey> keys, Scope scope)
    : keys_(std::move(keys)), scope_(scope) {
  if (keys_.empty()) throw InputError("the moving blade has no station; at least one is needed");
  for (std::size_t i = 0; i < keys_.size(); ++i) check_key(keys_, i);
}

MovingBlade MovingBlade::carried(std::vector<Vec3> points, Scope scope) {
  MovingBlade blade({{0, std::move(points)}}, scope);
  blade.is_carried_ = true;
  return blade;
}

double MovingBlade::end() const {
  return keys_.size() == 1 ? std::numeric_limits<double>::infinity() : keys_.back().time;
}

std::vector<Vec3> MovingBlade::at(double time) const {
  const auto next = std::ranges::upper_bound(keys_, time, {}, &BladeKey::time);
  if (next == keys_.begin()) return keys_.front().points;
  if (next == keys_.end()) return keys_.back().points;
  const auto last = next - 1;
  const double t = (time - last->time) / (next->time - last->time);
  std::vector<Vec3> points(last->points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = between(last->points[i], next->points[i], t);
  return points;
}

Box MovingBlade::box() const {
  Box box = swept_;
  for (const BladeKey& key : keys_) add(box, key.points);
  return box;
}

void MovingBlade::carry_to(double time, std::vector<Vec3> points) {
  swept_ = box();
  if (started_ && time > time_)
    keys_ = {{time_, std::move(keys_.back().points)}, {time, std::move(points)}};
  else
    keys_ = {{time, std::move(points)}};
}

void MovingBlade::reset() {
  started_ = false;
  tissue_.clear();
  clearances_.clear();
}

void MovingBlade::state(Archive& archive) {
  if (!archive.has_cells()) return;
  archive("started", started_);
  archive("time", time_);
  if (is_carried_) {
    archive.rows<double>("points", keys_.back().points);
    if (archive.loads()) keys_ = {{time_, std::move(keys_.back().points)}};
  }
  archive("tissue", tissue_);
  archive("step", step_);
  archive.rows<std::uint64_t>("clearances", clearances_);  // bits
  archive("gaps", gaps_);
}

std::vector<BladeKey> MovingBlade::path(double from, double to) const {
  std::vector<BladeKey> places{{from, at(from)}};
  for (const BladeKey& key : keys_)
    if (key.time > from && key.time < to) places.push_back(key);
  places.push_back({to, at(to)});
  return places;
}

std::vector<Dart> MovingBlade::advance(const CellComplex& complex, const Places& places,
                                       double time, const Workers* workers) {
  if (started_ && time < time_) throw InputError("the time of the moving blade must not decrease");
  const double last = time_;
  const bool first = !started_;
  started_ = true;
  time_ = time;
  if (time < begin() || (!first && last >= end())) return {};
  step_ += tissue_.move(complex, places, workers) ? 1 : 2;  // 2: what moved is not known
  std::vector<Dart> faces;
  if (first || !(time > last)) return faces;
  const Step step = step_between(last);
  const std::vector<Index> elements = elements_to_check(complex, step);
  std::vector<std::vector<Dart>> cut(elements.size() / chunk_size + 1);
  std::vector<CheckResult> found(elements.size());
  for_chunks(elements.size(), chunk_size, workers,
             [&](std::size_t first_one, std::size_t end, std::size_t c) {
               for (std::size_t i = first_one; i < end; ++i)
                 found[i] = check(complex, step, elements[i], cut[c]);
             });
  for (std::size_t i = 0; i < elements.size(); ++i) record(elements[i], found[i]);
  for (const auto& part : cut) faces.insert(faces.end(), part.begin(), part.end());
  return faces;
}

MovingBlade::Step MovingBlade::step_between(double last) const {
  Step step{path(std::max(last, begin()), std::min(time_, end())), {}};
  step.box = no_box;
  for (std::size_t i = 0; i < step.path.size(); ++i) {
    BladeKey& key = step.path[i];
    add(step.box, key.points);
    key.time = (key.time - last) / (time_ - last);
    double farthest = 0;
    for (std::size_t p = 0; p < key.points.size() && i > 0; ++p)
      farthest = std::max(farthest, distance(key.points[p], step.path[i - 1].points[p]));
    step.moved += farthest;
  }
  for (std::size_t a = 0; a < 3; ++a)
    step.size = std::max({step.size, std::abs(step.box.low[a]), std::abs(step.box.high[a])});
  return step;
}

/// Counts the step for a block. False if all of it must be checked; otherwise only elements whose
/// gaps_ are not above `needed`.
bool MovingBlade::may_skip(Index block, const Step& step, double& needed) {
  Clearance& c = clearances_[block];
  const bool known = scope_ == Scope::near && c.step + 1 == step_;  // followed up to now
  const double tissue = known ? tissue_.moved(block) : 0;
  c.step = step_;
  c.tissue += tissue;
  c.moved += tissue + step.moved;
  const double shortest = c.shortest - 2 * c.tissue;
  if (known && shortest > 0) {
    const double seen = tissue + 2 * tissue * (c.reach + c.moved) / shortest;
    needed = c.moved + seen + 1e-12 * (step.size + c.reach);
    return true;
  }
  c = {0, std::numeric_limits<double>::infinity(), 0, 0, step_};
  return false;
}

std::vector<Index> MovingBlade::elements_to_check(const CellComplex& complex, const Step& step) {
  clearances_.resize(tissue_.block_count());
  gaps_.resize(complex.element_count());
  std::vector<Index> elements;
  for (const Index block : scope_ == Scope::near ? tissue_.near(step.box) : tissue_.all()) {
    double needed = std::numeric_limits<double>::infinity();
    const bool some = may_skip(block, step, needed);
    const Index first = block * TissueBlocks::size;
    const Index last = std::min(first + TissueBlocks::size, complex.element_count());
    for (Index e = first; e < last; ++e)
      if (!(some && gaps_[e] > needed) && complex.exists(3, e)) elements.push_back(e);
  }
  return elements;
}

// A link is near if no side of the blade's box has both elements beyond it all the time.
MovingBlade::CheckResult MovingBlade::check(const CellComplex& complex, const Step& step,
                                            Index element, std::vector<Dart>& cut) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const ElementWay one(complex, tissue_, step.box, element);
  double longest = 0;
  CheckResult found{infinity, 0, infinity};
  for (int f = 0; f < hexahedron::faces; ++f) {
    const Index n = complex.neighbour(element, f);
    if (n == none || n < element) continue;
    const ElementWay other(complex, tissue_, step.box, n);
    const double length = distance(xyz(one.now), xyz(other.now));
    longest = std::max(longest, length);
    found.shortest = std::min(found.shortest, length);
    if ((one.outside & other.outside) != 0) continue;
    const Segment from{xyz(one.before), xyz(other.before)};
    const Segment to{xyz(one.now), xyz(other.now)};
    for (std::size_t i = 0; i + 1 < step.path.size(); ++i) {
      const BladeKey &p = step.path[i], &q = step.path[i + 1];
      if (!crosses_sweep(between(from, to, p.time), between(from, to, q.time), p.points, q.points))
        continue;
      cut.push_back(face_dart(element, f));
      break;
    }
  }
  const std::vector<Vec3>& blade = step.path.back().points;
  for (std::size_t i = 0; i < blade.size(); ++i) {
    found.reach = std::max(found.reach, distance(xyz(one.now), blade[i]) + longest);
    if (i > 0)
      found.gap = std::min(found.gap, distance(xyz(one.now), blade[i - 1], blade[i]) - longest);
  }
  return found;
}

void MovingBlade::record(Index element, const CheckResult& found) {
  Clearance& c = clearances_[element / TissueBlocks::size];
  c.reach = std::max(c.reach, found.reach);
  c.shortest = std::min(c.shortest, found.shortest + 2 * c.tissue);
  gaps_[element] = found.gap + c.moved;
}

}  // namespace suture
