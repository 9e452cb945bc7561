// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/scene/scene.hpp"

namespace suture::test {

/// A plane that divides the elements which it crosses.
inline Event divide(const Vec3& point, const Vec3& normal) {
  Event event;
  event.what = CutPlane{.point = point, .normal = normal, .along_blade = true};
  event.path = "/events/0";
  return event;
}

}  // namespace suture::test
