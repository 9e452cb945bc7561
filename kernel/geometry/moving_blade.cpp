// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/moving_blade.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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
                     " points; a blade is a segment or polyline of at least 2");
  if (key.points.size() != keys[0].points.size())
    throw InputError(name + " has " + std::to_string(key.points.size()) + " points, the first " +
                     std::to_string(keys[0].points.size()) + "; all need the same number");
  if (i > 0 && !(key.time > keys[i - 1].time))
    throw InputError(name + " has a time that is not after the one before it");
  if (std::ranges::all_of(key.points, [&](const Vec3& p) { return p == key.points[0]; }))
    throw InputError(name + " has all points at one place; a blade needs a length");
}

Vec3 between(const Vec3& a, const Vec3& b, double t) {
  Vec3 p;
  for (int i = 0; i < 3; ++i) p[i] = t == 0 ? a[i] : t == 1 ? b[i] : a[i] + t * (b[i] - a[i]);
  return p;
}

void add(Box& box, const std::vector<Vec3>& points) {
  const Box other = box_of(points);
  for (int a = 0; a < 3; ++a) {
    box.low[a] = std::min(box.low[a], other.low[a]);
    box.high[a] = std::max(box.high[a], other.high[a]);
  }
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
  Frame(const Link& from, const Link& to) {
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

Link between(const Link& a, const Link& b, double t) {
  return {between(a.a, b.a, t), between(a.b, b.b, t)};
}

/// Whether the link crosses what the polyline sweeps from `from` to `to`.
bool crosses_sweep(const Link& link0, const Link& link, const std::vector<Vec3>& from,
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

/// What one call of advance() looks at.
struct MovingBlade::Step {
  std::vector<BladeKey> path;  ///< times as shares of the step, 0 .. 1
  Box box;
  std::vector<Index> blocks;  ///< of elements to look at, ascending
  std::vector<Index> slot;    ///< per block of the tissue: which of `blocks`, or none

  /// Where an element's place in ends_ is, or none.
  Index place(Index element) const {
    const Index block = slot[element / TissueBlocks::size];
    return block == none ? none : block * TissueBlocks::size + element % TissueBlocks::size;
  }
};

MovingBlade::MovingBlade(std::vector<BladeKey> keys, Look look)
    : keys_(std::move(keys)), look_(look) {
  if (keys_.empty()) throw InputError("the moving blade has no key; one or more are needed");
  for (std::size_t i = 0; i < keys_.size(); ++i) check_key(keys_, i);
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
  Box box = box_of(keys_.front().points);
  for (const BladeKey& key : keys_) add(box, key.points);
  return box;
}

void MovingBlade::reset() {
  started_ = false;
  tissue_.clear();
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
  if (started_ && time < time_)
    throw InputError("the moving blade was asked for a time before the last one");
  const double last = time_;
  const bool first = !started_;
  started_ = true;
  time_ = time;
  if (time < begin() || (!first && last >= end())) return {};
  tissue_.move(complex, places, workers);
  std::vector<Dart> faces;
  if (first || !(time > last)) return faces;
  const Step step = step_between(complex, last, workers);
  std::vector<std::vector<Dart>> cut(step.blocks.size());
  for_chunks(step.blocks.size(), workers, [&](std::size_t b0, std::size_t b1, std::size_t) {
    for (std::size_t b = b0; b < b1; ++b) look_for_crossings(complex, step, step.blocks[b], cut[b]);
  });
  for (const auto& part : cut) faces.insert(faces.end(), part.begin(), part.end());
  return faces;
}

MovingBlade::End MovingBlade::look_at(const CellComplex& complex, const Box& box,
                                      Index element) const {
  const Hexahedron& corners = complex.vertices_of(element);
  End end{centroid_of(corners, tissue_.before()), centroid_of(corners, tissue_.now()), 0};
  end.outside = outcode(box, end.before) & outcode(box, end.now);
  return end;
}

MovingBlade::Step MovingBlade::step_between(const CellComplex& complex, double last,
                                            const Workers* workers) {
  Step step{path(std::max(last, begin()), std::min(time_, end())), {}, {}, {}};
  step.box = box_of(step.path[0].points);
  for (BladeKey& key : step.path) {
    add(step.box, key.points);
    key.time = (key.time - last) / (time_ - last);
  }
  constexpr Index size = TissueBlocks::size;
  const Index elements = complex.element_count();
  step.blocks = look_ == Look::near ? tissue_.near(step.box) : tissue_.all();
  step.slot.assign(elements / size + 1, none);
  for (std::size_t b = 0; b < step.blocks.size(); ++b)
    step.slot[step.blocks[b]] = static_cast<Index>(b);
  ends_.resize(std::max(ends_.size(), step.blocks.size() * size));
  outside_.resize(ends_.size());
  for_chunks(step.blocks.size(), workers, [&](std::size_t b0, std::size_t b1, std::size_t) {
    for (std::size_t b = b0; b < b1; ++b) {
      const Index first = step.blocks[b] * size;
      for (Index e = first; e < std::min(first + size, elements); ++e) {
        if (!complex.exists(3, e)) continue;
        const std::size_t at = b * size + e - first;
        ends_[at] = look_at(complex, step.box, e);
        outside_[at] = ends_[at].outside;
      }
    }
  });
  return step;
}

// A link is near if no side of the blade's box has both elements beyond it all the time.
void MovingBlade::look_for_crossings(const CellComplex& complex, const Step& step, Index block,
                                     std::vector<Dart>& cut) const {
  constexpr Index size = TissueBlocks::size;
  const Index last = std::min((block + 1) * size, complex.element_count());
  for (Index e = block * size; e < last; ++e)
    for (int f = 0; f < 6; ++f) {
      const Index n = complex.neighbour(e, f);
      if (n == none || n < e) continue;
      const Index place = step.place(n);
      if (place != none && (outside_[step.place(e)] & outside_[place]) != 0) continue;
      const End& one = ends_[step.place(e)];
      const End other = place != none ? ends_[place] : look_at(complex, step.box, n);
      if ((one.outside & other.outside) != 0) continue;
      const Link from{vec3(one.before), vec3(other.before)};
      const Link to{vec3(one.now), vec3(other.now)};
      for (std::size_t i = 0; i + 1 < step.path.size(); ++i) {
        const BladeKey &p = step.path[i], &q = step.path[i + 1];
        if (!crosses_sweep(between(from, to, p.time), between(from, to, q.time), p.points,
                           q.points))
          continue;
        cut.push_back(24 * e + 4 * static_cast<Dart>(f));
        break;
      }
    }
}

}  // namespace suture
