// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/face_matching.hpp"

#include <algorithm>

#include "kernel/topology/hexahedron_tables.hpp"

namespace suture {
namespace {

using incidence::Link;
using incidence::link_of;
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

/// The vertices of a face from one of its darts on, in the order of the darts.
struct TurnedFace {
  Index first, second, opposite, last;
};

TurnedFace turned(const Hexahedron& h, unsigned dart) {
  const auto vertex = [&](unsigned steps) {
    return h[hexahedron::dart_vertex[(dart & ~3u) | ((dart + steps) & 3u)]];
  };
  return {vertex(0), vertex(1), vertex(2), vertex(3)};
}

/// The local dart of face f that starts at the largest vertex.
unsigned largest_first(const Hexahedron& h, unsigned f) {
  const TurnedFace n = turned(h, 4 * f);
  const unsigned low = n.second > n.first, high = 2 + (n.last > n.opposite);
  return 4 * f + (std::max(n.opposite, n.last) > std::max(n.first, n.second) ? high : low);
}

class Matcher {
 public:
  Matcher(std::span<const Hexahedron> hexahedra, Index vertex_count, std::vector<MapFault>& faults)
      : hexahedra_(hexahedra), faults_(faults), newest_(vertex_count, none) {
    links_.assign(hexahedra.size() * 6, none);
    seen_.reserve(hexahedra.size() * 3 + hexahedra.size() / 4 + 64);
  }

  /// Links the face with one seen before, or files it.
  void add(Index e, unsigned f) {
    const unsigned dart = largest_first(hexahedra_[e], f);
    const TurnedFace face = turned(hexahedra_[e], dart);
    const Index sum = face.second + face.opposite + face.last;
    Index& newest = newest_[face.first];
    for (Index i = newest; i != none; i = seen_[i].next)
      if (seen_[i].sum == sum && meet(seen_[i].link, link_of(e, dart), face)) return;
    seen_.push_back({link_of(e, dart), sum, newest});
    newest = static_cast<Index>(seen_.size() - 1);
  }

  std::vector<Link> take() { return std::move(links_); }

 private:
  struct Seen {
    Link link;   ///< the dart that starts at the largest vertex
    Index sum;   ///< of the other three vertices: distinguishes most different faces
    Index next;  ///< in the list of the same largest vertex
  };

  /// True if both are the same face; links them or says why not.
  bool meet(Link earlier, Link here, const TurnedFace& face) {
    const TurnedFace other = turned(hexahedra_[earlier >> 5], earlier & 31);
    if (other.opposite == face.opposite && other.second == face.last && other.last == face.second) {
      Link& there = links_of(earlier);
      if (there != none) {
        fault(Kind::third_element, {earlier >> 5, there >> 5, here >> 5}, face);
        return true;
      }
      // The edge that starts at the largest vertex here ends at it there, and the
      // other side runs backwards: beta3(dart k) = dart p + q - 1 - k there, where p
      // and q are the positions of the largest vertex.
      there = (here & ~3u) | ((here + earlier + 3) & 3u);
      links_of(here) = (earlier & ~3u) | ((here + earlier + 3) & 3u);
      return true;
    }
    std::array<Index, 3> mine{face.second, face.opposite, face.last};
    std::array<Index, 3> theirs{other.second, other.opposite, other.last};
    std::ranges::sort(mine);
    std::ranges::sort(theirs);
    if (mine != theirs) return false;
    fault(other.opposite == face.opposite ? Kind::same_side : Kind::not_cyclic,
          {earlier >> 5, here >> 5, none}, face);
    return true;
  }

  Link& links_of(Link dart) { return links_[std::size_t{6} * (dart >> 5) + (dart & 31) / 4]; }

  void fault(Kind kind, std::array<Index, 3> elements, const TurnedFace& face) {
    faults_.push_back({kind, elements, {face.first, face.second, face.opposite, face.last}});
  }

  std::span<const Hexahedron> hexahedra_;
  std::vector<MapFault>& faults_;
  std::vector<Index> newest_;  ///< per largest vertex: the last of its faces in seen_
  std::vector<Seen> seen_;
  std::vector<Link> links_;
};

std::string sentence(const MapFault& fault, const Naming& naming) {
  const auto element = [&](int i) { return naming.element(fault.elements[i]); };
  std::string face = "the face of points";
  for (const Index v : fault.vertices)
    if (v != none) face += " " + naming.vertex(v);
  switch (fault.kind) {
    case Kind::index_out_of_range:
      return "element " + element(0) + " uses point " + std::to_string(fault.vertices[0]);
    case Kind::repeated_vertex:
      return "element " + element(0) + " uses point " + naming.vertex(fault.vertices[0]);
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
      return "with the same point twice (\"bad_elements\": \"drop\" in /mesh leaves such elements "
             "out)";
    case Kind::third_element:
      return "in three elements (a face belongs to at most two)";
    case Kind::same_side:
      return "with both elements on the same side (they overlap, one is numbered as its mirror "
             "image, or one is inside out, which \"bad_elements\": \"drop\" in /mesh leaves out)";
    case Kind::not_cyclic:
      return "whose points have a different cyclic order in the two elements";
  }
  return "";
}

}  // namespace

std::vector<Link> match_faces(std::span<const Hexahedron> hexahedra, Index vertex_count,
                              std::vector<MapFault>& faults) {
  Matcher matcher(hexahedra, vertex_count, faults);
  for (Index e = 0; e < hexahedra.size(); ++e) {
    if (!check_vertices(e, hexahedra[e], vertex_count, faults)) continue;
    for (unsigned f = 0; f < 6; ++f) matcher.add(e, f);
  }
  return matcher.take();
}

std::string describe(std::span<const MapFault> faults, const Naming& naming) {
  constexpr std::size_t max_listed = 20;
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
      if (shown++ == max_listed) break;
      text += "\n  " + sentence(fault, naming);
    }
    if (count > max_listed) text += "\n  and " + std::to_string(count - max_listed) + " more";
  }
  return text;
}

}  // namespace suture
