// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/face_matching.hpp"

#include <algorithm>

#include "kernel/topology/hexahedron_tables.hpp"

namespace suture {
namespace {

using Kind = MapFault::Kind;

/// True if all indices exist and differ; else the first fault is appended.
bool check_vertices(Index e, const Hexahedron& h, Index vertex_count,
                    std::vector<MapFault>& faults) {
  for (const Index v : h)
    if (v >= vertex_count) {
      faults.push_back({Kind::index_out_of_range, {e, none, none}, {v, none, none, none}});
      return false;
    }
  bool repeated = false;
  for (int i = 0; i < 7; ++i)
    for (int j = i + 1; j < 8; ++j) repeated |= h[i] == h[j];
  if (!repeated) return true;
  for (int i = 0; i < 8; ++i)
    if (std::find(&h[i] + 1, h.data() + 8, h[i]) != h.data() + 8) {
      faults.push_back({Kind::repeated_vertex, {e, none, none}, {h[i], none, none, none}});
      break;
    }
  return false;
}

/// Vertices of a face from its largest on, in the order of its darts.
struct TurnedFace {
  int first;                ///< position of the largest vertex
  Index v, a, opposite, b;  ///< v is the largest
};

TurnedFace turn(const Hexahedron& h, int f) {
  using hexahedron::dart_vertex;
  const Index n[4] = {h[dart_vertex[4 * f]], h[dart_vertex[4 * f + 1]], h[dart_vertex[4 * f + 2]],
                      h[dart_vertex[4 * f + 3]]};
  const int p = n[1] > n[0] ? 1 : 0, q = n[3] > n[2] ? 3 : 2;
  const int k = n[q] > n[p] ? q : p;
  return {k, n[k], n[(k + 1) & 3], n[(k + 2) & 3], n[(k + 3) & 3]};
}

class Matcher {
 public:
  Matcher(std::span<const Hexahedron> hexahedra, Index vertex_count, std::vector<MapFault>& faults)
      : hexahedra_(hexahedra), faults_(faults), head_(vertex_count, none) {
    mates_.assign(hexahedra.size() * 6, none);
    seen_.reserve(hexahedra.size() * 3 + hexahedra.size() / 4 + 64);
  }

  /// Mates the face with one seen before, or files it.
  void add(Index e, int f) {
    const TurnedFace face = turn(hexahedra_[e], f);
    const Dart dart = 24 * e + 4 * f + face.first;
    const Index sum = face.a + face.opposite + face.b;
    for (Index i = head_[face.v]; i != none; i = seen_[i].next) {
      if (seen_[i].sum != sum) continue;
      if (meet(seen_[i].dart, dart, face)) return;
    }
    seen_.push_back({dart, sum, head_[face.v]});
    head_[face.v] = static_cast<Index>(seen_.size() - 1);
  }

  std::vector<Dart> take() { return std::move(mates_); }

 private:
  struct Seen {
    Dart dart;   ///< that starts at the largest vertex
    Index sum;   ///< of the other three vertices: tells most different faces apart
    Index next;  ///< in the list of the same largest vertex
  };

  /// True if `earlier` and `dart` belong to the same face; mates them or says why not.
  bool meet(Dart earlier, Dart dart, const TurnedFace& face) {
    const TurnedFace other = turn(hexahedra_[earlier / 24], static_cast<int>(earlier / 4 % 6));
    if (other.opposite == face.opposite && other.a == face.b && other.b == face.a) {
      if (mates_[earlier / 4] != none) {
        fault(Kind::third_element, {earlier / 24, mates_[earlier / 4] / 24, dart / 24}, face);
        return true;
      }
      // The edge that starts at the largest vertex here ends at it there:
      // beta3(dart + k) = earlier - 1 - k around the face.
      mates_[earlier / 4] = rotated(dart, 3 + earlier);
      mates_[dart / 4] = rotated(earlier, 3 + dart);
      return true;
    }
    std::array<Index, 3> mine{face.a, face.opposite, face.b};
    std::array<Index, 3> theirs{other.a, other.opposite, other.b};
    std::ranges::sort(mine);
    std::ranges::sort(theirs);
    if (mine != theirs) return false;
    fault(other.opposite == face.opposite ? Kind::same_side : Kind::not_cyclic,
          {earlier / 24, dart / 24, none}, face);
    return true;
  }

  /// The dart `steps` further around the face of `dart`.
  static Dart rotated(Dart dart, Dart steps) { return (dart & ~3u) | ((dart + steps) & 3u); }

  void fault(Kind kind, std::array<Index, 3> elements, const TurnedFace& face) {
    faults_.push_back({kind, elements, {face.v, face.a, face.opposite, face.b}});
  }

  std::span<const Hexahedron> hexahedra_;
  std::vector<MapFault>& faults_;
  std::vector<Index> head_;  ///< per largest vertex: last of its faces in seen_
  std::vector<Seen> seen_;
  std::vector<Dart> mates_;
};

std::string sentence(const MapFault& fault, const Naming& naming) {
  const auto element = [&](int i) { return naming.element(fault.elements[i]); };
  std::string face = "the face of points";
  for (const Index v : fault.vertices)
    if (v != none) face += " " + naming.vertex(v);
  switch (fault.kind) {
    case Kind::index_out_of_range:
      return "element " + element(0) + " names point " + std::to_string(fault.vertices[0]);
    case Kind::repeated_vertex:
      return "element " + element(0) + " names point " + naming.vertex(fault.vertices[0]);
    case Kind::third_element:
      return face + " belongs to elements " + element(0) + ", " + element(1) + " and " + element(2);
    case Kind::same_side:
    case Kind::not_cyclic:
      return face + " of elements " + element(0) + " and " + element(1);
  }
  return {};
}

const char* headline(Kind kind) {
  switch (kind) {
    case Kind::index_out_of_range:
      return "with a point that does not exist";
    case Kind::repeated_vertex:
      return "with the same point twice";
    case Kind::third_element:
      return "in three elements (a face separates two at most)";
    case Kind::same_side:
      return "with both elements on the same side (they overlap, or one is numbered as its mirror "
             "image)";
    case Kind::not_cyclic:
      return "whose four points come in another order around the face in the other element";
  }
  return "";
}

}  // namespace

std::vector<Dart> match_faces(std::span<const Hexahedron> hexahedra, Index vertex_count,
                              std::vector<MapFault>& faults) {
  Matcher matcher(hexahedra, vertex_count, faults);
  for (Index e = 0; e < hexahedra.size(); ++e) {
    if (!check_vertices(e, hexahedra[e], vertex_count, faults)) continue;
    for (int f = 0; f < 6; ++f) matcher.add(e, f);
  }
  return matcher.take();
}

std::string describe(std::span<const MapFault> faults, const Naming& naming) {
  constexpr std::size_t shown_at_most = 20;
  std::string text;
  for (const Kind kind : {Kind::index_out_of_range, Kind::repeated_vertex, Kind::third_element,
                          Kind::same_side, Kind::not_cyclic}) {
    const auto count = static_cast<std::size_t>(
        std::ranges::count(faults, kind, [](const MapFault& f) { return f.kind; }));
    if (count == 0) continue;
    const bool of_element = kind == Kind::index_out_of_range || kind == Kind::repeated_vertex;
    text += (text.empty() ? "" : "\n") + std::to_string(count) +
            (of_element ? " element" : " face") + (count == 1 ? " " : "s ") + headline(kind) + ":";
    std::size_t shown = 0;
    for (const MapFault& fault : faults) {
      if (fault.kind != kind) continue;
      if (shown++ == shown_at_most) break;
      text += "\n  " + sentence(fault, naming);
    }
    if (count > shown_at_most) text += "\n  and " + std::to_string(count - shown_at_most) + " more";
  }
  return text;
}

}  // namespace suture
