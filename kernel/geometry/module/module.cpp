// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/module/parts.hpp"

namespace suture {
namespace {

class CgalModule final : public GeometryModule {
 public:
  std::string write(SurfaceFormat format, const TriangleSurface& surface) const override {
    return cgal::write(format, surface);
  }
  Closing close(const PolygonSoup& soup, bool repair) const override {
    return cgal::close(soup, repair);
  }
  std::vector<std::uint8_t> fill(const TriangleSurface& surface,
                                 const CubeGrid& grid) const override {
    return cgal::fill(surface, grid);
  }
  std::unique_ptr<TriangleTree> tree(const TriangleSurface& surface) const override {
    return cgal::tree(surface);
  }
  bool crosses(const std::array<Vec3, 3>& triangle, const Segment& link) const override {
    return cgal::crosses(triangle, link);
  }
};

}  // namespace
}  // namespace suture

extern "C" __attribute__((visibility("default"))) const suture::GeometryModule*
suture_geometry_module_1() {
  static const suture::CgalModule module;
  return &module;
}
