// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

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
  struct Ids {
    std::vector<std::uint64_t> ids;
  };  ///< the file's own numbers
  struct Named {
    std::string set;
  };
  std::variant<All, InBox, Plane, HalfSpace, Sphere, Nearest, Ids, Named> what = All{};
  std::string path;  ///< "/constraints/0/where"
  /// By ids or a set, rather than by where cells are.
  bool is_listed() const {
    return std::holds_alternative<Ids>(what) || std::holds_alternative<Named>(what);
  }

  /// The default tolerance of a plane, as a fraction of the diagonal of the mesh's bounding box.
  static constexpr double default_tolerance = 1e-6;
};

}  // namespace suture
