// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "kernel/base/types.hpp"

namespace suture {

/// A selection of points or elements. Geometry is tested at rest; an element is selected if its
/// centroid is. A load in Pa acts on the boundary faces whose four corners are all selected.
struct Selection {
  struct All {};
  struct InBox {
    Vec3 min, max;
  };
  struct Plane {
    Vec3 point, normal;
    double tolerance;
  };  ///< |distance| <= tolerance, m; < 0: default_tolerance
  struct HalfSpace {
    Vec3 point, normal;
  };  ///< on the side of the normal
  struct Sphere {
    Vec3 centre;
    double radius;
  };
  struct Nearest {
    Vec3 point;
    double tie = 0;  ///< m: of cells whose distances differ by at most this, the first is selected
  };                 ///< the one point or element nearest to it
  struct Cylinder {
    Vec3 from, to;  ///< the centres of its ends, m
    double radius;
  };
  struct Ids {
    std::vector<std::uint64_t> ids;
  };  ///< the file's own numbers
  struct Named {
    std::string set;
  };
  struct Combined {
    enum class How { all_of, any_of, none_of };
    How how = How::all_of;
    std::vector<Selection> parts;  ///< at least one
  };
  std::variant<All, InBox, Plane, HalfSpace, Sphere, Cylinder, Nearest, Ids, Named, Combined> what =
      All{};
  std::string path;  ///< "/constraints/0/where"

  /// By ids or a set, at least in part, rather than by where cells are.
  bool is_listed() const {
    if (const Combined* combined = std::get_if<Combined>(&what))
      return std::ranges::any_of(combined->parts, &Selection::is_listed);
    return std::holds_alternative<Ids>(what) || std::holds_alternative<Named>(what);
  }
  /// The combination, unless a place alone tells whether it is in there.
  const Combined* needs_masks() const {
    const Combined* combined = std::get_if<Combined>(&what);
    return combined && std::ranges::any_of(combined->parts, &Selection::is_not_a_region) ? combined
                                                                                         : nullptr;
  }

  /// The default tolerance of a plane, as a fraction of the diagonal of the mesh's bounding box.
  static constexpr double default_tolerance = 1e-6;

 private:
  bool is_not_a_region() const {
    return is_listed() || std::holds_alternative<Nearest>(what) || needs_masks() != nullptr;
  }
};

}  // namespace suture
