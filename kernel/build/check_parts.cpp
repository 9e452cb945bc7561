// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/build/check_parts.hpp"

#include "kernel/base/error.hpp"

namespace suture {

void check_parts(const Scene& scene, const Parts& parts) {
  if (parts.empty() && !scene.divides_elements() && scene.output.surface)
    throw InputError(
        "/output/surface: is for bodies with \"surface\" in /mesh, and for cuts along a blade; "
        "remove it, and let the viewer extract the surface of the frames");
}

void check_parts(const Event& event, bool may_grow) {
  if (event.is_along_blade() && !may_grow)
    throw InputError(event.path +
                     "/cut/along: the scene has no cut along a blade, so its models are not "
                     "prepared for parts of elements; set \"divisible\": true in the scene");
}

}  // namespace suture
